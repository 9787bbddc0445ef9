"""The <robotNamespace> of ROS 1, which the plugins of ros2_control do not read."""

import pytest
import yaml
from tests.coded import coded
from tests.dialects.ros_control.arms import beam, robot, ros2_joint, ros2_parameters, ros2_plugin
from tests.dialects.ros_control.arms import ros2_system as system

import cartwheel
from cartwheel.codes.devices import PLUGIN_PARAMETER_IGNORED

GROUP = {
    "type": "position_controllers/JointGroupPositionController",
    "joints": ["beam_joint"],
}
OLD = "<robotNamespace>/old</robotNamespace>"
CLASSIC, GZ = "libgazebo_ros2_control.so", "gz_ros2_control-system"


def description(tmp_path, plugin, tags):
    file = tmp_path / "own.yaml"
    file.write_text(yaml.safe_dump({"/**": ros2_parameters(group=GROUP)}))
    tag = ros2_plugin(file).replace("<parameters>", f"{tags}<parameters>")
    text = robot(beam("beam", "world") + system(ros2_joint("beam_joint")), tag)
    if plugin == CLASSIC:
        text = text.replace(GZ, CLASSIC)
        text = text.replace("gz_ros2_control/GazeboSim", "gazebo_ros2_control/Gazebo")
    return text


@pytest.mark.parametrize("plugin", [CLASSIC, GZ])
@pytest.mark.parametrize(
    ("tags", "manager"),
    [
        (OLD, "/controller_manager"),
        (f"<ros><namespace>/new</namespace></ros>{OLD}", "/new/controller_manager"),
    ],
)
def test_it_does_not_move_the_controller_manager(bench, tmp_path, plugin, tags, manager):
    text = description(tmp_path, plugin, tags)
    made = bench(text)
    names = {service.name for service in made.world.graph.services()}
    assert [each for each in names if each.endswith("/list_controllers")] == [
        f"{manager}/list_controllers"
    ]
    (reported,) = coded(made.warnings, PLUGIN_PARAMETER_IGNORED)
    assert reported.values["parameter"] == "robotNamespace"
    path = tmp_path / "arm.urdf"
    path.write_text(text)
    (found,) = [e for e in cartwheel.check(path).findings if e.code is PLUGIN_PARAMETER_IGNORED]
    assert found.values["tag"] == "robotNamespace"
