"""Trajectories by topic and by action: followed, ended, missed, called off."""

import pytest
from tests.dialects.ros_control.arms import ROS1, beam, robot, transmission

GOAL = "/arm_controller/follow_joint_trajectory/goal"
KIND = "control_msgs/msg/FollowJointTrajectoryActionGoal"
SUCCEEDED, ABORTED, PREEMPTED, REJECTED = 3, 4, 2, 5
NAMES = ("a_joint", "b_joint")


def urdf(interface="Position", limit=""):
    body = beam("a", "world", limit=limit) + beam("b", "world", origin="0 1 1", limit=limit)
    return robot(body + "".join(transmission(name, interface) for name in NAMES), ROS1)


def controllers(interface="position", **more):
    return {
        "arm_controller": {
            "type": f"{interface}_controllers/JointTrajectoryController",
            "joints": list(NAMES),
            **more,
        }
    }


def point(seconds, *positions, **more):
    whole = int(seconds)
    span = {"sec": whole, "nanosec": round((seconds - whole) * 1e9)}
    return {"positions": list(positions), "time_from_start": span, **more}


def send(made, *points, identity="one", **more):
    trajectory = {"joint_names": list(reversed(NAMES)), "points": list(points)}
    made.publish(GOAL, KIND, goal_id={"id": identity}, goal={"trajectory": trajectory, **more})


def results(box):
    return [
        (each.status.goal_id.id, each.status.status, each.result.error_code) for each in box.drain()
    ]


@pytest.fixture
def arm(bench):
    made = bench(urdf(), controllers())
    made.results = made.box("/arm_controller/follow_joint_trajectory/result")
    made.world.run(0.1)
    return made


def test_joints_are_where_the_trajectory_says_at_each_time(arm):
    """Cubics from rest to rest and on: halfway in the middle; names in any order."""
    states = arm.box("/arm_controller/state")
    send(
        arm,
        point(1.0, -0.4, 0.8, velocities=[0.0, 0.0]),
        point(2.0, 0.0, 0.0, velocities=[0.0, 0.0]),
    )
    arm.world.run(0.5)
    assert arm.position("a_joint") == pytest.approx(0.4, abs=0.01)
    assert arm.position("b_joint") == pytest.approx(-0.2, abs=0.01)
    arm.world.run(0.5)
    assert arm.position("a_joint") == pytest.approx(0.8, abs=0.005)
    assert results(arm.results) == []
    arm.world.run(1.1)
    assert results(arm.results) == [("one", SUCCEEDED, 0)]
    assert arm.position("a_joint") == pytest.approx(0.0, abs=1e-3)
    off = [abs(float(error)) for state in states.drain() for error in state.error.positions]
    assert max(off) < 0.01


@pytest.mark.parametrize("earlier", [False, True])
def test_a_goal_that_is_sent_before_the_first_step_is_followed(bench, earlier):
    made = bench(urdf(), controllers())
    box = made.box("/arm_controller/follow_joint_trajectory/result")
    if earlier:
        send(made, point(1.0, 0.4, 0.4, velocities=[0.0, 0.0]), identity="zero")
    send(made, point(1.0, 0.0, 0.8, velocities=[0.0, 0.0]))
    made.world.run(1.2)
    followed = [("zero", PREEMPTED, 0)] if earlier else []
    assert results(box) == [*followed, ("one", SUCCEEDED, 0)]
    assert made.position("a_joint") == pytest.approx(0.8, abs=0.005)


def test_a_goal_before_the_first_step_is_rejected_if_the_controller_stops(bench):
    made = bench(urdf(), controllers())
    box = made.box("/arm_controller/follow_joint_trajectory/result")
    send(made, point(1.0, 0.0, 0.8, velocities=[0.0, 0.0]))
    made.call(
        "/controller_manager/switch_controller",
        start_controllers=[],
        stop_controllers=["arm_controller"],
        strictness=2,
        start_asap=False,
        timeout=0.0,
    )
    made.world.run(0.5)
    assert [(name, status) for name, status, _ in results(box)] == [("one", REJECTED)]
    assert made.position("a_joint") == pytest.approx(0.0, abs=0.01)


def test_a_new_goal_takes_the_place_of_the_old_one_without_a_jump(arm):
    send(arm, point(1.0, 0.0, 1.0, velocities=[0.0, 0.0]), identity="one")
    arm.world.run(0.5)
    before = arm.position("a_joint")
    send(arm, point(1.0, 0.0, 0.0, velocities=[0.0, 0.0]), identity="two")
    arm.world.run(0.02)
    # It goes on at the speed that it had, 1.5 rad/s in the middle of a cubic.
    assert arm.position("a_joint") == pytest.approx(before + 1.5 * 0.02, abs=0.01)
    arm.world.run(1.2)
    assert results(arm.results) == [("one", PREEMPTED, 0), ("two", SUCCEEDED, 0)]


def test_a_goal_that_is_called_off_stops_the_joints_where_they_are(arm):
    send(arm, point(2.0, 0.0, 1.0))
    arm.world.run(1.0)
    arm.publish(
        "/arm_controller/follow_joint_trajectory/cancel", "actionlib_msgs/msg/GoalID", id="one"
    )
    arm.world.run(0.05)
    stopped = arm.position("a_joint")
    assert stopped == pytest.approx(0.5, abs=0.05)
    arm.world.run(1.0)
    assert arm.position("a_joint") == pytest.approx(stopped, abs=0.02)
    assert results(arm.results) == [("one", PREEMPTED, 0)]


def test_goals_that_cannot_be_followed_are_rejected(arm):
    arm.publish(
        GOAL, KIND, goal={"trajectory": {"joint_names": ["a_joint"], "points": [point(1.0, 0.1)]}}
    )
    send(arm, point(1.0, 0.1), identity="short")
    send(arm, point(1.0, 0.1, 0.1), point(1.0, 0.2, 0.2), identity="same time")
    send(arm, point(1.0, float("nan"), 0.1), identity="no number")
    send(arm, identity="empty")
    arm.world.run(0.1)
    found = results(arm.results)
    assert [status for _, status, _ in found] == [REJECTED] * 5
    assert [code for _, _, code in found] == [-2, -1, -1, -1, -1]
    arm.world.run(0.5)
    assert arm.position("a_joint") == pytest.approx(0.0, abs=1e-3)


def test_a_point_at_no_time_is_gone_to_as_fast_as_the_joints_may(bench):
    """0.5 rad at 1 rad/s take half a second, and no goal is missed before."""
    made = bench(urdf(limit='lower="-3" upper="3" effort="100" velocity="1"'), controllers())
    made.results = made.box("/arm_controller/follow_joint_trajectory/result")
    made.world.run(0.1)
    send(made, point(0, 0.0, 0.5), goal_tolerance=[{"name": "a_joint", "position": 0.01}])
    made.world.run(0.3)
    assert made.position("a_joint") == pytest.approx(0.3, abs=0.05)
    assert results(made.results) == []
    made.world.run(0.6)
    assert results(made.results) == [("one", SUCCEEDED, 0)]


def test_a_path_that_the_joint_cannot_keep_is_aborted(bench):
    """At 1 rad/s at most it is more than 0.1 rad behind a line of 4 rad/s after 0.04 s."""
    made = bench(
        urdf(limit='lower="-3" upper="3" effort="200" velocity="1"'),
        controllers(constraints={"a_joint": {"trajectory": 0.1}}),
    )
    box = made.box("/arm_controller/follow_joint_trajectory/result")
    made.world.run(0.1)
    send(made, point(0.5, 0.0, 2.0))
    made.world.run(0.2)
    assert results(box) == [("one", ABORTED, -4)]
    stopped = made.position("a_joint")
    made.world.run(1.0)
    assert made.position("a_joint") == pytest.approx(stopped, abs=0.02)


def test_a_goal_that_is_not_reached_in_time_is_aborted(bench):
    made = bench(
        urdf(limit='lower="-3" upper="3" effort="200" velocity="0.5"'),
        controllers(constraints={"goal_time": 0.3, "a_joint": {"goal": 0.05}}),
    )
    box = made.box("/arm_controller/follow_joint_trajectory/result")
    made.world.run(0.1)
    send(made, point(0.5, 0.0, 2.0))
    made.world.run(1.0)
    assert results(box) == []
    made.world.run(0.3)
    assert results(box) == [("one", ABORTED, -5)]
    # With more patience, which the goal may have of its own, it comes there: 2 rad at 0.5 rad/s.
    made.world.reset()
    made.world.run(0.1)
    send(made, point(0.5, 0.0, 2.0), identity="two", goal_time_tolerance={"sec": 10})
    made.world.run(4.5)
    assert results(box) == [("two", SUCCEEDED, 0)]


def test_gravity_is_borne_by_the_pid_on_effort(bench):
    gains = {name: {"p": 2000.0, "i": 500.0, "d": 150.0, "i_clamp": 50.0} for name in NAMES}
    made = bench(urdf("Effort"), controllers("effort", gains=gains))
    made.world.run(0.5)
    send(made, point(1.0, 0.3, -0.3, velocities=[0.0, 0.0]))
    made.world.run(3.0)
    assert made.position("a_joint") == pytest.approx(-0.3, abs=0.005)
    assert made.position("b_joint") == pytest.approx(0.3, abs=0.005)


def test_the_topic_moves_as_well_and_an_empty_trajectory_stops(arm):
    kind = "trajectory_msgs/msg/JointTrajectory"
    arm.publish(
        "/arm_controller/command", kind, joint_names=list(NAMES), points=[point(1.0, 0.6, 0.2)]
    )
    arm.world.run(0.5)
    assert arm.position("a_joint") == pytest.approx(0.3, abs=0.01)
    arm.publish("/arm_controller/command", kind, joint_names=list(NAMES))
    arm.world.run(0.1)
    stopped = arm.position("a_joint")
    arm.world.run(1.0)
    assert arm.position("a_joint") == pytest.approx(stopped, abs=0.01)


def test_a_joint_without_limits_goes_the_short_way(bench):
    body = beam("a", "world", kind="continuous") + beam("b", "world", origin="0 1 1")
    made = bench(
        robot(body + "".join(transmission(name, "Position") for name in NAMES), ROS1), controllers()
    )
    made.world.run(0.1)
    send(made, point(1.0, 0.0, 6.0))
    made.world.run(1.5)
    assert made.position("a_joint") == pytest.approx(6.0 - 6.283185, abs=0.01)
