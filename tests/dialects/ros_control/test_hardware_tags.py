"""What the tags say of joints: where they begin, whom they follow, what drives them."""

import pytest
import yaml
from tests.coded import coded
from tests.dialects.ros_control.arms import (
    ROS1,
    beam,
    robot,
    ros2_joint,
    ros2_parameters,
    ros2_plugin,
    transmission,
)
from tests.dialects.ros_control.arms import ros2_system as system

from cartwheel.codes import devices, running
from cartwheel.messages import from_dict


def ros2(bench, tmp_path, body, *joints, **controllers):
    file = tmp_path / "own.yaml"
    file.write_text(yaml.safe_dump(ros2_parameters(**controllers)))
    made = bench(robot(body + system(*joints), ros2_plugin(file)))
    made.world.run(0.05)
    return made


def group(*joints, kind="position"):
    name = "JointGroupPositionController" if kind == "position" else "JointGroupVelocityController"
    return {"type": f"{kind}_controllers/{name}", "joints": list(joints)}


def two_beams(**more):
    return beam("a", "world", **more) + beam("b", "world", origin="0 1 1", **more)


def test_joints_begin_where_their_initial_values_say(bench, tmp_path):
    first = """<joint name="a_joint"><command_interface name="position">
      <param name="min">-1</param><param name="max">1</param></command_interface>
      <state_interface name="position"><param name="initial_value">0.7</param></state_interface>
      <state_interface name="velocity"/></joint>"""
    made = ros2(bench, tmp_path, two_beams(), first, ros2_joint("b_joint"))
    assert made.position("a_joint") == pytest.approx(0.7, abs=0.01)
    assert made.position("b_joint") == pytest.approx(0.0, abs=0.01)
    # They stand there, until a controller commands them, and after a reset again.
    made.world.run(1.0)
    assert made.position("a_joint") == pytest.approx(0.7, abs=0.01)
    made.world.reset()
    made.world.run(0.05)
    assert made.position("a_joint") == pytest.approx(0.7, abs=0.01)


def test_a_type_below_a_further_level_of_parameters_is_found(bench, tmp_path):
    """ROS 2 does not find it there: the launch file of such a robot gives it to the spawner."""
    file = tmp_path / "own.yaml"
    kind = "effort_controllers/JointGroupPositionController"
    content = {
        "controller_manager": {"ros__parameters": {"lead": {"ros__parameters": {"type": kind}}}},
        "lead": {"ros__parameters": {
            "joints": ["a_joint"], "gains": {"a_joint": {"p": 200.0, "i": 0.0, "d": 20.0}},
        }},
    }  # fmt: skip
    file.write_text(yaml.safe_dump(content))
    tags = system(ros2_joint("a_joint", "effort"))
    made = bench(robot(beam("a", "world", axis="0 0 1") + tags, ros2_plugin(file)))
    assert made.warnings == []
    made.world.run(0.05)
    made.publish("/lead/commands", "std_msgs/msg/Float64MultiArray", data=[0.4])
    made.world.run(3.0)
    assert made.position("a_joint") == pytest.approx(0.4, abs=0.01)


def test_a_file_without_a_type_says_that_it_starts_nothing(bench, tmp_path):
    file = tmp_path / "own.yaml"
    file.write_text(yaml.safe_dump({"lead": {"ros__parameters": {"joints": ["a_joint"]}}}))
    tags = system(ros2_joint("a_joint"))
    made = bench(robot(beam("a", "world") + tags, ros2_plugin(file)))
    (reported,) = made.warnings
    assert reported.code is devices.CONTROLLERS_FILE_WITHOUT_CONTROLLERS
    assert reported.origin.file == str(file)


def test_a_joint_follows_another_as_its_parameters_say(bench, tmp_path):
    follower = """<joint name="b_joint"><param name="mimic">a_joint</param>
      <param name="multiplier">-0.5</param><state_interface name="position"/></joint>"""
    made = ros2(
        bench, tmp_path, two_beams(axis="0 0 1"), ros2_joint("a_joint"), follower,
        lead=group("a_joint"),
    )  # fmt: skip
    made.publish("/lead/commands", "std_msgs/msg/Float64MultiArray", data=[0.8])
    made.world.run(1.0)
    assert made.position("a_joint") == pytest.approx(0.8, abs=0.01)
    assert made.position("b_joint") == pytest.approx(-0.4, abs=0.02)


def test_a_joint_follows_another_as_the_urdf_says(bench, tmp_path):
    mimic = '<mimic joint="a_joint" multiplier="2" offset="0.1"/></joint>'
    body = two_beams(axis="0 0 1")
    body = body[: body.rindex("</joint>")] + mimic
    made = ros2(bench, tmp_path, body, ros2_joint("a_joint"), lead=group("a_joint"))
    made.publish("/lead/commands", "std_msgs/msg/Float64MultiArray", data=[0.3])
    made.world.run(1.0)
    assert made.position("b_joint") == pytest.approx(2 * 0.3 + 0.1, abs=0.02)


@pytest.mark.parametrize("interface", ["Position", "Effort"])
def test_a_joint_that_follows_is_not_held_by_a_transmission_of_its_own(bench, interface):
    """As of the second finger of grippers, which no controller commands."""
    mimic = '<mimic joint="a_joint" multiplier="-1"/></joint>'
    body = two_beams(axis="0 0 1")
    body = body[: body.rindex("</joint>")] + mimic
    tags = transmission("a_joint", "Position") + transmission("b_joint", interface)
    lead = {"type": "position_controllers/JointPositionController", "joint": "a_joint"}
    made = bench(robot(body + tags, ROS1), {"lead": lead})
    made.publish("/lead/command", "std_msgs/msg/Float64", data=0.3)
    made.world.run(1.0)
    assert made.position("a_joint") == pytest.approx(0.3, abs=0.01)
    assert made.position("b_joint") == pytest.approx(-0.3, abs=0.02)


def test_a_joint_of_several_interfaces_takes_what_its_controller_commands(bench, tmp_path):
    """As universal robots' have position and velocity; one controller runs, then the other."""
    made = ros2(
        bench, tmp_path, beam("a", "world", axis="0 0 1"),
        ros2_joint("a_joint", "position", "velocity"),
        place=group("a_joint"), speed=group("a_joint", kind="velocity"),
    )  # fmt: skip
    assert coded(made.warnings, running.CONTROLLER_NOT_STARTED, controller="speed")
    made.publish("/place/commands", "std_msgs/msg/Float64MultiArray", data=[0.5])
    made.world.run(0.5)
    assert made.position("a_joint") == pytest.approx(0.5, abs=0.01)
    switch = made.world.graph.service("/controller_manager/switch_controller")
    request = {"activate_controllers": ["speed"], "deactivate_controllers": ["place"]}
    kind = "controller_manager_msgs_ros2/srv/SwitchController_Request"
    assert switch.handler(from_dict(kind, {**request, "strictness": 2})).ok
    made.publish("/speed/commands", "std_msgs/msg/Float64MultiArray", data=[0.4])
    made.world.run(1.05)
    assert made.position("a_joint") == pytest.approx(0.5 + 0.4, abs=0.03)


@pytest.mark.parametrize(
    "written",
    [
        "hardware_interface/PositionJointInterface",
        "PositionJointInterface",
        " hardware_interface/PositionJointInterface\n",
    ],
)
def test_interfaces_of_transmissions_by_either_name_and_reductions_mean_nothing(bench, written):
    plain = transmission("a_joint", "Position")
    start = plain.index("<hardwareInterface>")
    end = plain.index("</hardwareInterface>")
    tag = plain[:start] + f"<hardwareInterface>{written}" + plain[end:]
    geared = tag.replace(
        '<actuator name="m_a_joint"/>',
        '<actuator name="m_a_joint"><mechanicalReduction>50</mechanicalReduction></actuator>',
    )
    made = bench(
        robot(beam("a", "world") + geared, ROS1),
        {"one": {"type": "position_controllers/JointPositionController", "joint": "a_joint"}},
    )
    made.world.run(0.1)
    made.publish("/one/command", "std_msgs/msg/Float64", data=0.4)
    made.world.run(0.5)
    # Gazebo's hardware knows no motors: a command is the joint's own.
    assert made.position("a_joint") == pytest.approx(0.4, abs=1e-3)
    assert made.warnings == []


DIFFERENTIAL = """<transmission name="wrist"><type>transmission_interface/DifferentialTransmission
  </type><actuator name="m1"/><actuator name="m2"/>
  <joint name="a_joint"><hardwareInterface>PositionJointInterface</hardwareInterface></joint>
  <joint name="b_joint"><hardwareInterface>PositionJointInterface</hardwareInterface></joint>
  </transmission>"""


def wrist(bench, plugin):
    made = bench(
        robot(two_beams(axis="0 0 1") + DIFFERENTIAL, plugin), {"c": group("a_joint", "b_joint")}
    )
    made.publish("/c/command", "std_msgs/msg/Float64MultiArray", data=[0.3, -0.4])
    made.world.run(1.0)
    return made


def test_another_hardware_drives_all_joints_of_a_transmission(bench):
    own = ROS1.replace("</plugin>", "<robotSimType>my_hardware/MyHWSim</robotSimType></plugin>")
    made = wrist(bench, own)
    assert made.position("a_joint") == pytest.approx(0.3, abs=1e-3)
    assert made.position("b_joint") == pytest.approx(-0.4, abs=1e-3)


def test_the_default_hardware_drives_none_of_several(bench):
    made = wrist(bench, ROS1)
    assert coded(made.warnings, devices.TRANSMISSION_IGNORED, joints=2)
    cause = devices.CONTROLLER_INTERFACE_MISMATCH.number
    assert coded(made.warnings, running.CONTROLLER_NOT_STARTED, joint="a_joint", cause=cause)


@pytest.mark.wording
def test_a_controller_of_a_fixed_joint_with_a_transmission_says_that_it_is_fixed(bench):
    body = beam("a", "world", kind="fixed") + transmission("a_joint", "Position")
    made = bench(robot(body, ROS1), {"c": group("a_joint")})
    (found,) = coded(made.warnings, running.CONTROLLER_NOT_STARTED)
    assert found.values["cause"] == devices.CONTROLLER_INTERFACE_MISMATCH.number
    assert "because it is fixed" in found.message


@pytest.mark.parametrize("order", [1, -1], ids=["controllers first", "drive first"])
@pytest.mark.parametrize("interface", ["Effort", "Velocity"])
def test_a_drive_and_controllers_may_name_one_joint(bench, order, interface):
    """As Gazebo has it: a motor that holds its speed, and whatever effort is given beside it.

    Without a controller, the effort is 0, so that both do not work against each other.
    """
    motor = """<plugin name="drive" filename="librotors_gazebo_motor_model.so">
      <robotNamespace>/</robotNamespace><jointName>beam_joint</jointName><linkName>beam</linkName>
      <turningDirection>ccw</turningDirection><motorConstant>0</motorConstant>
      <rotorDragCoefficient>0</rotorDragCoefficient><motorNumber>0</motorNumber>
      <rotorVelocitySlowdownSim>1</rotorVelocitySlowdownSim></plugin>"""
    base = """<link name="base"/><joint name="bolt" type="fixed"><parent link="world"/>
      <child link="base"/></joint>"""
    upright = base + beam("beam", "base", axis="0 0 1", kind="continuous")
    plugins = "".join((ROS1, motor)[::order])
    made = bench(robot(upright + transmission("beam_joint", interface), plugins))
    reported = coded(made.warnings, running.JOINT_DRIVEN_TWICE, joint="beam_joint")
    assert bool(reported) == (interface == "Velocity")
    if interface == "Effort":
        made.publish("/command/motor_speed", "mav_msgs/msg/Actuators", angular_velocities=[3.0])
        made.world.run(1.0)
        before = made.position("beam_joint")
        made.world.run(0.5)
        assert made.position("beam_joint") - before == pytest.approx(1.5, rel=0.01)
