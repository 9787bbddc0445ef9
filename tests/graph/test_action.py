"""Actions in process: names, what a cancellation means, how long goals are known."""

import pytest
from tests.coded import raises

from cartwheel.codes.graph import SERVICE_TAKEN
from cartwheel.graph import Action, ActionTopics, GoalState, Graph
from cartwheel.messages import from_dict, message_class

KIND = "control_msgs_ros2/action/GripperCommand"
NANO = 1_000_000_000


class Worker:
    """Accepts every goal, and ends those that are called off."""

    def __init__(self):
        self.graph = Graph()
        self.now = 0
        self.action = Action(
            self.graph,
            "grip",
            KIND,
            node="hand",
            time_ns=lambda: self.now,
            on_goal=lambda goal: goal.accept(),
            on_cancel=lambda goal: goal.cancel(self.result()),
        )

    def result(self, **fields):
        return from_dict(f"{KIND}_Result", fields)

    def submit(self, identity, **more):
        return self.action.submit(from_dict(f"{KIND}_Goal", {}), identity=identity, **more)


@pytest.fixture
def worker():
    return Worker()


def test_a_name_is_offered_once(worker):
    assert worker.action.name == "/grip"
    with raises(SERVICE_TAKEN, name="/grip", node="hand"):
        Action(
            worker.graph, "/grip", KIND, node="other", time_ns=lambda: 0, on_goal=print,
            on_cancel=print,
        )  # fmt: skip
    worker.action.close()
    assert worker.graph.actions() == []


def test_a_cancellation_means_a_name_a_time_or_all(worker):
    goals = {name: worker.submit(name, stamp_ns=at) for name, at in (("a", 1), ("b", 5), ("c", 9))}
    assert worker.action.cancel(identity="nobody") == []
    assert worker.action.cancel(identity="b") == [goals["b"]]
    assert goals["b"].state is GoalState.CANCELLED
    assert worker.action.cancel(before_ns=5) == [goals["a"]]
    assert worker.action.cancel() == [goals["c"]]
    assert worker.action.cancel() == []


def test_a_goal_of_a_known_name_is_not_taken_again(worker):
    assert worker.submit("a") is not None
    assert worker.submit("a") is None
    assert worker.submit("").id != worker.submit("").id


def test_goals_that_are_done_are_known_for_a_while_and_some_for_longer(worker):
    for number in range(50):
        worker.submit(str(number)).succeed(worker.result())
    assert len(worker.action.goals) == 50
    worker.now = 11 * NANO
    worker.submit("late")
    assert [goal.id for goal in worker.action.goals] == [*map(str, range(30, 50)), "late"]
    worker.action.restart()
    assert [goal.id for goal in worker.action.goals] == ["late"]


def test_ros1_has_its_types_on_five_topics(worker):
    topics = ActionTopics(worker.graph, worker.action)
    box = worker.graph.mailbox("/grip/result")
    status = worker.graph.mailbox("/grip/status")
    feedback = worker.graph.mailbox("/grip/feedback")
    assert worker.action.wants_feedback
    goal = message_class("control_msgs/msg/GripperCommandActionGoal")
    kind = "control_msgs/msg/GripperCommandActionGoal"
    message = from_dict(kind, {"goal_id": {"id": "x"}, "goal": {"command": {"position": 0.3}}})
    assert isinstance(message, goal)
    worker.graph.publish("/grip/goal", kind, message)
    found = worker.action.goal("x")
    assert found.goal.__msgtype__ == f"{KIND}_Goal"
    assert found.goal.command.position == 0.3
    found.feedback(from_dict(f"{KIND}_Feedback", {"position": 0.1}))
    found.succeed(worker.result(reached_goal=True), "there")
    (reported,) = box.drain()
    assert reported.__msgtype__ == "control_msgs/msg/GripperCommandActionResult"
    assert (reported.status.status, reported.status.text, reported.result.reached_goal) == (
        3,
        "there",
        True,
    )
    assert [[each.status for each in one.status_list] for one in status.drain()] == [[1], [3]]
    assert feedback.drain()[0].feedback.position == 0.1
    topics.close()
    assert worker.graph.topics() == [info for info in worker.graph.topics() if not info.publishers]


def test_a_flood_of_goals_is_bounded(worker):
    topics = ActionTopics(worker.graph, worker.action)
    reported = []
    worker.graph.subscribe(
        "/grip/status", lambda message: reported.append(len(message.status_list))
    )
    last = None
    for number in range(300):
        goal = worker.submit(f"quick {number}")
        if last is not None:
            last.cancel(worker.result())
        last = goal
    assert len(worker.action.goals) <= 100
    assert max(reported) <= 100
    # Messages with the states of all goals do not grow in number with the goals.
    assert len(reported) <= 10
    worker.now = NANO
    worker.submit("later").cancel(worker.result())
    assert len(reported) == 12
    topics.publish_status()
    assert len(reported) == 13
    # The latest are still known, and one under way is not forgotten.
    assert worker.action.goal("quick 250") is not None
    assert worker.action.goal("quick 100") is None
    long = [worker.submit(f"long {number}") for number in range(130)]
    states = [goal.state for goal in long]
    assert states.count(GoalState.ACTIVE) == 99
    assert states[99:] == [GoalState.REJECTED] * 31
    assert "100" in long[-1].text
    assert len(worker.action.goals) <= 101
    worker.action.cancel()
    assert worker.submit("again").state is GoalState.ACTIVE
    topics.close()
