"""ROS 2's controller manager: its services, as ``ros2 control`` and the spawner call them."""

import pytest
import yaml
from tests.coded import coded
from tests.dialects.ros_control.arms import beam, robot, ros2_joint, ros2_parameters, ros2_plugin
from tests.dialects.ros_control.arms import ros2_system as system

from cartwheel.codes import devices, running
from cartwheel.messages import from_dict

MANAGER = "/controller_manager"
BEST_EFFORT, STRICT = 1, 2
STRING, STRINGS = 4, 9
GROUP = {
    "type": "position_controllers/JointGroupPositionController",
    "joints": ["beam_joint"],
}
STATES = {"type": "joint_state_broadcaster/JointStateBroadcaster"}


@pytest.fixture
def arm(bench, tmp_path):
    """One controller that its file names, and hardware of one joint."""
    file = tmp_path / "own.yaml"
    file.write_text(yaml.safe_dump(ros2_parameters(states=STATES, group=GROUP)))
    body = beam("beam", "world") + system(ros2_joint("beam_joint"))
    made = bench(robot(body, ros2_plugin(file)))
    made.world.run(0.1)
    made.other = tmp_path / "other.yaml"
    made.other.write_text(
        yaml.safe_dump({"other": {"ros__parameters": {"joints": ["beam_joint"]}}})
    )
    return made


def ask(made, service, kind, **fields):
    request = from_dict(f"controller_manager_msgs_ros2/srv/{kind}_Request", fields)
    return made.world.graph.service(f"{MANAGER}/{service}").handler(request)


def named(made, service, name):
    kind = "".join(word.capitalize() for word in service.split("_"))
    return ask(made, service, kind, name=name).ok


def switch(made, start=(), stop=(), strictness=STRICT):
    answer = ask(
        made,
        "switch_controller",
        "SwitchController",
        activate_controllers=list(start),
        deactivate_controllers=list(stop),
        strictness=strictness,
    )
    made.world.run(0.05)
    return answer


def listed(made):
    return {each.name: each for each in ask(made, "list_controllers", "ListControllers").controller}


def states(made):
    return {name: each.state for name, each in listed(made).items()}


def give(made, name, kind, value):
    field = {STRING: "string_value", STRINGS: "string_array_value"}[kind]
    request = from_dict(
        "rcl_interfaces/srv/SetParameters_Request",
        {"parameters": [{"name": name, "value": {"type": kind, field: value}}]},
    )
    answer = made.world.graph.service(f"{MANAGER}/set_parameters").handler(request)
    assert [each.successful for each in answer.results] == [True]


def test_what_the_files_name_is_listed_with_its_interfaces(arm):
    found = listed(arm)
    assert states(arm) == {"states": "active", "group": "active"}
    group, reported = found["group"], found["states"]
    assert group.type == GROUP["type"]
    assert group.update_rate == 100
    assert group.claimed_interfaces == group.required_command_interfaces == ["beam_joint/position"]
    assert group.required_state_interfaces == ["beam_joint/position", "beam_joint/velocity"]
    assert reported.claimed_interfaces == []
    assert reported.required_state_interfaces == ["beam_joint/position", "beam_joint/velocity"]


@pytest.mark.parametrize(
    ("rate", "listed_rate", "published"),
    # The manager updates 100 times a second, so that every third update is 33 1/3 Hz.
    [(20, 20, 10), (100, 100, 50), (1000, 100, 50), (40, 33, 17), (0, 100, 50)],
)
def test_a_controller_with_a_rate_of_its_own(bench, rate, listed_rate, published):
    body = beam("beam", "world") + system(ros2_joint("beam_joint"))
    parameters = ros2_parameters(states=STATES | {"update_rate": rate}, group=GROUP)
    made = bench(robot(body, ros2_plugin()), parameters)
    messages = made.box("/joint_states")
    made.world.run(0.5)
    assert not coded(made.warnings, devices.CONTROLLER_PARAMETER_UNKNOWN)
    assert {name: each.update_rate for name, each in listed(made).items()} == {
        "states": listed_rate,
        "group": 100,
    }
    assert len(messages.drain()) == pytest.approx(published, abs=1)


def test_a_spawner_finds_what_runs_and_configures_and_activates_it(arm):
    """Its calls for a controller that is loaded already: no load, then these two."""
    again = named(arm, "load_controller", "group")
    assert arm.refuses(again, running.CONTROLLER_STATE, controller="group")
    assert named(arm, "configure_controller", "group")
    arm.world.run(0.05)
    assert states(arm)["group"] == "inactive"
    assert listed(arm)["group"].claimed_interfaces == []
    assert switch(arm, ["group"]).ok
    assert states(arm)["group"] == "active"
    # From then on it is as any other: what is active cannot be configured.
    active = named(arm, "configure_controller", "group")
    assert arm.refuses(active, running.CONTROLLER_STATE, controller="group")
    arm.publish("/group/commands", "std_msgs/msg/Float64MultiArray", data=[0.3])
    arm.world.run(0.5)
    assert arm.position("beam_joint") == pytest.approx(0.3, abs=1e-3)


def test_a_spawner_with_a_file_of_its_own(arm, tmp_path):
    """It sets ``params_file`` and ``type``, loads, configures and activates."""
    file = tmp_path / "more.yaml"
    file.write_text(yaml.safe_dump({"more": {"ros__parameters": {"joints": ["beam_joint"]}}}))
    untyped = named(arm, "load_controller", "more")
    assert arm.refuses(untyped, running.CONTROLLER_TYPE_MISSING, parameter="more.type")
    give(arm, "more.params_file", STRINGS, [str(file)])
    give(arm, "more.type", STRING, GROUP["type"])
    assert named(arm, "load_controller", "more")
    assert states(arm)["more"] == "unconfigured"
    early = switch(arm, ["more"])
    assert arm.refuses(early.ok, running.CONTROLLER_STATE, controller="more")
    assert named(arm, "configure_controller", "more")
    refused = switch(arm, ["more"])
    assert arm.refuses(refused.ok, running.CONTROLLER_CONFLICT, controller="more", by="group")
    assert switch(arm, ["more"], ["group"]).ok
    assert states(arm) == {"states": "active", "group": "inactive", "more": "active"}
    arm.publish("/more/commands", "std_msgs/msg/Float64MultiArray", data=[-0.2])
    arm.world.run(0.5)
    assert arm.position("beam_joint") == pytest.approx(-0.2, abs=1e-3)


def test_a_spawner_may_give_topics_other_names(arm):
    """``--controller-ros-args "-r ~/commands:=/go"`` sets them before it loads."""
    assert switch(arm, (), ["group"]).ok
    give(arm, "other.type", STRING, GROUP["type"])
    give(arm, "other.node_options_args", STRINGS, ["--ros-args", "-r", "~/commands:=/go"])
    give(arm, "other.params_file", STRING, str(arm.other))
    assert named(arm, "load_controller", "other")
    assert named(arm, "configure_controller", "other")
    topics = [topic.name for topic in arm.world.graph.topics()]
    assert "/go" in topics
    assert "/other/commands" not in topics


def test_it_is_stopped_cleaned_up_and_unloaded(arm):
    active = named(arm, "unload_controller", "group")
    assert arm.refuses(active, running.CONTROLLER_STATE, controller="group")
    assert switch(arm, (), ["group"]).ok
    again = switch(arm, (), ["group"])
    assert arm.refuses(again.ok, running.CONTROLLER_STATE, controller="group")
    assert switch(arm, (), ["group"], BEST_EFFORT).ok
    assert named(arm, "cleanup_controller", "group")
    assert states(arm)["group"] == "unconfigured"
    assert named(arm, "configure_controller", "group")
    assert states(arm)["group"] == "inactive"
    assert named(arm, "unload_controller", "group")
    assert set(states(arm)) == {"states"}
    again = named(arm, "unload_controller", "group")
    assert arm.refuses(again, running.CONTROLLER_STATE, controller="group")
    assert "/group/commands" not in [topic.name for topic in arm.world.graph.topics()]
    # Its files still know it.
    assert named(arm, "load_controller", "group")


def test_faults_are_reported(arm, tmp_path):
    give(arm, "odd.type", STRING, "odd_controllers/Odd")
    odd = named(arm, "load_controller", "odd")
    assert arm.refuses(odd, devices.CONTROLLER_TYPE_UNKNOWN, name="odd_controllers/Odd")
    give(arm, "lost.type", STRING, GROUP["type"])
    assert named(arm, "load_controller", "lost")
    lost = named(arm, "configure_controller", "lost")
    missing = {"controller": "lost", "parameter": "joints"}
    assert arm.refuses(lost, devices.CONTROLLER_PARAMETER_MISSING, **missing)
    assert states(arm)["lost"] == "unconfigured"
    nobody = named(arm, "configure_controller", "nobody")
    assert arm.refuses(nobody, running.CONTROLLER_STATE, controller="nobody")
    give(arm, "gone.params_file", STRING, str(tmp_path / "gone.yaml"))
    gone = named(arm, "load_controller", "gone")
    assert arm.refuses(gone, devices.CONTROLLERS_FILE_UNREADABLE)


def test_types_are_listed(arm):
    answer = ask(arm, "list_controller_types", "ListControllerTypes")
    assert "joint_trajectory_controller/JointTrajectoryController" in answer.types
    assert len(answer.types) == len(answer.base_classes)


def test_reloading_the_libraries_unloads_everything(arm):
    request = {"force_kill": False}
    refused = ask(arm, "reload_controller_libraries", "ReloadControllerLibraries", **request)
    assert arm.refuses(refused.ok, running.CONTROLLER_STATE)
    request["force_kill"] = True
    assert ask(arm, "reload_controller_libraries", "ReloadControllerLibraries", **request).ok
    assert states(arm) == {}


def test_hardware_is_listed_and_taken_away(arm):
    def component():
        (found,) = ask(arm, "list_hardware_components", "ListHardwareComponents").component
        return found

    def become(**target):
        return ask(
            arm,
            "set_hardware_component_state",
            "SetHardwareComponentState",
            name="bench",
            target_state=target,
        )

    found = component()
    assert (found.name, found.type, found.rw_rate) == ("bench", "system", 100)
    assert found.plugin_name == "gz_ros2_control/GazeboSimSystem"
    assert (found.state.id, found.state.label) == (3, "active")
    interfaces = ask(arm, "list_hardware_interfaces", "ListHardwareInterfaces")
    (command,) = interfaces.command_interfaces
    assert (command.name, command.is_available, command.is_claimed) == (
        "beam_joint/position",
        True,
        True,
    )
    assert [each.name for each in interfaces.state_interfaces] == [
        "beam_joint/position",
        "beam_joint/velocity",
    ]
    answer = become(label="inactive")
    assert (answer.ok, answer.state.id) == (True, 2)
    arm.world.run(0.05)
    assert states(arm) == {"states": "active", "group": "inactive"}
    assert not component().command_interfaces[0].is_available
    refused = switch(arm, ["group"])
    assert arm.refuses(refused.ok, running.HARDWARE_COMPONENT, controller="group")
    assert become(id=3).ok
    assert switch(arm, ["group"]).ok
    asleep = become(label="asleep")
    assert arm.refuses(asleep.ok, running.HARDWARE_COMPONENT, name="asleep")
    nobody = ask(
        arm,
        "set_hardware_component_state",
        "SetHardwareComponentState",
        name="nobody",
        target_state={"id": 3},
    )
    assert (nobody.ok, nobody.state.label) == (False, "unknown")


def parameters(made, node, kind, **fields):
    name = {
        "GetParameters": "get_parameters",
        "SetParametersAtomically": "set_parameters_atomically",
        "ListParameters": "list_parameters",
        "DescribeParameters": "describe_parameters",
    }[kind]
    request = from_dict(f"rcl_interfaces/srv/{kind}_Request", fields)
    return made.world.graph.service(f"{node}/{name}").handler(request)


def test_nodes_have_what_files_state_as_parameters(arm):
    names = ["update_rate", "group.type", "none"]
    rate, kind, nothing = parameters(arm, MANAGER, "GetParameters", names=names).values
    assert (rate.integer_value, kind.string_value, nothing.type) == (100, GROUP["type"], 0)
    assert arm.world.graph.nodes["arm/group"] == "/group"
    reported = parameters(arm, "/group", "ListParameters").result.names
    assert reported == ["joints", "type", "use_sim_time"]
    (joints,) = parameters(arm, "/group", "GetParameters", names=["joints"]).values
    assert joints.string_array_value == GROUP["joints"]
    (described,) = parameters(arm, "/group", "DescribeParameters", names=["joints"]).descriptors
    assert (described.type, described.read_only) == (STRINGS, True)
    wanted = [{"name": name, "value": {"type": STRING, "string_value": "x"}} for name in "ab"]
    refused = parameters(arm, "/group", "SetParametersAtomically", parameters=wanted).result
    assert not refused.successful and refused.reason
    assert parameters(arm, MANAGER, "SetParametersAtomically", parameters=wanted).result.successful
    assert parameters(arm, MANAGER, "GetParameters", names=["b"]).values[0].string_value == "x"
    assert switch(arm, stop=["group"]).ok
    assert named(arm, "unload_controller", "group")
    assert "arm/group" not in arm.world.graph.nodes
    assert not [one for one in arm.world.graph.services() if one.name.startswith("/group/")]
