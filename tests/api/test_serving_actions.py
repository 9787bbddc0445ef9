"""Actions that a program offers."""

from __future__ import annotations

import pytest
from tests.coded import raises

import cartwheel as cw
from cartwheel.codes.command import OPTION_INVALID
from cartwheel.codes.graph import FIELD_UNKNOWN, MESSAGE_TYPE_UNKNOWN, SERVICE_TAKEN
from cartwheel.codes.world import SIMULATION_CLOSED
from cartwheel.errors import GraphError, SimulationError, UnknownNameError
from cartwheel.msgs.control_msgs_ros2 import GripperCommand_Goal

TYPE = "control_msgs_ros2/action/GripperCommand"


@pytest.fixture
def world():
    with cw.World() as made:
        yield made


class Gripper:
    """Reaches its position after 1 s, with feedback after 0.5 s."""

    def __init__(self, world):
        self.world, self.goals = world, []
        self.server = world.serve_action("/grip", GripperCommand_Goal, self.receive)

    def receive(self, goal):
        self.goals.append(goal)
        position = goal.goal.command.position
        if position > 1.0:
            goal.reject("too far")
            return
        start = self.world.time
        self.world.on(start + 0.5, lambda: goal.feedback(position=position / 2))
        self.world.on(start + 1.0, lambda: goal.succeed(position=position, reached_goal=True))


def test_a_goal_is_reached_later(world):
    gripper = Gripper(world)
    assert world.actions == ("/grip",) and gripper.server.type == TYPE
    goal = world.send_goal("/grip", command={"position": 0.4})
    assert goal.status == "active"
    world.run(0.7)
    assert goal.feedback.position == 0.2 and not goal.done
    result = goal.result(timeout=1.0)
    assert (world.time, goal.status) == (1.0, "succeeded")
    assert (result.position, result.reached_goal) == (0.4, True)
    assert gripper.goals[0].done
    gripper.goals[0].succeed(position=3.0)
    gripper.goals[0].feedback(position=3.0)
    assert goal.result().position == 0.4 and goal.feedback.position == 0.2


def test_a_goal_is_rejected_or_ends_at_once(world):
    Gripper(world)
    goal = world.send_goal("/grip", command={"position": 2.0})
    assert (goal.status, goal.text) == ("rejected", "too far")
    world.serve_action("/now", TYPE, lambda goal: goal.abort({"stalled": True}, "stuck"))
    goal = world.send_goal("/now")
    assert (goal.status, goal.text, goal.result().stalled) == ("aborted", "stuck", True)


def test_a_goal_is_cancelled(world):
    Gripper(world)
    goal = world.send_goal("/grip", command={"position": 0.4})
    world.run(0.2)
    goal.cancel()
    assert goal.status == "cancelled"
    world.run(2.0)
    assert goal.status == "cancelled"

    def slowly(received):
        world.on(world.time + 0.5, lambda: received.cancel(position=0.1))

    world.serve_action("/slow", TYPE, lambda goal: None, on_cancel=slowly)
    goal = world.send_goal("/slow")
    goal.cancel()
    assert goal.status == "active"
    assert goal.result(timeout=1.0).position == 0.1 and goal.status == "cancelled"


def test_reset_and_restore_abort_goals(world):
    Gripper(world)
    state = world.save()
    for rewind in (world.reset, lambda: world.restore(state)):
        goal = world.send_goal("/grip", command={"position": 0.4})
        world.run(0.2)
        rewind()
        assert (goal.status, goal.text) == ("aborted", "the world was reset")
        again = world.send_goal("/grip", command={"position": 0.1})
        assert again.result(timeout=2.0).position == 0.1


def test_an_exception_aborts_the_goal_and_stops_the_run(world):
    def wrong(goal):
        raise ValueError("no gripper")

    world.serve_action("/wrong", TYPE, wrong)
    goal = world.send_goal("/wrong")
    assert goal.status == "aborted" and "no gripper" in goal.text
    with pytest.raises(ValueError, match="no gripper"):
        world.run(0.1)
    world.serve_action("/field", TYPE, lambda goal: goal.succeed(positions=1.0))
    world.send_goal("/field")
    with raises(FIELD_UNKNOWN, GraphError, meant="position"):
        world.run(0.1)


def test_goals_of_ros_1_are_received(world):
    """They arrive as messages on the topics of the action."""
    Gripper(world)
    results = world.topic("/grip/result")
    world.publish("/grip/goal", goal={"command": {"position": 0.3}})
    world.run(1.5)
    assert results.latest.result.position == 0.3


def test_the_end_of_an_action(world):
    gripper = Gripper(world)
    goal = world.send_goal("/grip", command={"position": 0.4})
    gripper.server.close()
    gripper.server.close()
    assert goal.status == "aborted" and world.actions == ()
    assert not [topic for topic in world.topics if topic.startswith("/grip")]
    world.run(2.0)
    other = Gripper(world)
    world.close()
    other.server.close()


def test_what_is_refused(world):
    Gripper(world)
    for name, kind, function, code, error in (
        ("/grip", TYPE, print, SERVICE_TAKEN, GraphError),
        ("/a", "std_srvs/srv/Trigger", print, MESSAGE_TYPE_UNKNOWN, UnknownNameError),
        ("/a", TYPE, 3, OPTION_INVALID, cw.CartwheelError),
    ):
        with raises(code, error):
            world.serve_action(name, kind, function)
    assert world.actions == ("/grip",)
    world.close()
    with raises(SIMULATION_CLOSED, SimulationError):
        world.serve_action("/a", TYPE, print)


def test_an_action_of_a_robot(world):
    cart = world.spawn("rosbots.xacro", namespace="left")
    cart.serve_action("grip", TYPE, lambda goal: goal.succeed())
    assert world.actions == ("/left/grip",)
    assert cart.send_goal("grip").status == "succeeded"


def test_an_action_of_a_package_that_is_not_found_says_how_to_add_it() -> None:
    """The name is that of the action, not that of a message for its goals."""
    with cw.World() as world:
        name = "nav2_msgs/action/NavigateToPose"
        values = {"name": name, "kind": "action type", "package": "nav2_msgs"}
        with raises(MESSAGE_TYPE_UNKNOWN, UnknownNameError, **values):
            world.serve_action("/navigate_to_pose", name, print)
        with raises(MESSAGE_TYPE_UNKNOWN, UnknownNameError) as typo:
            world.serve_action("/navigate", "control_msgs/action/FolowJointTrajectory", print)
        assert "package" not in typo.value.values
