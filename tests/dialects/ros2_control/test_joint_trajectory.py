"""What a trajectory controller does by ROS 2's rules, and by its gains."""

import pytest
import yaml
from tests.dialects.ros_control.arms import (
    ARM,
    GRAVITY,
    MASS,
    beam,
    robot,
    ros2_joint,
    ros2_parameters,
    ros2_plugin,
)
from tests.dialects.ros_control.arms import ros2_system as system

from cartwheel import World
from cartwheel.graph import GoalState
from cartwheel.messages import from_dict

GAZEBO = "gz_ros2_control/GazeboSimSystem"
GOAL = "control_msgs_ros2/action/FollowJointTrajectory_Goal"


@pytest.fixture
def arm(bench, tmp_path):
    def made(interface="position", *, limit="", **more):
        file = tmp_path / "own.yaml"
        settings = {
            "type": "joint_trajectory_controller/JointTrajectoryController",
            "joints": ["beam_joint"],
            "command_interfaces": [interface],
            "state_interfaces": ["position", "velocity"],
            **more,
        }
        file.write_text(yaml.safe_dump(ros2_parameters(200, arm=settings)))
        body = beam("beam", "world", limit=limit) + system(ros2_joint("beam_joint", interface))
        bent = bench(robot(body, ros2_plugin(file)))
        bent.world.run(0.1)
        (bent.action,) = bent.world.graph.actions()
        return bent

    return made


def point(seconds, *positions, **more):
    whole = int(seconds)
    span = {"sec": whole, "nanosec": round((seconds - whole) * 1e9)}
    return {"positions": list(positions), "time_from_start": span, **more}


def send(made, *points, **more):
    trajectory = {"joint_names": ["beam_joint"], "points": list(points)}
    return made.action.submit(from_dict(GOAL, {"trajectory": trajectory, **more}))


def test_the_only_point_at_time_0_does_not_wait_for_a_joint_that_cannot_move(arm):
    made = arm(limit='lower="-3" upper="3" effort="100" velocity="0"')
    assert send(made, point(0, 0.5)).state is GoalState.ACTIVE
    made.world.run(0.5)
    assert made.position("beam_joint") == pytest.approx(0.0, abs=0.01)


def test_it_must_stop_at_the_end_unless_it_may_go_on(arm):
    made = arm()
    assert send(made, point(1, 0.5, velocities=[0.5])).state is GoalState.REJECTED
    assert send(made, point(1, 0.5, velocities=[0.0])).state is GoalState.ACTIVE


def test_points_of_velocities_alone_are_integrated_where_that_is_allowed(arm):
    assert send(arm(), point(1, velocities=[0.4])).state is GoalState.REJECTED
    made = arm(allow_integration_in_goal_trajectories=True)
    # From rest to 0.4 rad/s and back to rest: two triangles of 0.2 rad each.
    goal = send(made, point(1, velocities=[0.4]), point(2, velocities=[0.0]))
    assert goal.state is GoalState.ACTIVE
    made.world.run(1.0)
    assert made.position("beam_joint") == pytest.approx(0.2, abs=0.01)
    made.world.run(1.2)
    assert made.position("beam_joint") == pytest.approx(0.4, abs=0.01)
    assert goal.state is GoalState.SUCCEEDED


def test_joints_of_several_degrees_of_freedom_are_refused(arm):
    made = arm()
    many = {"multi_dof_trajectory": {"joint_names": ["base"], "points": [{}]}}
    assert send(made, point(1, 0.1), **many).state is GoalState.REJECTED
    odd = {"component_goal_tolerance": [{"joint_name": "base"}]}
    refused = send(made, point(1, 0.1), **odd)
    assert (refused.state, refused.result.error_code) == (GoalState.REJECTED, -2)


def test_a_new_trajectory_aborts_the_goal_before(arm):
    made = arm()
    goal = send(made, point(10, 0.5))
    kind = "trajectory_msgs/msg/JointTrajectory"
    made.publish("/arm/joint_trajectory", kind, joint_names=["beam_joint"], points=[point(1, 0.1)])
    made.world.run(0.1)
    assert (goal.state, goal.result.error_code) == (GoalState.ABORTED, -1)


def test_without_an_integral_it_sags_by_what_the_gain_gives(arm):
    """A weight of 19.6 N at half a metre, on 100 N m/rad: 0.098 rad."""
    made = arm("effort", gains={"beam_joint": {"p": 100.0, "d": 20.0}})
    made.world.run(4.0)
    assert made.position("beam_joint") == pytest.approx(MASS * GRAVITY * ARM / 100, rel=0.02)


def test_the_integral_lifts_it_again(arm):
    """Nothing clamps it unless that is stated."""
    made = arm("effort", gains={"beam_joint": {"p": 100.0, "i": 100.0, "d": 20.0}})
    made.world.run(8.0)
    assert made.position("beam_joint") == pytest.approx(0.0, abs=0.002)


def test_an_output_that_is_clamped_below_the_weight_lets_it_fall(arm):
    weight = MASS * GRAVITY * ARM
    made = arm("effort", gains={"beam_joint": {"p": 1000.0, "d": 20.0, "u_clamp_min": -weight / 2}})
    # With half of its weight left on an inertia of 0.6 kg m²: 8 rad/s² for half a second.
    made.world.run(0.4)
    assert made.position("beam_joint") == pytest.approx(8.17 * 0.5**2 / 2, rel=0.1)


def test_velocities_are_fed_forward(arm):
    """Without a gain, the velocity alone drives a velocity interface: the way is its integral."""
    made = arm("velocity", gains={"beam_joint": {"p": 0.0, "ff_velocity_scale": 1.0}})
    send(made, point(1, 0.5, velocities=[0.0]))
    made.world.run(1.2)
    assert made.position("beam_joint") == pytest.approx(0.5, abs=0.02)
    assert made.warnings == []


@pytest.mark.parametrize(
    ("hardware", "offered", "listed", "starts"),
    [
        (
            "gz_ros2_control/GazeboSimSystem",
            ("position", "velocity"),
            ("position", "velocity"),
            True,
        ),
        ("gz_ros2_control/GazeboSimSystem", ("position",), ("position", "velocity"), False),
        # Gazebo's hardware does not export it, although it is listed.
        (GAZEBO, ("position", "acceleration"), ("position", "acceleration"), False),
        (
            "mock_components/GenericSystem",
            ("position", "acceleration"),
            ("position", "acceleration"),
            True,
        ),
    ],
)
def test_it_starts_only_with_all_interfaces_that_it_commands(
    tmp_path, hardware, offered, listed, starts
):
    file = tmp_path / "own.yaml"
    settings = {
        "type": "joint_trajectory_controller/JointTrajectoryController",
        "joints": ["beam_joint"],
        "command_interfaces": [*listed],
        "state_interfaces": ["position", "velocity"],
    }
    file.write_text(yaml.safe_dump(ros2_parameters(200, arm=settings)))
    joints = system(ros2_joint("beam_joint", *offered))
    joints = joints.replace(GAZEBO, hardware)
    path = tmp_path / "arm.urdf"
    path.write_text(robot(beam("beam", "world") + joints, ros2_plugin(file)))
    with World("empty", lenient=True) as world:
        world.spawn(path)
        world.run(0.1)
        assert len([*world.graph.actions()]) == starts
