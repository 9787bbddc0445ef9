"""Which of several controllers for the same joints starts."""

import pytest
import yaml
from tests.dialects.ros_control.arms import beam, ros2_joint, ros2_plugin, ros2_system

from cartwheel.api import World
from cartwheel.dialects.ros_control.files import ControllerEntry
from cartwheel.dialects.ros_control.launched.ordering import compete, in_order

GROUP = "position_controllers/JointGroupPositionController"


def entry(name, kind, *joints):
    return ControllerEntry(
        name=name, type=kind, values={"joints": list(joints)}, namespace="", source=""
    )


def test_those_that_are_preferred_come_first():
    drive = entry("drive", "diff_drive_controller/DiffDriveController", "left")
    wheels = entry("wheels", "velocity_controllers/JointGroupVelocityController", "left")
    assert in_order([wheels, drive]) == [drive, wheels]
    assert in_order([wheels, drive], {"wheels"}) == [wheels, drive]


def test_controllers_compete_for_a_joint_and_broadcasters_do_not():
    one, two = entry("one", GROUP, "a", "b"), entry("two", GROUP, "b")
    states = entry("states", "joint_state_broadcaster/JointStateBroadcaster", "a", "b")
    assert compete([one, two], {"a", "b"})
    assert not compete([one, two], {"a"})
    assert not compete([one, states], {"a", "b"})


@pytest.mark.parametrize("chosen", ["small", "large"])
def test_the_launch_file_decides_between_two_controllers_of_a_joint(tmp_path, chosen):
    package = tmp_path / "arm"
    manager = {name: {"type": GROUP} for name in ("large", "small")}
    nodes = {name: {"ros__parameters": {"joints": ["upper_joint"]}} for name in manager}
    control = {"controller_manager": {"ros__parameters": manager}, **nodes}
    system = ros2_system(ros2_joint("upper_joint"))
    plugin = ros2_plugin(package / "control.yaml")
    files = {
        "package.xml": "<package><name>arm</name></package>",
        "control.yaml": yaml.safe_dump(control),
        "arm.urdf": f'<robot name="arm"><link name="world"/>{beam("upper", "world")}{system}'
        f"<gazebo>{plugin}</gazebo></robot>",
        "launch/arm.launch.py": 'name = LaunchConfiguration("size", default="' + chosen + '")\n'
        'xacro.process_file(os.path.join(get_package_share_directory("arm"), "arm.urdf"))\n'
        'Node(package="controller_manager", executable="spawner", arguments=[[name]])\n',
    }
    for name, text in files.items():
        (package / name).parent.mkdir(parents=True, exist_ok=True)
        (package / name).write_text(text)
    with World(lenient=True) as world:
        world.spawn(package / "arm.urdf")
        world.run(0.1)
        topics = {info.name for info in world.graph.topics() if info.subscribers}
        refused = [each.values.get("controller") for each in world.diagnostics]
    other = "large" if chosen == "small" else "small"
    assert f"/{chosen}/commands" in topics
    assert other in refused
    assert chosen not in refused
