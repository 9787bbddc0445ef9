"""Controllers that command others, and the PID that they mostly command."""

import math

import pytest
import yaml
from tests.coded import coded
from tests.dialects.ros_control.arms import (
    ARM,
    GRAVITY,
    INERTIA,
    MASS,
    beam,
    robot,
    ros2_joint,
    ros2_parameters,
    ros2_plugin,
    ros2_system,
)
from tests.dialects.ros_control.cars import RADIUS, TRACK, car, four_wheels

from cartwheel.codes import running
from cartwheel.messages import from_dict

PID = "pid_controller/PidController"
COMMAND = "control_msgs_ros2/msg/MultiDOFCommand"
POSITIONS = "std_msgs/msg/Float64MultiArray"
TURNED = INERTIA + MASS * ARM**2
"""kg m², about the joint."""
UPRIGHT = "0 0 1"


def pid(command="effort", *, states=("position",), joint="beam_joint", **gains):
    return {
        "type": PID,
        "dof_names": [joint],
        "command_interface": command,
        "reference_and_state_interfaces": list(states),
        "gains": {joint: gains},
    }


def group(joint="loop/beam_joint", interface="position"):
    return {
        "type": "forward_command_controller/ForwardCommandController",
        "joints": [joint],
        "interface_name": interface,
    }


@pytest.fixture
def arm(bench, tmp_path):
    """A beam with an effort interface, and controllers in the order that they are given."""

    def make(axis=UPRIGHT, commands=("effort",), **controllers):
        file = tmp_path / "own.yaml"
        file.write_text(yaml.safe_dump(ros2_parameters(100, **controllers), sort_keys=False))
        body = beam("beam", "world", axis=axis) + ros2_system(ros2_joint("beam_joint", *commands))
        return bench(robot(body, ros2_plugin(file)))

    return make


def manager(made, service, kind, **fields):
    request = from_dict(f"controller_manager_msgs_ros2/srv/{kind}_Request", fields)
    return made.world.graph.service(f"/controller_manager/{service}").handler(request)


def switch(made, *, start=(), stop=()):
    answer = manager(
        made,
        "switch_controller",
        "SwitchController",
        activate_controllers=list(start),
        deactivate_controllers=list(stop),
        strictness=2,
    )
    made.world.run(0.05)
    return answer


def listed(made):
    answer = manager(made, "list_controllers", "ListControllers")
    return {each.name: each for each in answer.controller}


def test_a_reference_of_a_position_is_held_by_effort(arm):
    """In the end p times the error bears the weight."""
    made = arm(axis="0 1 0", loop=pid(p=400.0, d=40.0))
    box = made.box("/loop/controller_state")
    made.publish("/loop/reference", COMMAND, dof_names=["beam_joint"], values=[0.5])
    made.world.run(4.0)
    angle = made.position("beam_joint")
    held = -MASS * GRAVITY * ARM * math.cos(angle)
    assert 400.0 * (0.5 - angle) == pytest.approx(held, rel=0.01)
    (state,) = box.drain()[-1].dof_states
    assert (state.name, state.reference) == ("beam_joint", 0.5)
    assert state.feedback == pytest.approx(angle, abs=1e-4)
    assert state.error == pytest.approx(0.5 - angle, abs=1e-4)
    assert made.warnings == []


def test_it_holds_where_it_began(arm):
    made = arm(loop=pid(p=400.0, d=40.0))
    made.world.run(1.0)
    assert made.position("beam_joint") == pytest.approx(0.0, abs=1e-9)


def test_a_reference_is_fed_forward_until_that_is_switched_off(arm):
    """Without any gain the feed forward is all: an effort of 3 for a velocity of 1.5."""
    made = arm(loop=pid(states=["velocity"], feedforward_gain=2.0))
    made.publish("/loop/reference", COMMAND, values=[1.5])
    made.world.run(0.5)
    before = made.position("beam_joint")
    assert before == pytest.approx(0.5 * 3.0 / TURNED * 0.5**2, rel=0.05)
    assert made.call("/loop/set_feedforward_control", data=False).success
    speed = 3.0 / TURNED * 0.5
    made.world.run(0.5)
    assert made.position("beam_joint") - before == pytest.approx(speed * 0.5, rel=0.05)


def test_a_velocity_is_followed_by_effort(arm):
    made = arm(loop=pid(states=["velocity"], p=20.0))
    made.publish("/loop/reference", COMMAND, values=[0.5])
    made.world.run(1.0)
    before = made.position("beam_joint")
    made.world.run(1.0)
    assert made.position("beam_joint") - before == pytest.approx(0.5, rel=0.01)


def test_what_is_measured_may_come_from_outside(arm):
    """Its measured position is halfway: the effort is half of p times the reference."""
    made = arm(loop=pid(p=4.0) | {"use_external_measured_states": True})
    made.publish("/loop/measured_state", COMMAND, values=[0.5])
    made.publish("/loop/reference", COMMAND, values=[1.0])
    made.world.run(0.5)
    assert made.position("beam_joint") == pytest.approx(0.5 * 2.0 / TURNED * 0.5**2, rel=0.05)


def test_a_reference_of_other_joints_is_reported(arm):
    made = arm(loop=pid(p=4.0))
    made.publish("/loop/reference", COMMAND, dof_names=["elbow"], values=[1.0])
    made.world.run(0.5)
    assert made.position("beam_joint") == pytest.approx(0.0, abs=1e-9)
    assert coded(made.warnings, running.COMMAND_IGNORED)


@pytest.mark.parametrize("states", [["torque"], ["velocity", "position"], []])
def test_states_that_make_no_sense_are_refused(arm, states):
    made = arm(loop=pid(states=states, p=4.0))
    assert coded(
        made.warnings,
        running.CONTROLLER_NOT_STARTED,
        parameter="reference_and_state_interfaces",
    )


def test_a_controller_commands_another_in_whatever_order_they_stand(arm):
    made = arm(top=group(), loop=pid(p=400.0, d=40.0))
    made.publish("/top/commands", POSITIONS, data=[0.5])
    made.world.run(2.0)
    assert made.position("beam_joint") == pytest.approx(0.5, abs=1e-3)
    assert made.warnings == []
    assert listed(made)["loop"].is_chained
    assert list(listed(made)["loop"].reference_interfaces) == ["beam_joint/position"]
    assert listed(made)["top"].claimed_interfaces == ["loop/beam_joint/position"]
    (connection,) = listed(made)["top"].chain_connections
    assert connection.name == "loop"


def test_a_command_passes_through_a_chain_within_one_update(arm):
    """As fast as straight: those that command come first."""
    chain = arm(top=group("loop/beam_joint"), loop=pid(p=40.0))
    chain.publish("/top/commands", POSITIONS, data=[0.5])
    chain.world.run(0.3)
    through = chain.position("beam_joint")
    alone = arm(loop=pid(p=40.0))
    alone.publish("/loop/reference", COMMAND, values=[0.5])
    alone.world.run(0.3)
    assert through == alone.position("beam_joint") != 0.0


def test_a_chain_may_have_three_links(arm):
    """A PID on position gives velocities to one that gives efforts."""
    outer = pid("velocity", joint="inner/beam_joint", p=3.0) | {
        "reference_and_state_dof_names": ["beam_joint"]
    }
    made = arm(top=group("outer/beam_joint"), outer=outer, inner=pid(states=["velocity"], p=20.0))
    made.publish("/top/commands", POSITIONS, data=[0.5])
    made.world.run(4.0)
    assert made.position("beam_joint") == pytest.approx(0.5, abs=1e-3)
    assert made.warnings == []


def test_what_is_commanded_does_not_listen_until_it_is_free(arm):
    made = arm(top=group(), loop=pid(p=400.0, d=40.0))
    made.world.run(0.1)
    made.publish("/loop/reference", COMMAND, values=[0.5])
    made.world.run(1.0)
    assert made.position("beam_joint") == pytest.approx(0.0, abs=1e-6)
    assert switch(made, stop=["top"]).ok
    assert not listed(made)["loop"].is_chained
    made.publish("/loop/reference", COMMAND, values=[0.5])
    made.world.run(2.0)
    assert made.position("beam_joint") == pytest.approx(0.5, abs=1e-3)


def test_what_is_commanded_neither_stops_alone_nor_starts_late(arm):
    made = arm(top=group(), loop=pid(p=400.0, d=40.0))
    made.world.run(0.1)
    answer = switch(made, stop=["loop"])
    assert made.refuses(answer.ok, running.CONTROLLER_CONFLICT, controller="loop", by="top")
    assert switch(made, stop=["loop", "top"]).ok
    answer = switch(made, start=["top"])
    assert made.refuses(answer.ok, running.CONTROLLER_CONFLICT, controller="top", by="loop")
    assert switch(made, start=["top", "loop"]).ok
    made.publish("/top/commands", POSITIONS, data=[0.5])
    made.world.run(2.0)
    assert made.position("beam_joint") == pytest.approx(0.5, abs=1e-3)


def test_the_spawner_takes_over_a_chain_that_runs(arm):
    """It configures what runs from the start, which stops it; then it starts all."""
    made = arm(loop=pid(p=400.0, d=40.0), top=group())
    made.world.run(0.1)
    for name in ("loop", "top"):
        assert manager(made, "configure_controller", "ConfigureController", name=name).ok
    assert {each.state for each in listed(made).values()} == {"inactive"}
    assert switch(made, start=["loop", "top"]).ok
    made.publish("/top/commands", POSITIONS, data=[0.5])
    made.world.run(2.0)
    assert made.position("beam_joint") == pytest.approx(0.5, abs=1e-3)


def test_a_chain_stops_with_its_hardware(arm):
    made = arm(loop=pid(p=400.0, d=40.0), top=group())
    made.world.run(0.1)
    answer = manager(
        made,
        "set_hardware_component_state",
        "SetHardwareComponentState",
        name="bench",
        target_state={"id": 2, "label": "inactive"},
    )
    made.world.run(0.05)
    assert answer.ok
    assert {each.state for each in listed(made).values()} == {"inactive"}


def test_what_was_loaded_anew_is_commanded_by_nobody_who_knew_it_before(arm):
    made = arm(loop=pid(p=400.0, d=40.0), top=group())
    made.world.run(0.1)
    assert switch(made, stop=["loop", "top"]).ok
    assert manager(made, "unload_controller", "UnloadController", name="loop").ok
    answer = switch(made, start=["top"])
    assert made.refuses(answer.ok, running.CONTROLLER_CONFLICT, controller="top", by="loop")
    assert manager(made, "load_controller", "LoadController", name="loop").ok
    assert manager(made, "configure_controller", "ConfigureController", name="loop").ok
    answer = switch(made, start=["loop", "top"])
    assert made.refuses(answer.ok, running.CONTROLLER_CONFLICT, controller="top", by="loop")
    assert manager(made, "configure_controller", "ConfigureController", name="top").ok
    assert switch(made, start=["loop", "top"]).ok


def test_a_controller_that_commands_one_that_is_not_there_is_reported(arm):
    made = arm(top=group("lop/beam_joint"), loop=pid(p=4.0))
    assert coded(made.warnings, running.CONTROLLER_NOT_STARTED, name="lop/beam_joint")


def test_a_trajectory_is_followed_through_a_pid(arm):
    made = arm(
        loop=pid(p=400.0, d=40.0),
        top={
            "type": "joint_trajectory_controller/JointTrajectoryController",
            "joints": ["beam_joint"],
            "command_joints": ["loop/beam_joint"],
            "command_interfaces": ["position"],
            "state_interfaces": ["position", "velocity"],
        },
    )
    point = {"positions": [0.5], "time_from_start": {"sec": 1}}
    made.publish(
        "/top/joint_trajectory",
        "trajectory_msgs/msg/JointTrajectory",
        joint_names=["beam_joint"],
        points=[point],
    )
    made.world.run(3.0)
    assert made.position("beam_joint") == pytest.approx(0.5, abs=1e-3)


def test_a_drive_s_wheels_are_held_by_pids(make, tmp_path):
    """It drives as one whose wheels are held straight, and its odometry says so."""
    names = list(four_wheels())
    loops = {
        f"{name}_pid": pid("velocity", states=["velocity"], joint=f"{name}_joint",
                           feedforward_gain=1.0, p=0.2)
        for name in names
    }  # fmt: skip
    sides = {
        f"{side}_wheel_names": [f"{n}_pid/{n}_joint" for n in names if n.endswith(side)]
        for side in ("left", "right")
    }
    drive = {
        "type": "diff_drive_controller/DiffDriveController",
        **sides,
        "wheel_separation": TRACK,
        "wheel_radius": RADIUS,
    }
    file = tmp_path / "drive.yaml"
    file.write_text(yaml.safe_dump(ros2_parameters(base=drive, **loops)))
    plugin = ros2_plugin(file)
    path = tmp_path / "car.urdf"
    path.write_text(car(four_wheels(), plugin, [f"{name}_joint" for name in names]))
    world = make.world()
    model = world.spawn(path, z=RADIUS)
    box = world.mailbox("/base/odom", size=1000)
    world.run(0.2)
    for _ in range(20):
        world.publish("/base/cmd_vel", twist_linear_x=0.5)
        world.run(0.1)
    # The first command acts at the next update, after 10 ms, and the wheels accelerate for 50 ms:
    # 0.5 m/s (0.01 + 0.05 / 2) s, which is 0.02 m. Its tyres slide in turns and are therefore soft.
    # They slip by 0.03 m meanwhile, which the odometry does not see.
    assert model.pose.x == pytest.approx(0.5 * 2.0 - 0.02 - 0.015, abs=0.015)
    assert box.drain()[-1].pose.pose.position.x == pytest.approx(model.pose.x, abs=0.035)
    assert [d for d in world.diagnostics if d.severity == "warning"] == []
