"""Controllers of ROS 2 that a launch file starts although no file states their type."""

import pytest
from tests.corpus.carts import cart, controlled, written

from cartwheel.checks.checking import check
from cartwheel.codes.devices import CONTROLLER_UNDEFINED
from cartwheel.corpus import try_robot

LAUNCH = """
def generate_launch_description():
    return LaunchDescription([
        Node(package="robot_state_publisher", executable="robot_state_publisher",
             parameters=[{{"robot_description": Command(["xacro {robot}"])}}]),
        Node(package="ros_gz_sim", executable="create", arguments=["-topic", "robot_description"]),
        Node(package="controller_manager", executable="spawner", arguments={arguments}),
    ])
"""
PARAMETERS = "\nlift:\n  ros__parameters:\n    joints: [left_joint]\n"
COMMENT = "\n# lift:\n#   type: effort_controllers/JointGroupEffortController\n"
OWN = PARAMETERS.replace(
    "joints", "type: effort_controllers/JointGroupEffortController\n    joints"
)
OTHER = PARAMETERS.replace("lift", "lift_state_broadcaster")


def launched(folder, text, arguments, managed=""):
    (folder / ".gitignore").write_text("")
    (folder / "package.xml").write_text("<package><name>cart</name></package>")
    robot = written(folder, cart(), controlled(folder))
    file = folder / "base.yaml"
    file.write_text(file.read_text() + text)
    launch = LAUNCH.format(robot=robot, arguments=arguments)
    launch = launch.replace("    ])", f"    {managed}])")
    (folder / "sim.launch.py").write_text(launch)
    return robot


@pytest.mark.parametrize(
    ("text", "arguments", "faults"),
    [
        (PARAMETERS, ["base", "lift"], ["lift"]),
        (COMMENT, ["base", "lift"], ["lift"]),
        (OWN, ["base", "lift"], []),
        (PARAMETERS, ["base", "lift", "--controller-type", "x/Lift"], []),
        (PARAMETERS, ["base"], []),
        # It moves nothing.
        (OTHER, ["base", "lift_state_broadcaster"], []),
    ],
)
def test_a_controller_without_a_type_is_a_fault_although_another_moves_the_robot(
    tmp_path, text, arguments, faults
):
    robot = launched(tmp_path, text, arguments)
    verdict = try_robot(robot, standing=0.5)
    assert verdict.drives
    found = [each for each in verdict.faults if each.code is CONTROLLER_UNDEFINED]
    assert [(each.test, each.subject, each.source) for each in found] == [
        ("controller", name, "file") for name in faults
    ]
    reported = [each for each in check(robot).findings if each.code is CONTROLLER_UNDEFINED]
    assert len(reported) == bool(faults or text is OTHER)


def test_another_manager_may_know_the_type(tmp_path):
    node = 'Node(package="controller_manager", executable="ros2_control_node")'
    robot = launched(tmp_path, PARAMETERS, ["base", "lift"], node)
    codes = [each.code for each in check(robot).findings]
    assert CONTROLLER_UNDEFINED not in codes
