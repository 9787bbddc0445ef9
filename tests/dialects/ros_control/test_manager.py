"""The controller manager's services, and what may run beside what."""

import pytest
from tests.coded import coded
from tests.dialects.ros_control.arms import (
    ROS1,
    beam,
    robot,
    ros2_joint,
    ros2_plugin,
    ros2_system,
    transmission,
)

from cartwheel.codes import devices, running

STRICT, BEST_EFFORT = 2, 1
ONE = {"type": "position_controllers/JointPositionController", "joint": "beam_joint"}


@pytest.fixture
def arm(bench):
    made = bench(robot(beam("beam", "world") + transmission("beam_joint", "Position"), ROS1))
    parameters = made.world.graph.parameters
    parameters.set("/one", ONE)
    parameters.set("/two", ONE)
    parameters.set(
        "/states", {"type": "joint_state_controller/JointStateController", "publish_rate": 10}
    )
    made.world.graph.post = lambda function: function()
    return made


def load(made, name):
    return made.call("/controller_manager/load_controller", name=name).ok


def switch(made, start=(), stop=(), strictness=STRICT):
    return made.call(
        "/controller_manager/switch_controller",
        start_controllers=list(start),
        stop_controllers=list(stop),
        strictness=strictness,
        start_asap=False,
        timeout=0.0,
    ).ok


def states(made):
    answer = made.call(
        "/controller_manager/list_controllers", structure_needs_at_least_one_member=0
    )
    return {each.name: each.state for each in answer.controller}


def test_a_controller_is_loaded_started_stopped_and_unloaded(arm):
    assert load(arm, "one")
    assert states(arm) == {"one": "initialized"}
    assert switch(arm, start=["one"])
    arm.publish("/one/command", "std_msgs/msg/Float64", data=0.4)
    arm.world.run(1.0)
    assert states(arm) == {"one": "running"}
    assert arm.position("beam_joint") == pytest.approx(0.4, abs=1e-3)
    answer = arm.call("/controller_manager/unload_controller", name="one")
    assert arm.refuses(answer.ok, running.CONTROLLER_STATE, controller="one")
    assert switch(arm, stop=["one"])
    arm.world.run(0.5)
    assert states(arm) == {"one": "stopped"}
    # What held a position goes on to hold it.
    assert arm.position("beam_joint") == pytest.approx(0.4, abs=1e-3)
    assert arm.call("/controller_manager/unload_controller", name="one").ok
    assert states(arm) == {}
    assert "/one/command" not in [topic.name for topic in arm.world.graph.topics()]


def test_a_joint_has_one_controller_at_a_time(arm):
    assert load(arm, "one")
    assert load(arm, "two")
    assert load(arm, "states")
    assert switch(arm, start=["one", "states"])
    assert not switch(arm, start=["two"])
    assert states(arm) == {"one": "running", "two": "initialized", "states": "running"}
    assert coded(arm.warnings, running.CONTROLLER_CONFLICT, controller="two")
    assert switch(arm, start=["two"], stop=["one"])
    assert states(arm) == {"one": "stopped", "two": "running", "states": "running"}


def test_strict_is_all_or_nothing_and_best_effort_what_it_can(arm):
    assert load(arm, "one")
    assert not switch(arm, start=["one", "missing"])
    assert states(arm) == {"one": "initialized"}
    assert switch(arm, start=["one", "missing"], strictness=BEST_EFFORT)
    assert states(arm) == {"one": "running"}


def test_what_cannot_be_loaded_is_reported(arm):
    assert not load(arm, "nowhere")
    assert coded(arm.warnings, running.CONTROLLER_TYPE_MISSING, parameter="/nowhere/type")
    arm.world.graph.parameters.set("/odd", {"type": "odd_controllers/Odd"})
    assert not load(arm, "odd")
    arm.world.graph.parameters.set("/bad", {"type": ONE["type"], "joint": "elbow"})
    assert not load(arm, "bad")
    assert coded(arm.warnings, devices.CONTROLLER_JOINT_UNKNOWN, name="elbow")
    assert load(arm, "one")
    assert not load(arm, "one")


def test_types_are_listed_with_their_base(arm):
    answer = arm.call(
        "/controller_manager/list_controller_types", structure_needs_at_least_one_member=0
    )
    assert "diff_drive_controller/DiffDriveController" in answer.types
    assert set(answer.base_classes) == {"controller_interface::ControllerBase"}
    assert len(answer.types) == len(answer.base_classes)


def test_claims_are_listed(arm):
    assert load(arm, "one")
    answer = arm.call("/controller_manager/list_controllers", structure_needs_at_least_one_member=0)
    (claim,) = answer.controller[0].claimed_resources
    assert claim.hardware_interface == "hardware_interface::PositionJointInterface"
    assert claim.resources == ["beam_joint"]


def test_reloading_the_libraries_unloads_everything(arm):
    assert load(arm, "one")
    assert switch(arm, start=["one"])
    name = "/controller_manager/reload_controller_libraries"
    answer = arm.call(name, force_kill=False)
    assert arm.refuses(answer.ok, running.CONTROLLER_STATE, controller="one")
    assert arm.call(name, force_kill=True).ok
    assert states(arm) == {}


def test_a_plugin_that_a_maker_derived_runs_controllers_and_is_reported(bench):
    derived = ROS1.replace("libgazebo", "libmaker_gazebo")
    made = bench(robot(beam("beam", "world") + transmission("beam_joint", "Position"), derived))
    made.world.graph.parameters.set("/one", ONE)
    made.world.graph.post = lambda function: function()
    assert load(made, "one")
    assert coded(made.world, devices.HARDWARE_NOT_SIMULATED)


@pytest.mark.parametrize(
    ("name", "code"),
    [
        ("gazebo_ros_control/RobotHWSim", devices.HARDWARE_UNKNOWN),
        ("own_robot/RobotHWSim", devices.HARDWARE_NOT_SIMULATED),
        ("gazebo_ros_control/DefaultRobotHWSim", None),
    ],
)
def test_hardware_that_its_package_does_not_contain_is_an_error(bench, name, code):
    control = ROS1.replace("</plugin>", f"<robotSimType>{name}</robotSimType></plugin>")
    assert control != ROS1
    made = bench(robot(beam("beam", "world") + transmission("beam_joint", "Position"), control))
    found = [
        each
        for each in made.world.diagnostics
        if each.code in (devices.HARDWARE_UNKNOWN, devices.HARDWARE_NOT_SIMULATED)
    ]
    assert [each.code for each in found] == ([] if code is None else [code])
    assert all(each.values["hardware"] == name for each in found)


@pytest.mark.parametrize(
    ("name", "code"),
    [
        ("gz_ros2_control/GazeboSystem", devices.HARDWARE_UNKNOWN),
        ("own_robot/Hardware", devices.HARDWARE_NOT_SIMULATED),
        ("ign_ros2_control/IgnitionSystem", None),
    ],
)
def test_hardware_of_ros2_that_its_package_does_not_contain_is_an_error(bench, name, code):
    system = ros2_system(ros2_joint("beam_joint", "position"))
    system = system.replace("gz_ros2_control/GazeboSimSystem", name)
    made = bench(robot(beam("beam", "world") + system, ros2_plugin()))
    found = [
        each
        for each in made.world.diagnostics
        if each.code in (devices.HARDWARE_UNKNOWN, devices.HARDWARE_NOT_SIMULATED)
    ]
    assert [each.code for each in found] == ([] if code is None else [code])
