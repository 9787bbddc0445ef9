"""Services and parameters over DDS, called as rmw_fastrtps calls them."""

from __future__ import annotations

import itertools
from collections.abc import Iterator
from typing import Any

import pytest
from tests.bridges.ros1_peers import wait_for
from tests.bridges.ros2_peers import DOMAIN, REASON, Peer, Ros2Bridged
from tests.coded import coded, raises

from cartwheel.assembly.ros2 import node_parameters
from cartwheel.codes.graph import ENTITY_NAME_TAKEN
from cartwheel.codes.wires import MALFORMED_MESSAGE
from cartwheel.codes.world import UNKNOWN_MODEL
from cartwheel.errors import one_line
from cartwheel.gazebo.ros2_api import Ros2Api
from cartwheel.geometry import Pose
from cartwheel.messages.ros2.types import ros2_type
from cartwheel.session import Session
from cartwheel.simulation import RunState

pytestmark = pytest.mark.skipif(bool(REASON), reason=REASON)

BOX = """<?xml version="1.0"?>
<robot name="box">
  <link name="body">
    <inertial><mass value="2"/>
      <inertia ixx="0.1" iyy="0.1" izz="0.1" ixy="0" ixz="0" iyz="0"/></inertial>
    <collision><geometry><box size="0.2 0.2 0.2"/></geometry></collision>
  </link>
</robot>"""
TWIST = "geometry_msgs/msg/Twist"


def prepared(session: Session) -> Ros2Api:
    api = Ros2Api(session)
    api.start()
    return api


@pytest.fixture(scope="module")
def bridged() -> Iterator[Ros2Bridged]:
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("ROS_DOMAIN_ID", str(DOMAIN + 1))
        made = Ros2Bridged(prepare=prepared, parameters=node_parameters)
        yield made
        made.close()


@pytest.fixture(scope="module")
def peer(bridged: Ros2Bridged) -> Iterator[Peer]:
    made = Peer(DOMAIN + 1)
    yield made
    made.close()


def position(bridged: Ros2Bridged, name: str) -> tuple[float, float, float]:
    return bridged.simulation.call(lambda: bridged.simulation.pose(name)).result().position


def unknown(bridged: Ros2Bridged, name: str) -> str:
    """What is answered for a model that does not exist."""
    simulation = bridged.simulation
    with raises(UNKNOWN_MODEL, name=name) as caught:
        simulation.call(lambda: simulation.delete(name)).result()
    return one_line(caught.value)


def parameter(name: str, kind: int, **value: Any) -> dict[str, Any]:
    return {"name": name, "value": {"type": kind, **value}}


def test_models_are_spawned_listed_and_deleted(bridged: Ros2Bridged, peer: Peer) -> None:
    answer = peer.call(
        "/spawn_entity",
        "gazebo_msgs/srv/SpawnEntity",
        {"name": "crate", "xml": BOX, "initial_pose": {"position": {"x": 3.0, "z": 0.1}}},
    )
    assert answer.success, answer.status_message
    assert position(bridged, "crate")[0] == pytest.approx(3.0, abs=1e-6)
    again = peer.call("/spawn_entity", "gazebo_msgs/srv/SpawnEntity", {"name": "crate", "xml": BOX})
    assert not again.success
    with raises(ENTITY_NAME_TAKEN, name="crate", free="crate_1") as taken:
        bridged.prepared._spawning.spawn_text(
            BOX, name="crate", where=Pose(), reference_frame="", namespace=""
        )
    assert again.status_message == one_line(taken.value)
    listed = peer.call("/get_model_list", "gazebo_msgs/srv/GetModelList", {})
    assert {"rosbots", "crate"} <= set(listed.model_names)
    assert peer.call("/delete_entity", "gazebo_msgs/srv/DeleteEntity", {"name": "crate"}).success
    assert "crate" not in bridged.simulation.models
    gone = peer.call("/delete_entity", "gazebo_msgs/srv/DeleteEntity", {"name": "crate"})
    assert not gone.success
    assert gone.status_message == unknown(bridged, "crate")


def test_a_description_larger_than_a_datagram_arrives(bridged: Ros2Bridged, peer: Peer) -> None:
    text = BOX.replace("<link", f"<!-- {'x' * 300_000} --><link", 1)
    answer = peer.call(
        "/spawn_entity", "gazebo_msgs/srv/SpawnEntity", {"name": "wordy", "xml": text}
    )
    assert answer.success, answer.status_message
    peer.call("/delete_entity", "gazebo_msgs/srv/DeleteEntity", {"name": "wordy"})


def test_states_are_set_and_got(bridged: Ros2Bridged, peer: Peer) -> None:
    state = {"name": "rosbots", "pose": {"position": {"x": -2.0, "y": 1.5}}}
    for prefix in ("", "/gazebo"):
        assert peer.call(
            f"{prefix}/set_entity_state", "gazebo_msgs/srv/SetEntityState", {"state": state}
        ).success
        reported = peer.call(
            f"{prefix}/get_entity_state", "gazebo_msgs/srv/GetEntityState", {"name": "rosbots"}
        )
        assert reported.success
        assert reported.state.pose.position.x == pytest.approx(-2.0, abs=1e-3)
        assert reported.state.pose.position.y == pytest.approx(1.5, abs=1e-3)
    link = peer.call(
        "/get_entity_state",
        "gazebo_msgs/srv/GetEntityState",
        {"name": "rosbots::camera_link", "reference_frame": "rosbots"},
    )
    assert link.success
    assert link.state.pose.position.z > 0.2
    none = peer.call("/get_entity_state", "gazebo_msgs/srv/GetEntityState", {"name": "nobody"})
    assert not none.success


def test_properties_are_returned_and_set(bridged: Ros2Bridged, peer: Peer) -> None:
    reported = peer.call(
        "/get_model_properties", "gazebo_msgs/srv/GetModelProperties", {"model_name": "rosbots"}
    )
    assert reported.success, reported.status_message
    assert "rosbots::camera_link" in reported.body_names
    (cart,) = [placed for placed in bridged.simulation.scene.models if placed.name == "rosbots"]
    joint = next(one.name for one in cart.description.joints if one.type == "continuous")
    assert joint in reported.joint_names
    done = peer.call(
        "/set_joint_properties",
        "gazebo_msgs_ros2/srv/SetJointProperties",
        {"joint_name": joint, "ode_joint_config": {"damping": [0.25]}},
    )
    assert done.success, done.status_message
    found = peer.call(
        "/get_joint_properties", "gazebo_msgs/srv/GetJointProperties", {"joint_name": joint}
    )
    assert found.success, found.status_message
    assert found.damping.tolist() == [0.25]


def test_time_is_held_and_reset(bridged: Ros2Bridged, peer: Peer) -> None:
    simulation = bridged.simulation
    peer.call("/pause_physics", "std_srvs/srv/Empty", {})
    assert simulation.run_state is RunState.PAUSED
    peer.call("/unpause_physics", "std_srvs/srv/Empty", {})
    assert simulation.run_state is RunState.RUNNING
    wait_for(lambda: simulation.time_ns > 10**9, "a second")
    start = simulation.time_ns
    peer.call("/reset_world", "std_srvs/srv/Empty", {})
    assert simulation.time_ns >= start
    peer.call("/reset_simulation", "std_srvs/srv/Empty", {})
    assert simulation.time_ns < start


def test_steps_are_made_by_simulation_interfaces(bridged: Ros2Bridged, peer: Peer) -> None:
    package, simulation = "simulation_interfaces/srv", bridged.simulation
    early = peer.call("/gz_server/step_simulation", f"{package}/StepSimulation", {"steps": 10})
    assert early.result.result == 3  # RESULT_INCORRECT_STATE
    paused = peer.call(
        "/gz_server/set_simulation_state", f"{package}/SetSimulationState", {"state": {"state": 2}}
    )
    assert paused.result.result == 1  # RESULT_OK
    state = peer.call("/gz_server/get_simulation_state", f"{package}/GetSimulationState", {})
    assert state.state.state == 2
    before = simulation.current_step
    done = peer.call("/gz_server/step_simulation", f"{package}/StepSimulation", {"steps": 250})
    assert done.result.result == 1
    assert simulation.current_step == before + 250
    again = peer.call(
        "/gz_server/set_simulation_state", f"{package}/SetSimulationState", {"state": {"state": 1}}
    )
    assert again.result.result == 1
    assert simulation.run_state is RunState.RUNNING


def test_steps_are_made_by_an_action(bridged: Ros2Bridged, peer: Peer) -> None:
    kind, simulation = "simulation_interfaces/action/SimulateSteps", bridged.simulation
    base = "/gz_server/simulate_steps/_action"
    numbers = itertools.count(1)

    def send(steps: int) -> dict[str, Any]:
        identity = {"uuid": [next(numbers), *range(15)]}
        request = {"goal_id": identity, "goal": {"steps": steps}}
        assert peer.call(f"{base}/send_goal", f"{kind}_SendGoal", request).accepted
        return identity

    def ended(identity: dict[str, Any]) -> tuple[int, int]:
        reported = peer.call(f"{base}/get_result", f"{kind}_GetResult", {"goal_id": identity})
        return reported.status, reported.result.result.result

    aborted, succeeded, cancelled = 6, 4, 5
    assert ended(send(10)) == (aborted, 4)  # RESULT_OPERATION_FAILED: it is not paused
    simulation.call(simulation.pause).result()
    try:
        (action,) = (each for each in bridged.graph.actions() if "simulate_steps" in each.name)
        peer.subscribe(f"{base}/feedback", f"{kind}_FeedbackMessage")
        wait_for(lambda: action.wants_feedback, "the reader of the feedback")
        before = simulation.current_step
        identity = send(45)
        assert ended(identity) == (succeeded, 1)
        assert simulation.current_step == before + 45
        reported = wait_for(
            lambda: (
                found
                if len(found := peer.messages(f"{base}/feedback", f"{kind}_FeedbackMessage")) == 45
                else None
            ),
            "all feedback",
        )
        assert [
            (one.feedback.completed_steps, one.feedback.remaining_steps) for one in reported
        ] == [(made, 45 - made) for made in range(1, 46)]
        endless = send(10**12)
        assert ended(send(1)) == (aborted, 4)
        peer.call(
            f"{base}/cancel_goal", "action_msgs/srv/CancelGoal", {"goal_info": {"goal_id": endless}}
        )
        assert ended(endless)[0] == cancelled
        wait_for(lambda: not simulation.steps_allowed, "the end of the steps")
        rest = simulation.current_step
        taken_over = send(10**12)
        wait_for(lambda: simulation.current_step > rest, "steps")
        peer.call("/reset_simulation", "std_srvs/srv/Empty", {})
        assert ended(taken_over) == (aborted, 4)
    finally:
        simulation.call(simulation.resume).result()


def test_entities_come_and_go_by_simulation_interfaces(bridged: Ros2Bridged, peer: Peer) -> None:
    package = "simulation_interfaces/srv"
    request = {
        "name": "crate",
        "entity_resource": {"resource_string": BOX},
        "initial_pose": {"pose": {"position": {"x": 4.0, "z": 0.1}}},
    }
    made = peer.call("/gz_server/spawn_entity", f"{package}/SpawnEntity", request)
    assert (made.result.result, made.entity_name) == (1, "crate"), made.result.error_message
    twice = peer.call("/gz_server/spawn_entity", f"{package}/SpawnEntity", request)
    assert twice.result.result == 101  # NAME_NOT_UNIQUE
    renamed = peer.call(
        "/gz_server/spawn_entity", f"{package}/SpawnEntity", {**request, "allow_renaming": True}
    )
    assert (renamed.result.result, renamed.entity_name) == (1, "crate_1")
    listed = peer.call(
        "/gz_server/get_entities", f"{package}/GetEntities", {"filters": {"filter": "crate.*"}}
    )
    assert sorted(listed.entities) == ["crate", "crate_1"]
    moved = peer.call(
        "/gz_server/set_entity_state",
        f"{package}/SetEntityState",
        {
            "entity": "crate",
            "state": {"pose": {"position": {"x": 7.0, "z": 0.1}}},
            "set_pose": True,
            "set_twist": True,
        },
    )
    assert moved.result.result == 1, moved.result.error_message
    reported = peer.call(
        "/gz_server/get_entity_state", f"{package}/GetEntityState", {"entity": "crate"}
    )
    assert reported.state.pose.position.x == pytest.approx(7.0, abs=1e-2)
    nobody = peer.call("/gz_server/delete_entity", f"{package}/DeleteEntity", {"entity": "nobody"})
    assert nobody.result.result == 2  # RESULT_NOT_FOUND
    assert nobody.result.error_message == unknown(bridged, "nobody")
    spawned = peer.call("/gz_server/reset_simulation", f"{package}/ResetSimulation", {"scope": 4})
    assert spawned.result.result == 1
    assert bridged.simulation.models == tuple(
        name for name in bridged.simulation.models if not name.startswith("crate")
    )
    features = peer.call(
        "/gz_server/get_simulator_features", f"{package}/GetSimulatorFeatures", {}
    ).features
    assert {0, 1, 10, 11, 20, 31, 32} <= set(features.features.tolist())


def test_who_has_the_first_simulation_interfaces_is_answered_in_them(
    bridged: Ros2Bridged, peer: Peer
) -> None:
    """Jazzy and Kilted have other requests and responses under the same names."""
    older = "simulation_interfaces_v1/srv"
    request = {"entity": "rosbots", "state": {"pose": {"position": {"x": 3.0, "z": 0.1}}}}
    values = (f"{older}/SetEntityState", request)
    assert peer.call("/gz_server/set_entity_state", *values, hashes=True).result.result == 1
    state = peer.call(
        "/gz_server/get_entity_state",
        "simulation_interfaces/srv/GetEntityState",
        {"entity": "rosbots"},
        hashes=True,
    ).state
    assert state.pose.position.x == pytest.approx(3.0, abs=0.1)
    # Requests for it are the same in both versions.
    for name, field in (
        (f"{older}/GetSpawnables", "uri"),
        ("simulation_interfaces/srv/GetSpawnables", ""),
    ):
        reported = peer.call("/gz_server/get_spawnables", name, {}, hashes=True).spawnables
        uris = [getattr(each, field) if field else each.entity_resource.uri for each in reported]
        assert any(uri.endswith("/rosbots.xacro") for uri in uris)


def test_parameters_are_listed_described_got_and_set(bridged: Ros2Bridged, peer: Peer) -> None:
    package = "rcl_interfaces/srv"
    events = "rcl_interfaces/msg/ParameterEvent"
    peer.subscribe("/parameter_events", events)
    names = peer.call("/gazebo/list_parameters", f"{package}/ListParameters", {}).result.names
    assert names == [
        "max_step_size",
        "paused",
        "publish_rate",
        "real_time_factor",
        "use_sim_time",
    ]
    kinds = peer.call(
        "/gazebo/get_parameter_types", f"{package}/GetParameterTypes", {"names": [*names, "none"]}
    )
    assert kinds.types.tolist() == [3, 1, 3, 3, 1, 0]
    step, time = peer.call(
        "/gazebo/get_parameters",
        f"{package}/GetParameters",
        {"names": ["max_step_size", "use_sim_time"]},
    ).values
    assert (step.type, step.double_value) == (3, bridged.simulation.step_ns / 1e9)
    assert (time.type, time.bool_value) == (1, True)
    (described,) = peer.call(
        "/gazebo/describe_parameters", f"{package}/DescribeParameters", {"names": ["max_step_size"]}
    ).descriptors
    assert (described.type, described.read_only) == (3, True)
    results = peer.call(
        "/gazebo/set_parameters",
        f"{package}/SetParameters",
        {
            "parameters": [
                parameter("real_time_factor", 2, integer_value=2),
                parameter("real_time_factor", 3, double_value=-1.0),
                parameter("max_step_size", 3, double_value=1.0),
                parameter("paused", 3, double_value=1.0),
                parameter("nonsense", 1),
                parameter("real_time_factor", 3, double_value=1e308),
            ]
        },
    ).results
    assert [each.successful for each in results] == [True, False, False, False, False, False]
    assert results[5].reason
    assert results[2].reason
    wait_for(lambda: bridged.simulation.speed == 2.0, "the speed that was set")

    def reported() -> list[Any]:
        """Earlier changes of the time by other tests may still be published."""
        return [
            event
            for event in peer.messages("/parameter_events", events)
            if [each.name for each in event.changed_parameters] == ["real_time_factor"]
        ]

    (event,) = wait_for(reported, "the change reported")
    assert event.node == "/gazebo"
    whole = peer.call(
        "/gazebo/set_parameters_atomically",
        f"{package}/SetParametersAtomically",
        {
            "parameters": [
                parameter("real_time_factor", 3, double_value=1.0),
                parameter("max_step_size", 3, double_value=1.0),
            ]
        },
    ).result
    assert not whole.successful
    assert bridged.simulation.speed == 2.0


def test_parameters_that_something_else_changes_are_published_too(
    bridged: Ros2Bridged,
) -> None:
    events = "rcl_interfaces/msg/ParameterEvent"
    peer = Peer(DOMAIN + 1)
    peer.subscribe("/parameter_events", events)
    simulation = bridged.simulation

    def reported() -> list[bool]:
        """How often time is said to be held, with repetitions."""
        return [
            each.value.bool_value
            for event in peer.messages("/parameter_events", events)
            for each in event.changed_parameters
            if each.name == "paused"
        ]

    def hold(held: bool) -> None:
        change = simulation.pause if held else simulation.resume
        simulation.call(change).result()

    try:
        # The first ones may go before the two know each other.
        def seen() -> bool:
            hold(held=simulation.run_state is RunState.RUNNING)
            return len(reported()) > 2

        wait_for(seen, "a change that nobody set as a parameter")
        assert all(a != b for a, b in itertools.pairwise(reported()))
    finally:
        hold(held=False)
        peer.close()


def test_types_are_described_as_by_any_node(bridged: Ros2Bridged, peer: Peer) -> None:
    name, kind = (
        "/gazebo/get_type_description",
        "type_description_interfaces/srv/GetTypeDescription",
    )
    odometry = ros2_type("nav_msgs/msg/Odometry")
    asked = {"type_name": odometry.name, "type_hash": odometry.hash, "include_type_sources": True}
    answer = peer.call(name, kind, asked)
    assert (answer.successful, answer.failure_reason) == (True, "")
    own = answer.type_description.type_description
    assert own.type_name == odometry.name
    assert [each.name for each in own.fields] == ["header", "child_frame_id", "pose", "twist"]
    within = {each.type_name for each in answer.type_description.referenced_type_descriptions}
    assert within >= {"std_msgs/msg/Header", "geometry_msgs/msg/PoseWithCovariance"}
    assert {each.type_name for each in answer.type_sources} == within | {odometry.name}
    for wrong in ({"type_hash": "RIHS01_0"}, {"type_name": "nav_msgs/msg/Odo"}):
        refused = peer.call(name, kind, {**asked, **wrong})
        assert not refused.successful
        assert refused.failure_reason


def test_a_request_that_is_none_harms_nobody(bridged: Ros2Bridged, peer: Peer) -> None:
    peer.tell("pub", "rq/spawn_entityRequest", "gazebo_msgs::srv::dds_::SpawnEntity_Request_", "00")
    peer.tell(
        "pub", "rq/get_model_listRequest", "gazebo_msgs::srv::dds_::GetModelList_Request_",
        "00010000ffffffffffffffff",
    )  # fmt: skip
    wait_for(lambda: coded(bridged.reports, MALFORMED_MESSAGE), "the warning")
    assert peer.call("/get_model_list", "gazebo_msgs/srv/GetModelList", {}).success
