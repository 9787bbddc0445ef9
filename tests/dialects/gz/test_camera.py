"""Cameras of gz-sim: images, depths and points, without a plugin."""

import numpy as np
import pytest
from tests.coded import coded
from tests.devices.cameras.depths import far_below
from tests.devices.cameras.sensors import (
    RED,
    cloud_of,
    depths_of,
    focal,
    pixels_of,
    rays,
    reds,
    sensor,
    take,
    topic_names,
)

from cartwheel.codes import devices
from cartwheel.geometry import Pose

INTRINSICS = "<intrinsics><fx>200</fx><fy>300</fy><cx>100</cx><cy>150</cy></intrinsics>"
PROJECTION = (
    "<projection><p_fx>150</p_fx><p_fy>160</p_fy><p_cx>170</p_cx><p_cy>90</p_cy><tx>-3</tx>"
    "</projection>"
)


@pytest.mark.parametrize(
    ("kind", "topics"),
    [
        ("camera", {"/see/it", "/see/it/compressed", "/see/camera_info"}),
        ("depth_camera", {"/see/it", "/see/it/points", "/see/camera_info"}),
        (
            "rgbd_camera",
            {
                f"/see/it/{name}"
                for name in ("image", "image/compressed", "depth_image", "points", "camera_info")
            },
        ),
    ],
)
def test_new_gazebos_sensors(make, kind, topics):
    model = sensor(
        kind=kind,
        filename="",
        more="<topic>/see/it</topic><gz_frame_id>eye</gz_frame_id>",
        pose="0 0 1 0 0.3 0",
    )
    world = make.world(make.sdf(model))
    assert {name for name in topic_names(world) if name.startswith("/see/")} == topics
    info = take(world, next(topic for topic in topics if "camera_info" in topic))
    assert info.header.frame_id == "eye"
    assert info.k[[2, 5]].tolist() == [160, 120]
    if kind == "camera":
        assert take(world, "/see/it").encoding == "rgb8"
        return
    depths = depths_of(take(world, "/see/it" if kind == "depth_camera" else "/see/it/depth_image"))
    expected = far_below(1.0, tilt=0.3)
    np.testing.assert_allclose(depths[expected < 30], expected[expected < 30], rtol=2e-4)
    assert np.isposinf(depths[expected > 55]).all()
    # New Gazebo's axes: x ahead, y left, z up.
    cloud = cloud_of(take(world, "/see/it/points"))
    right, down = rays()
    seen = expected < 30
    np.testing.assert_allclose(cloud["x"][seen], expected[seen], rtol=2e-4)
    np.testing.assert_allclose(cloud["y"][seen], (-right * expected)[seen], rtol=1e-3, atol=1e-4)
    np.testing.assert_allclose(cloud["z"][seen], (-down * expected)[seen], rtol=1e-3, atol=1e-4)


@pytest.mark.parametrize("kind", ["rgbd", "rgbd_camera"])
def test_both_spellings_of_a_type_publish_the_same(make, kind):
    world = make.world(make.sdf(sensor(kind=kind, filename="")))
    base = "/world/test/model/cam_eye/link/link/sensor/cam"
    names = ("image", "image/compressed", "depth_image", "points", "camera_info")
    assert {name for name in topic_names(world) if name.startswith(base)} == {
        f"{base}/{name}" for name in names
    }
    assert take(world, f"{base}/image").encoding == "rgb8"


@pytest.mark.parametrize(
    ("kind", "system"),
    [
        *((kind, False) for kind in ("thermal", "thermal_camera", "segmentation", "boundingbox")),
        # Gazebo Classic has this type too.
        ("wideanglecamera", True),
    ],
)
def test_cameras_of_gz_that_are_not_simulated_are_reported(make, kind, system):
    plugin = '<plugin name="s" filename="gz-sim-sensors-system"/>' if system else ""
    model = sensor(kind=kind, filename="").replace("</model>", f"{plugin}</model>")
    (warning,) = coded(make.world(make.sdf(model)), devices.SENSOR_WITHOUT_PLUGIN, type=kind)
    assert warning.severity == "warning"


def test_a_camera_without_plugin_has_new_gazebos_name_where_it_states_none(make):
    model = sensor(kind="rgbd_camera", filename="")
    world = make.world(make.sdf(model))
    assert "/world/test/model/cam_eye/link/link/sensor/cam/depth_image" in topic_names(world)


def test_new_gazebos_own_clip_of_depths(make):
    clip = "<depth_camera><clip><near>1</near><far>3</far></clip></depth_camera>"
    model = sensor(
        kind="rgbd_camera", filename="", inside=clip, more="<topic>see</topic>", pose="0 0 .5 0 0 0"
    )
    depths = depths_of(take(make.world(make.sdf(model)), "/see/depth_image"))
    expected = far_below(0.5)
    assert (depths[expected < 0.99] == -np.inf).all()
    assert (depths[expected > 3.03] == np.inf).all()
    assert np.isfinite(depths[(expected > 1.01) & (expected < 2.97)]).all()


@pytest.mark.parametrize(
    ("lens", "k", "p"),
    [
        (INTRINSICS, (200, 300, 100, 150), (200, 300, 100, 150, 0)),
        (PROJECTION, (focal(320, 1.04),) * 2 + (160, 120), (150, 160, 170, 90, -3)),
        (INTRINSICS + PROJECTION, (200, 300, 100, 150), (150, 160, 170, 90, -3)),
    ],
    ids=["intrinsics", "projection", "both"],
)
def test_the_focal_lengths_of_a_lens_replace_the_field_of_view(make, lens, k, p):
    """The image is rendered with the projection, or with the intrinsics if there is none."""
    more = "<topic>/cam/image</topic>"
    post, half = (3.0, 0.4, 0.8), 0.3
    world = make.world(
        make.sdf(sensor(filename="", more=more, inside=f"<lens>{lens}</lens>")),
        make.box("post", (0.002, 2 * half, 2 * half), static=True, colour=RED, pose=Pose(post)),
    )
    assert not coded(world, devices.SENSOR_SETTING_IGNORED)
    info = take(world, "/cam/camera_info")
    assert info.k.tolist() == pytest.approx([k[0], 0, k[2], 0, k[1], k[3], 0, 0, 1])
    assert info.p.tolist() == pytest.approx([p[0], 0, p[2], p[4], 0, p[1], p[3], 0, 0, 0, 1, 0])
    red = reds(pixels_of(take(world, "/cam/image")))
    columns, rows = np.nonzero(red.any(axis=0))[0], np.nonzero(red.any(axis=1))[0]
    for seen, length, centre, offset in (
        (columns, p[0], p[2], -post[1]),
        (rows, p[1], p[3], 1.0 - post[2]),
    ):
        edges = [centre + length * (offset + side * half) / post[0] for side in (-1, 1)]
        assert [seen[0], seen[-1] + 1] == pytest.approx(edges, abs=1.5)


@pytest.mark.parametrize("written", ["<fx>0</fx>", "<fy>-2</fy>", "<fy>1e-300</fy>"])
def test_impossible_focal_lengths_are_reported(make, written):
    inside = f"<lens><intrinsics>{written}</intrinsics></lens>"
    world = make.world(make.sdf(sensor(filename="", more="<topic>/cam/i</topic>", inside=inside)))
    assert coded(world, devices.SENSOR_SETTING_IGNORED, setting="intrinsics")
    assert take(world, "/cam/camera_info").k[0] == pytest.approx(focal(320, 1.04))


def test_a_lens_that_states_no_focal_lengths_is_reported(make):
    inside = "<lens><type>stereographic</type></lens>"
    world = make.world(make.sdf(sensor(filename="", more="<topic>/cam/i</topic>", inside=inside)))
    assert coded(world, devices.SENSOR_SETTING_IGNORED, setting="lens")
