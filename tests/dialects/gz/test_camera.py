"""Cameras of gz-sim: images, depths and points, without a plugin."""

import numpy as np
import pytest
from tests.devices.cameras.depths import far_below
from tests.devices.cameras.sensors import (
    cloud_of,
    depths_of,
    rays,
    sensor,
    take,
    topic_names,
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
