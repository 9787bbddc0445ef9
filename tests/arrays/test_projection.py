"""Points and pixels, compared with pictures of a known object."""

import numpy as np
import pytest
from tests.coded import raises

import cartwheel as cw
from cartwheel.codes.graph import ARRAY_INVALID
from cartwheel.msgs.sensor_msgs import CameraInfo

GZ = """<sdf version="1.9"><model name="eye"><static>1</static><pose>0 0 1 0 0 0</pose>
<link name="link"><sensor name="c" type="camera"><topic>/image</topic><update_rate>10</update_rate>
<camera><image><width>161</width><height>120</height></image></camera></sensor></link></model></sdf>
"""
CLASSIC = """<robot name="eye"><link name="world"/><joint name="j" type="fixed">
<parent link="world"/><child link="link"/><origin xyz="0 0 1"/></joint><link name="link"/>
<gazebo reference="link"><sensor name="c" type="camera"><update_rate>10</update_rate><camera>
<image><width>161</width><height>120</height><format>R8G8B8</format></image></camera>
<plugin name="p" filename="libgazebo_ros_camera.so"><cameraName>c</cameraName>
<imageTopicName>/image</imageTopicName><cameraInfoTopicName>/camera_info</cameraInfoTopicName>
</plugin></sensor></gazebo></robot>"""
BALL = """<sdf version="1.9"><model name="ball"><static>1</static><link name="link">
<visual name="v"><geometry><sphere><radius>0.1</radius></sphere></geometry><material>
<ambient>1 0 0 1</ambient>
<diffuse>1 0 0 1</diffuse></material></visual></link></model></sdf>"""
PLACE = (3.0, 0.6, 1.4)


@pytest.mark.parametrize("robot", [GZ, CLASSIC])
def test_a_point_is_where_the_picture_shows_it(robot):
    with cw.World("empty") as world:
        world.spawn(robot)
        x, y, z = PLACE
        world.spawn(BALL, x=x, y=y, z=z)
        images = world.topic("/image")
        info = world.topic("/camera_info").wait()
        world.run(0.2)
        red = cw.image(images.latest).astype(float)
    # x forward is z forward of the optical frame.
    column, row = cw.project(info, (-y, -(z - 1.0), x))
    mask = red[..., 0] - red[..., 1:].max(axis=-1) > 60
    rows, columns = np.nonzero(mask)
    assert len(rows) > 20
    # The centre of the outline of a sphere of 0.1 m is within 0.1 pixel of that of the sphere.
    assert column == pytest.approx((columns.min() + columns.max()) / 2, abs=0.6)
    assert row == pytest.approx((rows.min() + rows.max()) / 2, abs=0.6)


def info(first: float) -> CameraInfo:
    """A camera of 4 x 3 pixels, whose pixels are counted from `first`."""
    matrix = [2.0, 0.0, 1.5 + first, 0.0, 2.0, 1.0 + first, 0.0, 0.0, 1.0]
    return CameraInfo(width=4, height=3, k=np.array(matrix))


@pytest.mark.parametrize("first", [0.5, 1.0])
def test_pixels_are_counted_from_0(first):
    given = info(first)
    assert cw.project(given, (0.0, 0.0, 2.0)).tolist() == [1.5, 1.0]
    assert cw.project(given, [[1.0, 0.5, 2.0]]).tolist() == [[2.5, 1.5]]
    assert np.isnan(cw.project(given, [[0.0, 0.0, 0.0], [1.0, 1.0, -1.0]])).all()


def test_unproject_is_the_inverse():
    points = np.random.default_rng(0).uniform((-2, -2, 1), (2, 2, 5), (4, 5, 3))
    pixels = cw.project(info(1.0), points)
    assert pixels.shape == (4, 5, 2)
    assert np.allclose(cw.unproject(info(1.0), pixels, points[..., 2]), points)
    assert np.allclose(cw.unproject(info(0.5), (1.5, 1.0), 2.0), (0.0, 0.0, 2.0))


def test_wrong_shapes_are_refused():
    with raises(ARRAY_INVALID):
        cw.project(info(1.0), (1.0, 2.0))
    with raises(ARRAY_INVALID):
        cw.unproject(info(1.0), (1.0, 2.0, 3.0), 1.0)
