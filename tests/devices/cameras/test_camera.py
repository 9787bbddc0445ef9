"""Camera images, by the geometry of a pinhole."""

import io
import math

import numpy as np
import pytest
from PIL import Image
from tests.devices.cameras.posts import RED, SKY, camera, look, reds, silhouette, take

from cartwheel.geometry import Pose, quat_from_rpy


@pytest.mark.parametrize(("width", "height"), [(320, 240), (640, 480), (333, 111), (96, 200)])
@pytest.mark.parametrize(
    ("eye", "post"),
    [
        ("0 0 1 0 0 0", Pose((3, 0.2, 1.1))),
        ("0 0 1 0 0.2 0", Pose((2.5, -0.3, 0.4))),
        ("1 -2 0.8 0 -0.1 1.3", Pose.from_xyz_rpy((1.6, 0.4, 1.2), (0, 0, 0.5))),
        ("0 0 1 0.3 0 0", Pose((3, 0, 1.0))),
    ],
)
def test_a_post_is_where_the_pinhole_puts_it(make, width, height, eye, post):
    fov, size = 1.04, (0.2, 0.3, 0.4)
    world = make.world(
        make.sdf(camera(pose=eye, width=width, height=height, fov=fov)),
        make.box("post", size, static=True, colour=RED, pose=post),
    )
    red = reds(look(world))
    found_columns, found_rows = np.nonzero(red.any(axis=0))[0], np.nonzero(red.any(axis=1))[0]
    numbers = [float(word) for word in eye.split()]
    left, right, top, bottom = silhouette(
        Pose.from_xyz_rpy(numbers[:3], numbers[3:]), post, size, width=width, height=height, fov=fov
    )
    # A pixel is drawn where its middle is covered: within half of one, and a corner's tip
    # may fall between two middles.
    assert found_columns[0] == pytest.approx(max(left, 0), abs=1)
    assert found_columns[-1] + 1 == pytest.approx(min(right, width), abs=1)
    assert found_rows[0] == pytest.approx(max(top, 0), abs=1)
    assert found_rows[-1] + 1 == pytest.approx(min(bottom, height), abs=1)


def test_the_ground_ends_in_a_level_line_at_the_far_plane(make):
    """Eye at h, ground at depth d: f h / d below the middle; at the far plane it ends."""
    far, high = 50.0, 4.0
    world = make.world(make.sdf(camera(pose=f"0 0 {high} 0 0 0.4", far=far)))
    pixels = look(world)
    sky = (pixels == SKY).all(axis=-1)
    horizons = np.argmin(sky, axis=0)
    focal = 320 / (2 * math.tan(1.04 / 2))
    assert len(set(horizons.tolist())) == 1
    assert horizons[0] == pytest.approx(120 + focal * high / far, abs=1)
    assert sky[: horizons[0]].all()
    assert not sky[horizons[0] :].any()


@pytest.mark.parametrize(
    ("distance", "seen"), [(0.45, False), (0.55, True), (15.0, True), (19.5, True), (20.5, False)]
)
def test_near_and_far_planes_clip(make, distance, seen):
    wall = make.box(
        "wall", (0.01, 60, 60), static=True, colour=RED, pose=Pose((distance + 0.005, 0, 1))
    )
    eye = make.sdf(camera(near=0.5, far=20.0))
    world = make.world(eye, wall, ground=None)
    pixels = look(world)
    assert reds(pixels).all() if seen else (pixels == SKY).all()


def test_colours(make):
    """A red box is red, the ground an even grey, and what is far away Gazebo's 178."""
    world = make.world(
        make.sdf(camera(pose="0 0 1 0 0 0")),
        make.box("post", (0.4, 0.4, 0.4), static=True, colour=RED, pose=Pose((2, 0, 1))),
    )
    pixels = look(world)
    assert (pixels[0, 0] == SKY).all()
    red, green, blue = pixels[120, 160].astype(int)
    assert red > 80
    assert red > 4 * green
    assert red > 4 * blue
    ground = pixels[230, 5].astype(int)
    assert np.ptp(ground) <= 1
    assert 60 < ground[0] < 255


def test_background_is_the_worlds(make):
    world = make.world(make.sdf(camera()), ground=None, background=(0.2, 0.4, 0.6, 1.0))
    pixels = look(world)
    assert np.unique(pixels.reshape(-1, 3), axis=0).tolist() == [[51, 102, 153]]


def test_calibration_is_gazebos(make, rosbots):
    """The numbers that a real Gazebo 11 printed for this camera."""
    world = make.world()
    world.session.spawn(rosbots, pose=Pose((0, 0, 0.05)))
    info = take(world, "/rosbots/camera1/camera_info")
    focal = 279.44580226326354
    assert info.header.frame_id == "camera"
    assert (info.height, info.width, info.distortion_model) == (240, 320, "plumb_bob")
    assert info.d.tolist() == [0.0] * 5
    assert info.k.tolist() == pytest.approx([focal, 0, 160.5, 0, focal, 120.5, 0, 0, 1], rel=1e-15)
    assert info.r.tolist() == np.eye(3).ravel().tolist()
    assert info.p.tolist() == pytest.approx(
        [focal, 0, 160.5, -19.56120615842845, 0, focal, 120.5, 0, 0, 0, 1, 0], rel=1e-15
    )
    assert (info.binning_x, info.binning_y, info.roi.do_rectify) == (0, 0, False)


def test_image_is_as_gazebo_prints_it(make, rosbots):
    world = make.world()
    world.session.spawn(rosbots, pose=Pose((0, 0, 0.05)))
    image = take(world, "/rosbots/camera1/image_raw")
    assert image.header.frame_id == "camera"
    assert (image.height, image.width, image.encoding, image.is_bigendian) == (240, 320, "rgb8", 0)
    assert image.step == 960
    assert len(image.data) == 230400
    assert image.data[:39].tolist() == [SKY] * 39


def test_bgr_is_rgb_the_other_way_round_and_mono_its_brightness(make):
    post = make.box("post", (0.4, 0.4, 0.4), static=True, colour=RED, pose=Pose((2, 0, 1)))
    rgb = look(make.world(make.sdf(camera()), post))
    bgr = look(make.world(make.sdf(camera(form="B8G8R8")), post))
    world = make.world(make.sdf(camera(form="L8")), post)
    mono = take(world, "/cam/image_raw")
    assert np.array_equal(bgr, rgb[..., ::-1])
    assert (mono.encoding, mono.step, len(mono.data)) == ("mono8", 320, 320 * 240)
    grey = rgb @ np.array([0.299, 0.587, 0.114])
    assert np.abs(mono.data.reshape(240, 320) - grey).max() <= 0.5


def test_jpeg_shows_the_same(make):
    post = make.box("post", (0.4, 0.4, 0.4), static=True, colour=RED, pose=Pose((2, 0, 1)))
    world = make.world(make.sdf(camera()), post)
    raw, small = world.mailbox("/cam/image_raw"), world.mailbox("/cam/image_raw/compressed")
    world.run(0.1)
    image, compressed = raw.drain()[0], small.drain()[0]
    assert image.header == compressed.header
    assert "jpeg" in compressed.format
    decoded = np.asarray(Image.open(io.BytesIO(compressed.data.tobytes())).convert("RGB"))
    expected = np.asarray(image.data).reshape(240, 320, 3)
    # Quality 80 spreads an edge over its block of 8 pixels, and keeps the rest.
    difference = np.abs(decoded.astype(int) - expected)
    assert difference.mean() < 1.5
    assert np.median(difference) <= 1
    assert len(compressed.data) < len(image.data) / 10


def count_renders(world):
    """A list that grows with each image drawn."""
    drawn = []
    renderer = world.session.simulation.engine.renderer
    render = renderer.render
    renderer.render = lambda *a: drawn.append(1) or render(*a)
    return drawn


def test_nothing_is_drawn_for_nobody(make):
    world = make.world(make.sdf(camera()))
    drawn = count_renders(world)
    info = world.mailbox("/cam/camera_info")
    world.run(1.0)
    assert len(info.drain()) == 31
    assert not drawn
    raw, small = world.mailbox("/cam/image_raw"), world.mailbox("/cam/image_raw/compressed")
    world.run(1.0)
    assert len(raw.drain()) == len(small.drain()) == len(drawn) == 30
    raw.close()
    small.close()
    world.run(1.0)
    assert len(drawn) == 30


def test_image_is_that_of_its_stamp(make):
    """A box falls through the picture: each image shows it where it was at the stamp."""
    stone = make.box("stone", (0.2, 0.2, 0.2), colour=RED, pose=Pose((3, 0, 2)))
    world = make.world(make.sdf(camera()), stone, ground=None)
    simulation = world.session.simulation
    box = world.mailbox("/cam/image_raw", size=100)
    heights = {}
    simulation.schedule(
        30, after=lambda: heights.update({simulation.time_ns: simulation.pose("stone").z})
    )
    world.run(0.6)
    focal = 320 / (2 * math.tan(1.04 / 2))
    checked = 0
    for message in box.drain():
        rows = np.nonzero(reds(np.asarray(message.data).reshape(240, 320, 3)).any(axis=1))[0]
        z = heights[message.header.stamp.sec * 10**9 + message.header.stamp.nanosec]
        if len(rows) and rows[0] > 0 and rows[-1] < 239:
            # The front's upper edge; seen from above, the back's.
            top = 120 - focal * max((z + 0.1 - 1) / 2.9, (z + 0.1 - 1) / 3.1)
            assert rows[0] == pytest.approx(top, abs=1)
            checked += 1
    assert checked > 8


def test_noise_has_its_spread(make):
    noise = "<noise><type>gaussian</type><mean>0</mean><stddev>0.02</stddev></noise>"
    world = make.world(make.sdf(camera(inside=noise)), ground=None)
    pixels = look(world).astype(float)
    assert pixels.mean() == pytest.approx(SKY, abs=1)
    # Rounding down adds a spread of 1/√12.
    expected = math.hypot(0.02 * 255, 1 / math.sqrt(12))
    assert pixels.std() == pytest.approx(expected, rel=0.02)


def test_two_cameras_of_different_sizes(make):
    wide = make.sdf(camera(width=200, height=100))
    tall = make.sdf(
        camera(width=100, height=400).replace('"eye"', '"tall"').replace('"cam"', '"tallcam"')
    )
    post = make.box("post", (0.2, 0.2, 0.2), static=True, colour=RED, pose=Pose((2, 0, 1)))
    alone = look(make.world(wide, post))
    world = make.world(wide, tall, post)
    assert look(world, "/tallcam/image_raw").shape == (400, 100, 3)
    assert np.array_equal(look(world), alone)


def test_a_spawned_box_appears_and_a_deleted_one_goes(make):
    world = make.world(make.sdf(camera()))
    before = look(world)
    world.session.spawn(
        make.box("post", (0.2, 0.2, 0.2), static=True, colour=RED, pose=Pose((2, 0, 1)))
    )
    assert reds(look(world)).any()
    world.model("post").delete()
    assert np.array_equal(look(world), before)


def test_a_camera_turned_on_its_link_looks_where_it_is_turned(make):
    """The sensor's own pose: a quarter turn to the left sees what stands there."""
    eye = camera().replace("<update_rate>", f"<pose>0 0 0 0 0 {math.pi / 2}</pose><update_rate>")
    post = make.box(
        "post",
        (0.2, 0.2, 0.2),
        static=True,
        colour=RED,
        pose=Pose((0, 2, 1), quat_from_rpy(0, 0, 0)),
    )
    red = reds(look(make.world(make.sdf(eye), post)))
    columns = np.nonzero(red.any(axis=0))[0]
    assert (columns[0] + columns[-1] + 1) / 2 == pytest.approx(160, abs=1)
