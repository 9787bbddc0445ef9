"""Services and actions that a program uses."""

import pickle
import threading
from pathlib import Path
from typing import Any

import pytest
import yaml
from tests.coded import raises
from tests.dialects.ros_control.arms import (
    ROS1,
    beam,
    robot,
    ros2_joint,
    ros2_parameters,
    ros2_plugin,
    ros2_system,
    transmission,
)
from tests.dialects.ros_control.controllers.test_gripper import BODY

import cartwheel as cw
from cartwheel.codes.graph import (
    ACTION_UNKNOWN,
    FIELD_UNKNOWN,
    FIELD_VALUE_INVALID,
    SERVICE_UNKNOWN,
    TOPIC_UNKNOWN,
)
from cartwheel.codes.world import (
    NUMBER_OUT_OF_RANGE,
    RUN_NESTED,
    SIMULATION_CLOSED,
    WAIT_TIMED_OUT,
)
from cartwheel.errors import CartwheelError, UnknownNameError
from cartwheel.msgs.control_msgs_ros2 import FollowJointTrajectory_Result
from cartwheel.msgs.trajectory_msgs import JointTrajectory, JointTrajectoryPoint

JOINTS = ("a_joint", "b_joint")
FOLLOW = "/arm/follow_joint_trajectory"
GRIP = "/gripper/gripper_cmd"


def spawn(world: cw.World, folder: Path, text: str, controllers: dict[str, Any]) -> cw.Model:
    (folder / "robot.urdf").write_text(text)
    if not controllers:
        return world.spawn(folder / "robot.urdf")
    (folder / "controllers.yaml").write_text(yaml.safe_dump(controllers))
    return world.spawn(folder / "robot.urdf", controllers=folder / "controllers.yaml")


def arm(world: cw.World, folder: Path, ros: int) -> cw.Model:
    """An arm with two joints and a trajectory controller, of ros_control or ros2_control."""
    body = beam("a", "world") + beam("b", "world", origin="0 1 1")
    if ros == 1:
        text = robot(body + "".join(transmission(name, "Position") for name in JOINTS), ROS1)
        kind = "position_controllers/JointTrajectoryController"
        return spawn(world, folder, text, {"arm": {"type": kind, "joints": list(JOINTS)}})
    file = folder / "ros2.yaml"
    values = {
        "type": "joint_trajectory_controller/JointTrajectoryController",
        "joints": list(JOINTS),
        "command_interfaces": ["position"],
        "state_interfaces": ["position", "velocity"],
    }
    file.write_text(yaml.safe_dump(ros2_parameters(arm=values)))
    system = ros2_system(*(ros2_joint(name) for name in JOINTS))
    text = robot(body + system, ros2_plugin(file))
    return spawn(world, folder, text, {})


def trajectory(*points: tuple[float, list[float]]) -> dict[str, Any]:
    return {
        "joint_names": list(JOINTS),
        "points": [
            {"positions": positions, "time_from_start": seconds} for seconds, positions in points
        ],
    }


@pytest.mark.parametrize("ros", [1, 2])
def test_an_arm_follows_a_trajectory(tmp_path: Path, ros: int) -> None:
    with cw.World("empty") as world:
        model = arm(world, tmp_path, ros)
        assert FOLLOW in world.actions
        assert FOLLOW in model.actions
        world.run(0.5)
        goal = model.send_goal(FOLLOW[1:], trajectory=trajectory((1.0, [0.5, -0.3])))
        assert goal.status == "active"
        assert not goal.done
        result = goal.result(timeout=5.0)
        assert (goal.status, goal.done) == ("succeeded", True)
        assert result.error_code == 0
        # The controller ends the goal after 1 s, when the joints have settled within its tolerance.
        assert 1.5 <= world.time < 1.6
        assert [model.joint(name) for name in JOINTS] == pytest.approx([0.5, -0.3], abs=0.02)
        assert goal.result() is result
        assert len(goal.feedbacks) > 10
        assert goal.feedback is goal.feedbacks[-1]
        assert list(goal.feedback.joint_names) == list(JOINTS)
        goal.cancel()
        assert goal.status == "succeeded"


def test_a_trajectory_of_classes_has_its_times_in_seconds(tmp_path: Path) -> None:
    with cw.World("empty") as world:
        model = arm(world, tmp_path, 2)
        world.run(0.5)
        point = JointTrajectoryPoint(positions=[0.5, -0.3], time_from_start=1.0)
        wanted = JointTrajectory(joint_names=list(JOINTS), points=[point])
        goal = world.send_goal(FOLLOW, trajectory=wanted)
        assert goal.result().error_code == 0
        assert world.time == pytest.approx(1.5, abs=0.1)
        assert model.joint(JOINTS[0]) == pytest.approx(0.5, abs=0.02)
        point = JointTrajectoryPoint(positions=[0.5, -0.3], time_from_start="soon")
        wanted = JointTrajectory(joint_names=list(JOINTS), points=[point])
        with raises(FIELD_VALUE_INVALID, field="trajectory.points[0].time_from_start"):
            world.send_goal(FOLLOW, trajectory=wanted)


@pytest.mark.parametrize("ros", [1, 2])
def test_a_goal_is_cancelled(tmp_path: Path, ros: int) -> None:
    with cw.World("empty") as world:
        arm(world, tmp_path, ros)
        world.run(0.5)
        goal = world.send_goal(FOLLOW, trajectory=trajectory((10.0, [0.5, -0.3])))
        world.run(1.0)
        assert goal.status == "active"
        goal.cancel()
        assert goal.status == "cancelled"
        assert goal.result() is not None


@pytest.mark.parametrize("ros", [1, 2])
def test_goals_in_progress_end_with_a_reset_or_their_model(tmp_path: Path, ros: int) -> None:
    with cw.World("empty") as world:
        model = arm(world, tmp_path, ros)
        early = world.send_goal(FOLLOW, trajectory=trajectory((10.0, [0.5, -0.3])))
        assert early.status == "pending"  # until the controller has started
        world.reset()
        assert (early.status, early.text) == ("rejected", "the world was reset")
        world.run(0.5)
        goal = world.send_goal(FOLLOW, trajectory=trajectory((10.0, [0.5, -0.3])))
        world.run(0.5)
        feedbacks = len(goal.feedbacks)
        world.reset()
        assert (goal.status, goal.text) == ("aborted", "the world was reset")
        result, time = goal.result(), world.time
        assert result.error_code == FollowJointTrajectory_Result.INVALID_GOAL and time == 0.0
        world.run(0.5)
        assert (goal.status, goal.result()) == ("aborted", result)
        assert feedbacks == len(goal.feedbacks) > 0
        assert model.joint(JOINTS[0]) == pytest.approx(0.0, abs=1e-3)
        goal = world.send_goal(FOLLOW, trajectory=trajectory((10.0, [0.5, -0.3])))
        model.delete()
        assert (goal.status, goal.text) == ("aborted", "the action was withdrawn")
        assert goal.result() is not None


@pytest.mark.parametrize("pickled", [False, True])
def test_goals_and_restored_states(tmp_path: Path, pickled: bool) -> None:
    with cw.World("empty") as world:
        arm(world, tmp_path, 2)
        world.run(0.5)
        goal = world.send_goal(FOLLOW, trajectory=trajectory((1.0, [0.5, -0.3])))
        world.run(0.5)
        state, feedbacks = world.save(), len(goal.feedbacks)
        if pickled:
            state = pickle.loads(pickle.dumps(state))
        assert goal.result().error_code == 0
        ended, known = world.time, len(goal.feedbacks)
        later = world.send_goal(FOLLOW, trajectory=trajectory((5.0, [0.0, 0.0])))
        world.run(0.1)
        assert later.status == "active"
        world.restore(state)
        # It is as it was, and goes on; the other one was sent afterwards.
        assert goal.status == "active"
        assert later.status == "aborted" and "restored" in later.text
        assert goal.result().error_code == 0
        assert world.time == ended
        assert len(goal.feedbacks) == known + known - feedbacks
        world.close()
        assert goal.status == "succeeded"


def test_goals_in_progress_are_those_of_a_state_of_another_world(tmp_path: Path) -> None:
    """A goal continues if it is the same; one with the same number in another world ends."""
    position = {"same": 0.5, "other": 0.1}
    goals: dict[str, cw.Goal] = {}
    with cw.World("empty") as saved, cw.World("empty") as same, cw.World("empty") as other:
        for name, world in (("", saved), ("same", same), ("other", other)):
            arm(world, tmp_path, 2)
            points = trajectory((1.0, [position.get(name, 0.5), -0.3]))
            goals[name] = world.send_goal(FOLLOW, trajectory=points)
            world.run(0.5)
        state = pickle.dumps(saved.save())
        for world in (same, other):
            world.restore(pickle.loads(state))
        assert [goals[name].status for name in ("same", "other")] == ["active", "aborted"]
        before = len(goals["same"].feedbacks)
        assert goals["same"].result().error_code == 0
        assert len(goals["same"].feedbacks) > before
        goals["same"].cancel()
        other.run(1.0)
        assert other.model("arm").joint("a_joint") == pytest.approx(0.5, abs=0.02)


def test_a_new_goal_replaces_the_old_one_and_bad_ones_are_rejected(tmp_path: Path) -> None:
    with cw.World("empty") as world:
        arm(world, tmp_path, 1)
        world.run(0.5)
        first = world.send_goal(FOLLOW, trajectory=trajectory((10.0, [0.5, -0.3])))
        second = world.send_goal(FOLLOW, {"trajectory": trajectory((0.5, [0.1, 0.1]))})
        assert (first.status, second.status) == ("cancelled", "active")
        second.result()
        assert second.status == "succeeded"
        wrong = world.send_goal(FOLLOW, trajectory={"joint_names": ["elbow"]})
        assert wrong.status == "rejected"
        assert wrong.result().error_code != 0


def test_a_goal_that_takes_too_long(tmp_path: Path) -> None:
    with cw.World("empty") as world:
        arm(world, tmp_path, 1)
        world.run(0.5)
        goal = world.send_goal(FOLLOW, trajectory=trajectory((10.0, [0.5, -0.3])))
        with raises(WAIT_TIMED_OUT, cw.TimedOutError, action=FOLLOW, status="active", timeout=0.5):
            goal.result(timeout=0.5)
        assert world.time == 1.0
        with raises(NUMBER_OUT_OF_RANGE):
            goal.result(timeout=-1)
        with raises(ACTION_UNKNOWN, UnknownNameError, meant=FOLLOW):
            world.send_goal("/arm/follow_joint_trajectry")
        with raises(FIELD_UNKNOWN):
            world.send_goal(FOLLOW, trajctory={})
    with raises(SIMULATION_CLOSED):
        world.send_goal(FOLLOW)


def test_a_gripper_closes(tmp_path: Path) -> None:
    with cw.World("empty") as world:
        text = robot(BODY.format(stop="") + transmission("finger_joint", "Position"), ROS1)
        kind = "position_controllers/GripperActionController"
        values = {"type": kind, "joint": "finger_joint", "goal_tolerance": 0.002}
        model = spawn(world, tmp_path, text, {"gripper": values})
        world.run(0.1)
        goal = world.send_goal(GRIP, command_position=0.2, command_max_effort=20.0)
        result = goal.result(timeout=5.0)
        assert goal.status == "succeeded"
        assert result.reached_goal
        assert model.joint("finger_joint") == pytest.approx(0.2, abs=0.002)


def test_a_callback_may_send_a_goal(tmp_path: Path) -> None:
    with cw.World("empty") as world:
        arm(world, tmp_path, 1)
        goals: list[cw.Goal] = []
        command = trajectory((0.5, [0.5, -0.3]))
        world.on(0.5, lambda: goals.append(world.send_goal(FOLLOW, trajectory=command)))
        world.run(2.0)
        assert [goal.status for goal in goals] == ["succeeded"]


def test_services_respond_at_once() -> None:
    with cw.World("empty") as world:
        world.spawn("rosbots.xacro")
        assert "/imu/service" in world.services
        response = world.call("/imu/service")
        assert response.__msgtype__ == "std_srvs/srv/Empty_Response"
        assert world.time == 0.0
        with raises(SERVICE_UNKNOWN, UnknownNameError, meant="/imu/service"):
            world.call("/imu/servce")
        with raises(FIELD_UNKNOWN):
            world.call("/imu/service", number=1)
        with raises(NUMBER_OUT_OF_RANGE):
            world.call("/imu/service", timeout=-1.0)
    with raises(SIMULATION_CLOSED):
        world.call("/imu/service")


def test_commands_before_a_call_come_first(tmp_path: Path) -> None:
    with cw.World("empty") as world:
        arm(world, tmp_path, 1)
        world.run(0.1)
        load = "/controller_manager/unload_controller"
        switch = "/controller_manager/switch_controller"
        stopped = world.call(switch, stop_controllers=["arm"], strictness=2)
        assert stopped.ok
        listed = world.call("/controller_manager/list_controllers")
        assert [(each.name, each.state) for each in listed.controller] == [("arm", "stopped")]
        assert world.call(load, name="arm").ok
        assert world.actions == ()


def test_a_service_that_works_on_a_thread() -> None:
    with cw.World("empty") as world:
        graph, simulation = world.graph, world.session.simulation
        kind = "std_srvs/srv/Trigger"

        def slow(request: Any) -> Any:
            # As services that spawn models: the thread waits for the simulation's thread.
            text = simulation.call(lambda: str(world.models)).result(30)
            return graph.types.message_class(f"{kind}_Response")(success=True, message=text)

        service = graph.serve("/slow", kind, slow, threaded=True)
        response = world.call("/slow")
        assert response.success
        refused: list[CartwheelError] = []

        def call() -> None:
            try:
                world.call("/slow")
            except CartwheelError as error:
                refused.append(error)

        world.on(0.1, call)
        world.run(0.2)
        assert [error.code for error in refused] == [RUN_NESTED]
        graph.withdraw(service)

        def endless(request: Any) -> Any:
            simulation.call(lambda: None).result(30)
            waiting.wait(30)

        waiting = threading.Event()
        graph.serve("/endless", kind, endless, threaded=True)
        with raises(WAIT_TIMED_OUT, service="/endless"):
            world.call("/endless", timeout=0.2)
        waiting.set()


def test_gazebo_s_services_without_ros(make: Any, rosbots: Path) -> None:
    world = make.world()
    cart = world.spawn(rosbots, z=0.05)
    with raises(SERVICE_UNKNOWN):
        world.call("/gazebo/get_world_properties")
    world.serve_gazebo()
    world.serve_gazebo()
    pose = {"position": {"x": 2.0, "z": 0.05}, "orientation": {"w": 1.0}}
    state = {"model_name": "rosbots", "pose": pose, "twist": {"linear": {"x": 0.3}}}
    assert world.call("/gazebo/set_model_state", model_state=state).success
    assert cart.pose.x == pytest.approx(2.0)
    found = world.call("/gazebo/get_model_state", model_name="rosbots")
    assert found.success and found.pose.position.x == pytest.approx(2.0)
    # It is read on a thread of its own, and spawned on this one.
    crate = """<robot name="crate"><link name="a"><inertial><mass value="1"/><inertia ixx="1"
      iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial></link></robot>"""
    spawned = world.call("/gazebo/spawn_urdf_model", model_name="crate", model_xml=crate)
    assert spawned.success and "crate" in world.models
    states = world.topic("/gazebo/model_states")
    world.run(0.1)
    assert "crate" in states.latest.name
    saved = world.save()
    assert world.call("/gazebo/delete_model", model_name="crate").success
    world.restore(saved)
    assert "crate" in world.models
    assert world.call("/gazebo/reset_simulation") is not None
    assert world.time == 0.0


def test_a_topic_of_controllers_that_do_not_run_names_the_cause(tmp_path: Path) -> None:
    """A misspelt topic that exists is more likely meant."""
    text = robot(beam("a", "world") + transmission("a_joint", "Position"), ROS1)
    with cw.World("empty") as world:
        model = spawn(world, tmp_path, text, {})
        for use in (world.publish, world.topic, world.mailbox, model.topic):
            with raises(TOPIC_UNKNOWN, UnknownNameError, idle=(model.name,)):
                use("/cmd_vel")
        with raises(TOPIC_UNKNOWN, UnknownNameError, idle=(model.name,)):
            world.subscribe("/cmd_vel", print)
        with raises(TOPIC_UNKNOWN, UnknownNameError, meant="/clock") as caught:
            world.publish("/clokc")
        assert "idle" not in caught.value.values
