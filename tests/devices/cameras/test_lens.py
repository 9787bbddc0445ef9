"""Lenses with distortion: where the formula images a point, the camera renders it."""

import math

import numpy as np
import pytest
from tests.coded import coded
from tests.devices.cameras.sensors import RED, SKY, depths_of, focal, pixels_of, reds, sensor, take

from cartwheel.codes import devices
from cartwheel.description.model import CameraIntrinsics
from cartwheel.devices.cameras.lens import Distortion, Lens
from cartwheel.geometry import Pose

BARREL = {"k1": -0.25, "k2": 0.05, "p1": 0.0, "p2": 0.0, "k3": 0.0}

PINCUSHION = {"k1": 0.2, "k2": 0.1, "p1": 0.0, "p2": 0.0, "k3": 0.05}

SKEW = {"k1": -0.1, "k2": 0.0, "p1": 0.01, "p2": -0.015, "k3": 0.0}

FOV = 1.4


def tags(numbers):
    inner = "".join(f"<{name}>{value}</{name}>" for name, value in numbers.items())
    return f"<distortion>{inner}</distortion>"


def seen_at(x, y, *, k1, k2, p1, p2, k3):
    """The formula as sensor_msgs/CameraInfo has it, written out."""
    r2 = x**2 + y**2
    radial = 1 + k1 * r2 + k2 * r2**2 + k3 * r2**3
    return (
        x * radial + 2 * p1 * x * y + p2 * (r2 + 2 * x**2),
        y * radial + p1 * (r2 + 2 * y**2) + 2 * p2 * x * y,
    )


def outline(post, size, numbers, width=320, height=240):
    """Left, right, top and bottom of a box seen from (0, 0, 1), through the lens, in pixels."""
    columns, rows = [], []
    low, high = np.array(post) - np.array(size) / 2, np.array(post) + np.array(size) / 2
    for y in np.linspace(low[1], high[1], 30):
        for z in np.linspace(low[2], high[2], 30):
            for x in (low[0], high[0]):
                u, v = seen_at(-y / x, -(z - 1) / x, **numbers)
                columns.append(width / 2 + focal(width, FOV) * u)
                rows.append(height / 2 + focal(width, FOV) * v)
    return min(columns), max(columns), min(rows), max(rows)


@pytest.mark.parametrize("numbers", [BARREL, PINCUSHION, SKEW])
@pytest.mark.parametrize("post", [(3, 0, 1), (3, 1.4, 1.9), (3, -1.6, 0.4)])
def test_a_post_is_where_the_formula_puts_it(make, numbers, post):
    size = (0.1, 0.5, 0.5)
    world = make.world(
        make.sdf(sensor(fov=FOV, inside=tags(numbers))),
        make.box("post", size, static=True, colour=RED, pose=Pose(post)),
    )
    red = reds(pixels_of(take(world, "/cam/image_raw")))
    columns, rows = np.nonzero(red.any(axis=0))[0], np.nonzero(red.any(axis=1))[0]
    left, right, top, bottom = outline(post, size, numbers)
    # Half a pixel of the picture that is bent, and half of the image.
    assert columns[0] == pytest.approx(left, abs=1.5)
    assert columns[-1] + 1 == pytest.approx(right, abs=1.5)
    assert rows[0] == pytest.approx(top, abs=1.5)
    assert rows[-1] + 1 == pytest.approx(bottom, abs=1.5)


@pytest.mark.parametrize("numbers", [BARREL, PINCUSHION, SKEW])
def test_camera_info_describes_what_is_drawn(make, numbers):
    world = make.world(make.sdf(sensor(fov=FOV, inside=tags(numbers))))
    info = take(world, "/cam/camera_info")
    assert info.distortion_model == "plumb_bob"
    assert info.d.tolist() == [numbers[name] for name in ("k1", "k2", "p1", "p2", "k3")]
    assert info.k[0] == pytest.approx(focal(320, FOV))


def test_there_is_no_black_border(make):
    """What a barrel shows beyond the pinhole's picture is drawn too."""
    world = make.world(make.sdf(sensor(fov=FOV, inside=tags(BARREL))), ground=None)
    assert (pixels_of(take(world, "/cam/image_raw")) == SKY).all()


def test_where_no_ray_comes_in_it_is_black(make):
    """k1 folds the plane at r = 1 / sqrt(-3 k1), and shows nothing beyond 2 / 3 of that."""
    k1 = -0.6
    world = make.world(make.sdf(sensor(fov=FOV, inside=f"<distortion><k1>{k1}</k1></distortion>")))
    pixels = pixels_of(take(world, "/cam/image_raw"))
    edge = 2 / 3 / math.sqrt(-3 * k1)
    u, v = np.meshgrid(np.arange(320) - 159.5, np.arange(240) - 119.5)
    radius = np.hypot(u, v) / focal(320, FOV)
    assert not pixels[radius > 1.01 * edge].any()
    assert pixels[radius < 0.98 * edge].any(axis=-1).all()


def test_the_plugins_own_numbers_bend_too(make):
    post = make.box("post", (0.1, 0.5, 0.5), static=True, colour=RED, pose=Pose((3, 1.4, 1.9)))
    names = {"k1": "K1", "k2": "K2", "k3": "K3", "p1": "T1", "p2": "T2"}
    own = "".join(
        f"<distortion{names[name]}>{value}</distortion{names[name]}>"
        for name, value in SKEW.items()
    )
    images = [
        pixels_of(take(make.world(make.sdf(model), post), "/cam/image_raw"))
        for model in (
            sensor(fov=FOV, inside=tags(SKEW)),
            sensor(fov=FOV, plugin=f"<cameraName>cam</cameraName>{own}"),
            sensor(fov=FOV),
        )
    ]
    assert np.array_equal(images[0], images[1])
    assert not np.array_equal(images[0], images[2])


def test_numbers_that_contradict_are_reported(make):
    model = sensor(inside=tags(BARREL), plugin="<distortionK1>0.5</distortionK1>")
    world = make.world(make.sdf(model))
    (reported,) = [d for d in world.diagnostics if d.severity == "warning"]
    assert reported.code is devices.PLUGIN_PARAMETER_IGNORED
    assert reported.values["parameter"] == "distortion"


def test_the_centre_of_a_distortion(make):
    """A thing at the centre stays where the pinhole has it."""
    centre = "<center>0.75 0.5</center>"
    inside = tags(BARREL).replace("</distortion>", f"{centre}</distortion>")
    # The ray of the image's column 240.
    y = -3 * 80 / focal(320, FOV)
    post = make.box("post", (0.001, 0.2, 0.2), static=True, colour=RED, pose=Pose((3, y, 1)))
    world = make.world(make.sdf(sensor(fov=FOV, inside=inside)), post)
    columns = np.nonzero(reds(pixels_of(take(world, "/cam/image_raw"))).any(axis=0))[0]
    assert (columns[0] + columns[-1] + 1) / 2 == pytest.approx(240, abs=1.0)
    assert coded(world, devices.SENSOR_SETTING_IGNORED, setting="center")


def test_a_distortion_that_nobody_sees_is_not_drawn(make):
    plain = pixels_of(take(make.world(make.sdf(sensor())), "/cam/image_raw"))
    tiny = sensor(inside="<distortion><k1>0.00000001</k1></distortion>")
    world = make.world(make.sdf(tiny))
    assert np.array_equal(pixels_of(take(world, "/cam/image_raw")), plain)
    assert take(world, "/cam/camera_info").d[0] == 1e-8
    # The picture itself is handed on, not one made of its pixels.
    for k1, same in ((1e-8, True), (1e-2, False)):
        intrinsics = CameraIntrinsics(width=320, height=240, horizontal_fov=FOV)
        lens = Lens(intrinsics, Distortion(k1=k1))
        picture = np.zeros((lens.rendered.height, lens.rendered.width, 3), np.uint8)
        assert (lens.image(picture) is picture) == same


def test_depths_are_bent_like_colours(make):
    post = make.box("post", (0.1, 0.5, 0.5), static=True, colour=RED, pose=Pose((3.05, 1.4, 1.9)))
    model = sensor(kind="depth", fov=FOV, inside=tags(BARREL), plugin="<max_depth>9</max_depth>")
    world = make.world(make.sdf(model), post, ground=None)
    depth, image = world.mailbox("/cam/depth/image_raw"), world.mailbox("/cam/image_raw")
    world.run(0.05)
    depths, red = depths_of(depth.drain()[0]), reds(pixels_of(image.drain()[0]))
    assert red.sum() > 100
    # Colours are mixed at an edge, depths are not.
    near = depths < 4
    assert (near ^ red).sum() <= 2 * (near.any(axis=0).sum() + near.any(axis=1).sum())
    assert depths[near].max() <= 3.101
    assert set(np.unique(np.isfinite(depths) | np.isposinf(depths))) == {True}


@pytest.mark.parametrize("numbers", [BARREL, PINCUSHION, SKEW])
def test_inverting_is_exact(numbers):
    distortion = Distortion(**numbers)
    lens = Lens(CameraIntrinsics(horizontal_fov=FOV), distortion)
    right, down = lens.rays()
    u, v = distortion.apply(right, down)
    columns, rows = np.meshgrid(np.arange(320) - 159.5, np.arange(240) - 119.5)
    np.testing.assert_allclose(u * lens.focal, columns, atol=1e-4)
    np.testing.assert_allclose(v * lens.focal, rows, atol=1e-4)
    # From a point over the formula and back.
    x, y = np.meshgrid(np.linspace(-0.4, 0.4, 9), np.linspace(-0.3, 0.3, 9))
    back = distortion.invert(*seen_at(x, y, **numbers))
    np.testing.assert_allclose(back, [x, y], atol=1e-6)


def test_what_lies_between_pixels_is_mixed():
    """A ramp of brightness stays one: each pixel has the brightness of its own ray's place."""
    lens = Lens(CameraIntrinsics(horizontal_fov=FOV), Distortion(**BARREL))
    width, height = lens.rendered.width, lens.rendered.height
    across = (np.arange(width) + 0.5) / width * 255
    along = (np.arange(height) + 0.5) / height * 255
    picture = np.empty((height, width, 3), dtype=np.uint8)
    picture[..., 0], picture[..., 1] = across.round(), along.round()[:, None]
    picture[..., 2] = 255
    image = lens.image(picture).astype(float)
    right, down = lens.rays()
    # Rounding twice, and weights of 8 bits: a 256th of the steps of a ramp, which are small.
    expected = (right * lens.focal + width / 2) / width * 255
    assert np.abs(image[..., 0] - expected).max() <= 1.1
    expected = (down * lens.focal + height / 2) / height * 255
    assert np.abs(image[..., 1] - expected).max() <= 1.1
    assert (image[..., 2] == 255).all()
