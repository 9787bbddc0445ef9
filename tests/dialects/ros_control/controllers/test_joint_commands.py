"""Controllers of single joints and groups, on beams whose physics is known."""

import math

import pytest
from tests.coded import coded
from tests.dialects.ros_control.arms import (
    ARM,
    GRAVITY,
    INERTIA,
    MASS,
    ROS1,
    beam,
    robot,
    transmission,
)

from cartwheel.codes import devices, running

WEIGHT = MASS * GRAVITY * ARM
TURNED = INERTIA + MASS * ARM**2
"""kg m², about the joint."""


def one(interface, **more):
    return robot(beam("beam", "world", **more) + transmission("beam_joint", interface), ROS1)


def controller(kind, **more):
    return {"c": {"type": kind, "joint": "beam_joint", **more}}


def test_an_effort_controller_without_a_command_lets_it_fall(bench):
    made = bench(one("Effort"), controller("effort_controllers/JointEffortController"))
    made.world.run(0.2)
    # Less than free fall at the horizontal, and more than at the angle that it reached.
    angle = made.position("beam_joint")
    assert angle == pytest.approx(0.5 * WEIGHT / TURNED * 0.2**2, rel=0.1)


def test_an_effort_accelerates(bench):
    """About an upright axis: half of M / J t²."""
    made = bench(
        one("Effort", axis="0 0 1"), controller("effort_controllers/JointEffortController")
    )
    made.publish("/c/command", "std_msgs/msg/Float64", data=3.0)
    made.world.run(0.5)
    assert made.position("beam_joint") == pytest.approx(0.5 * 3.0 / TURNED * 0.5**2, rel=0.03)


def test_an_effort_is_limited_to_the_joints(bench):
    limit = 'lower="-3" upper="3" effort="2" velocity="100"'
    made = bench(
        one("Effort", axis="0 0 1", limit=limit),
        controller("effort_controllers/JointEffortController"),
    )
    made.publish("/c/command", "std_msgs/msg/Float64", data=50.0)
    made.world.run(0.5)
    assert made.position("beam_joint") == pytest.approx(0.5 * 2.0 / TURNED * 0.5**2, rel=0.03)


def test_a_pid_on_velocity_reaches_it_although_the_effort_is_limited(bench):
    """P times the target is 40 times the limit, which holds until the joint is fast enough.

    About an upright axis, 2 N m accelerate the beam to 2 rad/s within 2 J / 2 N m = 0.6 s. The
    limit applies to the difference of the target and the velocity: limiting P times the target
    instead would end at 2 / 40 rad/s.
    """
    limit = 'lower="-100" upper="100" effort="2" velocity="100"'
    made = bench(
        one("Effort", axis="0 0 1", limit=limit),
        controller("effort_controllers/JointVelocityController", pid={"p": 40.0}),
    )
    made.publish("/c/command", "std_msgs/msg/Float64", data=2.0)
    made.world.run(0.3)
    # Half of M / J t².
    assert made.position("beam_joint") == pytest.approx(0.5 * 2.0 / TURNED * 0.3**2, rel=0.05)
    made.world.run(1.0)
    before = made.position("beam_joint")
    made.world.run(0.5)
    assert made.position("beam_joint") - before == pytest.approx(2.0 * 0.5, rel=0.01)


def test_a_pid_on_effort_sags_by_what_the_weight_asks(bench):
    """In the end p times the error bears the weight, which the angle makes a little less."""
    p = 400.0
    made = bench(
        one("Effort"),
        controller("effort_controllers/JointPositionController", pid={"p": p, "d": 40.0}),
    )
    made.publish("/c/command", "std_msgs/msg/Float64", data=0.5)
    box = made.box("/c/state")
    made.world.run(4.0)
    angle = made.position("beam_joint")
    # The angle grows downwards: the axis is y.
    assert p * (0.5 - angle) == pytest.approx(-WEIGHT * math.cos(angle), rel=0.01)
    state = box.drain()[-1]
    assert state.set_point == 0.5
    assert state.error == pytest.approx(0.5 - angle, abs=1e-4)
    assert (state.p, state.d) == (p, 40.0)


def test_a_pid_on_effort_answers_a_step_as_an_oscillator(bench):
    """Upright axis, no integral: J a = p (x - q) - d v, underdamped, once past the target.

    The derivative's answer to the step itself, d times the step in one period, is a push that
    starts it at the speed d x / J.
    """
    p, d, target = 60.0, 4.0, 0.2
    made = bench(
        one("Effort", axis="0 0 1", limit='lower="-3" upper="3" effort="1e5" velocity="1e3"'),
        controller("effort_controllers/JointPositionController", pid={"p": p, "d": d}),
    )
    made.world.run(0.1)
    made.publish("/c/command", "std_msgs/msg/Float64", data=target)
    rate, decay = math.sqrt(p / TURNED), d / (2 * TURNED)
    damped = math.sqrt(rate**2 - decay**2)
    for seconds in (0.1, 0.2, 0.4):
        made.world.run(0.1 if seconds < 0.4 else 0.2)
        start = d * target / TURNED
        # About the target: x(0) = -target, v(0) = start.
        b = (start - decay * target) / damped
        left = math.exp(-decay * seconds) * (
            -target * math.cos(damped * seconds) + b * math.sin(damped * seconds)
        )
        assert made.position("beam_joint") == pytest.approx(target + left, abs=0.012)


def test_a_position_is_held_exactly_whatever_it_bears(bench):
    made = bench(one("Position"), controller("position_controllers/JointPositionController"))
    made.publish("/c/command", "std_msgs/msg/Float64", data=-0.7)
    made.world.run(1.5)
    assert made.position("beam_joint") == pytest.approx(-0.7, abs=1e-4)


def test_a_position_is_reached_no_faster_than_the_joints_velocity(bench):
    limit = 'lower="-3" upper="3" effort="200" velocity="0.5"'
    made = bench(
        one("Position", limit=limit), controller("position_controllers/JointPositionController")
    )
    made.world.run(0.1)
    made.publish("/c/command", "std_msgs/msg/Float64", data=1.0)
    made.world.run(1.0)
    assert made.position("beam_joint") == pytest.approx(0.5, abs=0.01)
    made.world.run(1.5)
    assert made.position("beam_joint") == pytest.approx(1.0, abs=1e-3)


def test_a_position_beyond_the_limits_is_the_limit(bench):
    limit = 'lower="-0.3" upper="0.3" effort="200" velocity="5"'
    made = bench(
        one("Position", limit=limit), controller("position_controllers/JointPositionController")
    )
    made.publish("/c/command", "std_msgs/msg/Float64", data=2.0)
    made.world.run(1.0)
    assert made.position("beam_joint") == pytest.approx(0.3, abs=1e-3)


def test_a_velocity_turns_and_zero_holds(bench):
    made = bench(one("Velocity"), controller("velocity_controllers/JointVelocityController"))
    made.world.run(0.5)
    assert made.position("beam_joint") == pytest.approx(0.0, abs=1e-3)
    made.publish("/c/command", "std_msgs/msg/Float64", data=-0.6)
    made.world.run(1.0)
    assert made.position("beam_joint") == pytest.approx(-0.6, abs=0.01)


def test_pid_gains_of_the_hardware_make_positions_efforts(bench):
    """As DefaultRobotHWSim: with p and no integral it sags, which a held position does not."""
    p = 300.0
    made = bench(
        one("Position"),
        {
            **controller("position_controllers/JointPositionController"),
            "gazebo_ros_control": {"pid_gains": {"beam_joint": {"p": p, "d": 30.0}}},
        },
    )
    made.world.run(4.0)
    angle = made.position("beam_joint")
    assert p * -angle == pytest.approx(-WEIGHT * math.cos(angle), rel=0.01)


def test_the_gains_of_several_files_are_merged(bench):
    """roslaunch sets each number as a parameter of its own, so a file replaces no mapping."""
    body = beam("a", "world", axis="0 0 1") + beam("b", "world", axis="0 0 1", origin="0 1 1")
    urdf = robot(
        body + transmission("a_joint", "Position") + transmission("b_joint", "Position"), ROS1
    )
    more = {"gazebo_ros_control": {"pid_gains": {"b_joint": {"p": 7.0}, "a_joint": {"d": 2.0}}}}
    made = bench(
        urdf,
        {"gazebo_ros_control": {"pid_gains": {"a_joint": {"p": 5.0, "d": 1.0}}}},
        more,
    )
    gains = made.world.graph.parameters.get("/gazebo_ros_control/pid_gains")
    assert gains == {"a_joint": {"p": 5.0, "d": 2.0}, "b_joint": {"p": 7.0}}


def test_a_group_takes_one_value_for_each(bench):
    body = beam("a", "world") + beam("b", "world", origin="0 1 1")
    urdf = robot(
        body + transmission("a_joint", "Position") + transmission("b_joint", "Position"), ROS1
    )
    made = bench(
        urdf,
        {
            "g": {
                "type": "position_controllers/JointGroupPositionController",
                "joints": ["b_joint", "a_joint"],
            }
        },
    )
    made.publish("/g/command", "std_msgs/msg/Float64MultiArray", data=[0.4, -0.2])
    made.world.run(1.0)
    assert made.position("b_joint") == pytest.approx(0.4, abs=1e-3)
    assert made.position("a_joint") == pytest.approx(-0.2, abs=1e-3)
    made.publish("/g/command", "std_msgs/msg/Float64MultiArray", data=[0.4])
    made.world.run(0.1)
    assert coded(made.warnings, running.COMMAND_IGNORED, got=1, joints=2)


def test_a_group_of_one_interface_may_name_it(bench):
    made = bench(
        robot(beam("beam", "world") + transmission("beam_joint", "Position"), ROS1),
        {
            "group": {
                "type": "position_controllers/JointGroupPositionController",
                "joints": ["beam_joint"],
                "interface_name": "position",
            }
        },
    )
    assert made.warnings == []


def test_a_wrong_interface_is_reported_and_the_rest_runs(bench):
    made = bench(
        one("Effort"),
        {
            **controller("position_controllers/JointPositionController"),
            "states": {"type": "joint_state_controller/JointStateController", "publish_rate": 20},
        },
    )
    cause = devices.CONTROLLER_INTERFACE_MISMATCH.number
    assert coded(
        made.warnings,
        running.CONTROLLER_NOT_STARTED,
        cause=cause,
        interface="position",
        offered="effort",
    )
    box = made.box("/joint_states")
    made.world.run(1.0)
    found = box.drain()
    assert len(found) == pytest.approx(20, abs=1)
    assert found[0].name == ["beam_joint"]


def test_a_reset_begins_anew(bench):
    made = bench(one("Position"), controller("position_controllers/JointPositionController"))
    made.publish("/c/command", "std_msgs/msg/Float64", data=0.5)
    made.world.run(1.0)
    made.world.reset()
    made.world.run(0.5)
    assert made.position("beam_joint") == pytest.approx(0.0, abs=1e-3)
    made.publish("/c/command", "std_msgs/msg/Float64", data=0.3)
    made.world.run(1.0)
    assert made.position("beam_joint") == pytest.approx(0.3, abs=1e-3)


POSITION = {"type": "effort_controllers/JointPositionController"}


def test_a_limited_pid_with_damping_does_not_throw_a_light_joint_to_and_fro(bench):
    """10 N m accelerate 0.01 kg m² by 10 rad/s in 10 ms, and the joint's limit is 0.5 rad/s.

    With p = d, the error decreases with the time constant d / p = 1 s.
    """
    limit = 'lower="-3" upper="3" effort="10" velocity="0.5"'
    body = beam("beam", "world", axis="0 0 1", limit=limit)
    body = body.replace(f'xyz="{ARM} 0 0"', 'xyz="0 0 0"').replace(f'"{INERTIA}"', '"0.01"')
    made = bench(
        robot(body + transmission("beam_joint", "Effort"), ROS1),
        controller("effort_controllers/JointPositionController", pid={"p": 10.0, "d": 10.0}),
    )
    made.publish("/c/command", "std_msgs/msg/Float64", data=0.2)
    made.world.run(1.0)
    early = 0.2 - made.position("beam_joint")
    made.world.run(1.0)
    assert 0.2 - made.position("beam_joint") == pytest.approx(early * math.exp(-1.0), rel=0.05)


@pytest.mark.parametrize("inertia", [1e-1, 1e-4, 1e-7])
def test_a_pid_without_damping_explodes_for_no_joint_however_light(bench, inertia):
    link = f"""<link name="tip"><inertial><mass value="1e-3"/><inertia ixx="{inertia}"
      iyy="{inertia}" izz="{inertia}" ixy="0" ixz="0" iyz="0"/></inertial></link>
      <joint name="tip_joint" type="continuous"><parent link="world"/><child link="tip"/>
      <axis xyz="0 1 0"/><limit effort="1000" velocity="1000"/></joint>"""
    made = bench(
        robot(link + transmission("tip_joint", "Effort"), ROS1),
        {"tip": {**POSITION, "joint": "tip_joint", "pid": {"p": 10.0}}},
    )
    made.publish("/tip/command", "std_msgs/msg/Float64", data=0.5)
    made.world.run(1.0)
    # An undamped spring swings from 0 to twice its target, and no farther.
    for _ in range(40):
        made.world.run(0.02)
        assert -0.05 < made.position("tip_joint") < 1.05


@pytest.mark.parametrize("root", ["", "/"])
def test_a_file_s_controllers_may_stand_under_the_root_s_name(bench, root):
    content = {root: {"one": {**POSITION, "joint": "beam_joint", "pid": {"p": 500.0, "d": 50.0}}}}
    made = bench(one("Effort"), content)
    made.publish("/one/command", "std_msgs/msg/Float64", data=0.3)
    made.world.run(2.0)
    # A spring of 500 N m/rad under the weight of the beam.
    assert made.position("beam_joint") == pytest.approx(0.3, abs=WEIGHT / 500)


@pytest.mark.parametrize("d", [0.5, 5.0])
def test_the_derivative_gain_of_a_velocity_does_not_overshoot(bench, d):
    """A change of the command moves the joint by d / (J + d) of it at once, and p does the rest."""
    limit = 'lower="-30" upper="30" effort="1e5" velocity="100"'
    made = bench(
        one("Effort", axis="0 0 1", limit=limit),
        controller("effort_controllers/JointVelocityController", pid={"p": 2.0, "d": d}),
    )
    made.world.run(0.1)
    made.publish("/c/command", "std_msgs/msg/Float64", data=1.0)
    joint = made.world.session.simulation
    speeds = []
    for _ in range(400):
        made.world.run(0.005)
        joint.refresh()
        speeds.append(float(joint.data.qvel[0]))
    jump = next(each for each in speeds if each > 0)
    assert jump == pytest.approx(d / (TURNED + d), abs=0.03)
    assert max(speeds) <= 1.001
    assert speeds[-1] == pytest.approx(1.0, abs=0.01)
