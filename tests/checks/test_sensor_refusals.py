"""Plugins inside a sensor of a type that they do not accept."""

import pytest
from tests.corpus.carts import cart, written

import cartwheel
from cartwheel.checks.checking import check
from cartwheel.codes.devices import SENSOR_REFUSED
from cartwheel.corpus import try_robot

SCAN = """<ray><scan><horizontal><samples>9</samples><min_angle>-1</min_angle>
<max_angle>1</max_angle></horizontal></scan><range><min>0.1</min><max>9</max></range></ray>"""
CAMERA = """<camera><image><width>8</width><height>6</height></image>
<clip><near>0.1</near><far>9</far></clip></camera>"""


def sensor(kind, plugin):
    inside = SCAN if "ray" in kind else CAMERA
    return (
        f'<gazebo reference="base"><sensor name="s" type="{kind}"><update_rate>5</update_rate>'
        f'{inside}<plugin name="p" filename="lib{plugin}.so"><frameName>base</frameName>'
        "<cameraName>c</cameraName></plugin></sensor></gazebo>"
    )


def found(path):
    return [each for each in check(path).findings if each.code is SENSOR_REFUSED]


@pytest.mark.parametrize(
    ("plugin", "accepted", "refused"),
    [
        ("gazebo_ros_laser", "ray", "gpu_ray"),
        ("gazebo_ros_gpu_laser", "gpu_ray", "ray"),
        ("gazebo_ros_block_laser", "ray", "gpu_ray"),
        ("gazebo_ros_range", "ray", "gpu_ray"),
        ("gazebo_ros_velodyne_laser", "ray", "gpu_ray"),
        ("gazebo_ros_velodyne_gpu_laser", "gpu_ray", "ray"),
        ("gazebo_ros_depth_camera", "depth", "camera"),
        ("gazebo_ros_openni_kinect", "depth", "camera"),
        ("gazebo_ros_multicamera", "multicamera", "camera"),
    ],
)
def test_a_sensor_of_another_class_is_an_error(tmp_path, plugin, accepted, refused):
    (wrong,) = found(written(tmp_path, cart(), sensor(refused, plugin)))
    assert wrong.severity == "error"
    assert wrong.values["type"] == refused
    assert wrong.values["meant"] == accepted
    assert not found(written(tmp_path, cart(), sensor(accepted, plugin)))


@pytest.mark.parametrize("kind", ["ray", "gpu_ray"])
def test_the_plugin_of_ros_2_accepts_both_kinds_of_lidars(tmp_path, kind):
    assert not found(written(tmp_path, cart(), sensor(kind, "gazebo_ros_ray_sensor")))


def test_what_only_cartwheel_publishes_is_a_fault_of_the_file(tmp_path):
    path = written(tmp_path, cart(), sensor("gpu_ray", "gazebo_ros_velodyne_laser"))
    faults = [each for each in try_robot(path, standing=1.0).faults if each.test == "publish"]
    assert [(each.code, each.source) for each in faults] == [(SENSOR_REFUSED, "file")]
    world = cartwheel.World(lenient=True)
    world.spawn(path)
    assert SENSOR_REFUSED in {each.code for each in world.diagnostics}


def test_a_plugin_that_the_repository_builds_may_accept_it(tmp_path):
    path = written(tmp_path, cart(), sensor("gpu_ray", "gazebo_ros_laser"))
    (tmp_path / ".git").mkdir(exist_ok=True)
    (tmp_path / "CMakeLists.txt").write_text("add_library(gazebo_ros_laser SHARED laser.cpp)")
    assert not found(path)
