"""Mistakes in files of controllers are reported and fixed in their own line."""

# ruff: noqa: E501  (a case is a table row)

from __future__ import annotations

import pytest
from tests.checks.seeded import ARM, EFFORT, IN_CONTROLLERS, ROS1, transmission

from cartwheel.checks import controller_files

WHEELS = """drive:
  type: diff_drive_controller/DiffDriveController
  left_wheel: left_wheel_joint
  right_wheel: right_wheel_joint
  wheel_separation: 0.4  # between the tyres
  wheel_radius: 0.08
"""
RULES = {
    "controllers-file-unreadable", "controller-joint-unknown", "controller-type-unknown",
    "controller-interface-mismatch", "controller-gains-missing", "joint-claimed-twice", "wheel-separation-mismatch",
    "wheel-base-mismatch", "wheel-diameter-mismatch", "controller-parameter-repeated",
}  # fmt: skip


@pytest.fixture
def arm(spoil):
    """A robot whose arm a controller of ROS 1 can move."""
    return spoil(ROS1, transmission("arm_joint", EFFORT))


@pytest.fixture
def received(bench, tmp_path):
    """What the rules of controllers say of a robot and a file that the user names."""

    def tell(text, yaml, name="arm.yaml"):
        (tmp_path / name).write_text(yaml)
        found = bench.report(text, controller_files=[tmp_path / name]).findings
        return [finding for finding in found if finding.code.name in RULES]

    return tell


def test_a_file_without_a_fault_gives_no_finding(arm, spoil, received):
    assert received(arm, ARM) == []
    wheels = [
        transmission(f"{side}_wheel_joint", "hardware_interface/VelocityJointInterface")
        for side in ("left", "right")
    ]
    assert received(spoil(ROS1, *wheels), WHEELS) == []


@pytest.mark.parametrize("case", IN_CONTROLLERS.values(), ids=IN_CONTROLLERS)
def test_a_fault_in_a_file_is_found_and_its_advice_mends_it(case, arm, received, take):
    rule, (old, new), line, advice = case
    assert old in ARM
    wrong = ARM.replace(old, new)
    (finding,) = received(arm, wrong)
    assert finding.code.name == rule
    assert finding.severity == ("warning" if "broadcaster" in new else "error")
    assert (finding.origin.line, finding.origin.file.endswith("arm.yaml")) == (line, True)
    assert advice in finding.instead
    assert received(arm, take(wrong, finding)) == []


def test_a_type_that_is_not_simulated_is_a_note(arm, received):
    (finding,) = received(arm, ARM.replace("effort_controllers/JointPosition", "my_own/Wobble"))
    assert (finding.code.name, finding.severity, finding.instead) == (
        "controller-type-unknown",
        "info",
        "",
    )


def test_a_joint_without_a_transmission_is_given_one(spoil, received):
    text = spoil(ROS1)
    (finding,) = received(text, ARM)
    assert finding.code.name == "controller-interface-mismatch"
    assert finding.origin.line == 3
    assert received(text.replace("</robot>", finding.instead + "</robot>"), ARM) == []


def test_a_transmission_with_another_interface_is_reported_at_its_line(
    spoil, received, take, line_of
):
    text = spoil(ROS1, transmission("arm_joint", "hardware_interface/PositionJointInterface"))
    (finding,) = received(text, ARM)
    assert finding.code.name == "controller-interface-mismatch"
    assert finding.origin.line == line_of(text, "<hardwareInterface>")
    assert received(take(text, finding), ARM) == []
    # Another controller of the file has what the transmission offers: it may be the one that runs.
    other = "other:\n  type: position_controllers/JointPositionController\n  joint: arm_joint\n"
    assert received(text, ARM + other) == []


def test_hardware_of_another_kind_may_offer_anything(spoil, received):
    own = (ROS1[0], ROS1[1].replace("/>", "><robotSimType>my/Sim</robotSimType></plugin>", 1))
    assert received(spoil(own), ARM) == []


def test_two_controllers_of_one_joint_are_a_note(arm, received):
    (finding,) = received(arm, ARM + ARM.replace("arm:", "other:"))
    assert (finding.code.name, finding.severity) == ("joint-claimed-twice", "info")
    assert (finding.values["other"], finding.values["controller"]) == ("arm", "other")
    assert finding.origin.line == 7
    # Of two types one is the other's alternative.
    other = "other:\n  type: effort_controllers/JointEffortController\n  joint: arm_joint\n"
    assert "joint-claimed-twice" not in [each.code.name for each in received(arm, ARM + other)]


def test_sizes_of_wheels_are_reported_in_the_files_line(spoil, received, take):
    wheels = [
        transmission(f"{side}_wheel_joint", "hardware_interface/VelocityJointInterface")
        for side in ("left", "right")
    ]
    text = spoil(ROS1, *wheels)
    wrong = WHEELS.replace("0.4 ", "0.5 ").replace("0.08", "0.16")
    apart, radius = received(text, wrong)
    assert (apart.code.name, apart.origin.line) == ("wheel-separation-mismatch", 5)
    assert apart.instead == "wheel_separation: 0.4  # between the tyres"
    assert (radius.code.name, radius.origin.line) == ("wheel-diameter-mismatch", 6)
    assert received(text, take(take(wrong, apart), radius)) == []


ROS2 = """controller_manager:
  ros__parameters:
    arm:
      type: joint_trajectory_controller/JointTrajectoryController
arm:
  ros__parameters:
    joints: [arm_joint]
    command_interfaces: [position]
    state_interfaces: [position]
"""


def system(*commands):
    inner = "".join(f'<command_interface name="{name}"/>' for name in commands)
    return (
        "</robot>",
        f'<ros2_control name="s" type="system">\n<joint name="arm_joint">{inner}</joint>'
        "</ros2_control>\n</robot>",
    )


def test_a_command_that_ros2_control_does_not_offer_is_added(spoil, received, take):
    assert received(spoil(system("position")), ROS2) == []
    text = spoil(system("velocity"))
    (finding,) = received(text, ROS2)
    assert finding.code.name == "controller-interface-mismatch"
    assert finding.instead == '<command_interface name="position"/>'
    assert received(take(text, finding), ROS2) == []


def test_a_trajectory_by_effort_needs_gains(spoil, received, take):
    text = spoil(system("effort"))
    yaml = ROS2.replace("command_interfaces: [position]", "command_interfaces: [effort]")
    (finding,) = received(text, yaml)
    assert (finding.code.name, finding.severity) == ("controller-gains-missing", "warning")
    where = "      type: joint_trajectory_controller/JointTrajectoryController\n"
    good = yaml + f"    {finding.instead}\n"
    assert where in good
    assert received(text, good) == []


def test_a_type_of_ros1_in_a_file_of_ros2(spoil, received, take):
    yaml = ROS2.replace("joint_trajectory_controller/", "position_controllers/")
    text = spoil(system("position"))
    (finding,) = received(text, yaml)
    assert finding.code.name == "controller-type-unknown"
    assert finding.values["meant"] == "joint_trajectory_controller/JointTrajectoryController"
    assert received(text, take(yaml, finding)) == []


def test_a_file_that_lies_nearby_is_checked_where_it_is_of_this_robot(bench, arm, tmp_path):
    bench.folder = tmp_path / "arm"
    near = bench.folder / "config" / "arm.yaml"
    near.parent.mkdir(parents=True)
    (bench.folder / "package.xml").write_text("<package><name>arm</name></package>")
    near.write_text(ARM.replace("  pid: {p: 10.0, i: 0.1, d: 1.0}\n", ""))
    (finding,) = bench.find(arm, "controller-gains-missing")
    assert finding.severity == "warning"
    near.write_text(ARM.replace("arm_joint", "elbow").replace("  pid:", "  pids:"))
    assert not [f for f in bench.report(arm).findings if f.code.name in RULES]
    # Without gazebo_ros_control nothing of it matters.
    near.write_text(ARM.replace("  pid:", "  pids:"))
    without = arm.replace("libgazebo_ros_control.so", "libother.so")
    assert not [f for f in bench.report(without).findings if f.code.name in RULES]


def test_a_file_that_is_missing_or_damaged_is_reported(arm, received, bench, tmp_path):
    (finding,) = received(arm, "arm: [")
    assert (finding.code.name, finding.origin.line) == ("controllers-file-unreadable", 1)
    missing = bench.report(arm, controller_files=[tmp_path / "no.yaml"]).findings
    assert [finding.code.name for finding in missing] == ["controllers-file-unreadable"]


def test_one_controller_may_be_a_file(arm, received):
    lines = [line.removeprefix("  ") for line in ARM.splitlines()[1:]]
    assert received(arm, "\n".join(lines)) == []
    (finding,) = received(arm, "\n".join(lines).replace("arm_joint", "arm_jiont"))
    assert finding.origin.line == 2


def test_of_a_repeated_key_the_last_value_counts(spoil, received):
    wheels = [
        transmission(f"{side}_wheel_joint", "hardware_interface/VelocityJointInterface")
        for side in ("left", "right")
    ]
    once = WHEELS.replace("  type", "  wheel_separation_multiplier: 10.0\n  type")
    (wrong,) = received(spoil(ROS1, *wheels), once)
    assert wrong.code.name == "wheel-separation-mismatch"
    (repeated,) = received(spoil(ROS1, *wheels), f"{once}  wheel_separation_multiplier: 1.0\n")
    assert repeated.code.name == "controller-parameter-repeated"
    assert (repeated.origin.line, repeated.values["line"]) == (2, 8)


def test_ros2_merges_the_parameters_of_a_node_that_is_named_twice(received, spoil):
    twice = """controller_manager:
  ros__parameters:
    base: {type: diff_drive_controller/DiffDriveController}
base:
  ros__parameters:
    left_wheel_names: [left_wheel_joint]
    right_wheel_names: [right_wheel_joint]
    wheel_separation: 0.9
controller_manager:
  ros__parameters: {update_rate: 100}
base:
  ros__parameters: {wheel_radius: 0.08, wheel_separation: 0.4}
"""
    (found,) = received(spoil(ROS1), twice)
    assert found.code.name == "controller-parameter-repeated"
    assert (found.values["name"], found.origin.line, found.values["line"]) == (
        "wheel_separation",
        8,
        12,
    )


def test_a_mapping_may_merge_several_others(arm, received):
    base = "a: &a {publish_rate: 10}\nb: &b {wait: 1}\n"
    drive = WHEELS.replace("drive:\n", "drive:\n  <<: *a\n  <<: *b\n")
    assert not [each for each in received(arm, base + drive) if "repeated" in each.code.name]


def test_a_file_with_comments_only_is_read(arm, received):
    assert not received(arm, "# The joints are $(arg prefix)elbow.\n")


def test_a_file_is_searched_once_for_the_nodes_of_ros2(tmp_path, monkeypatch):
    """Each of its controllers asks whether the file is one of ROS 2."""
    path = tmp_path / "controllers.yaml"
    path.write_text("".join(f"c{n}: {{type: a/B}}\n" for n in range(9)))
    search, searched = controller_files._ros2_nodes, []

    def count(node, names):
        searched.append(names)
        return search(node, names)

    file = controller_files.ControlFile(path=path, named=True)
    monkeypatch.setattr(controller_files, "_ros2_nodes", count)
    assert not any(each.file.is_ros2 for each in file.controllers)
    assert searched.count(()) == 1
