"""A gripper that closes: on nothing, and on what is in its way."""

import pytest
import yaml
from tests.dialects.ros_control.arms import (
    ROS1,
    robot,
    ros2_joint,
    ros2_parameters,
    ros2_plugin,
    transmission,
)
from tests.dialects.ros_control.arms import ros2_system as system

from cartwheel.graph import GoalState
from cartwheel.messages import from_dict

GOAL = "/gripper/gripper_cmd/goal"
SUCCEEDED, ABORTED, REJECTED = 3, 4, 5
BODY = """<link name="palm"><inertial><mass value="1"/><inertia ixx="1" iyy="1" izz="1" ixy="0"
  ixz="0" iyz="0"/></inertial></link>{stop}<joint name="bolt" type="fixed"><parent link="world"/>
  <child link="palm"/><origin xyz="0 0 1"/></joint>
  <link name="finger"><inertial><mass value="0.2"/><inertia ixx="1e-4" iyy="1e-4" izz="1e-4"
  ixy="0" ixz="0" iyz="0"/></inertial><collision><geometry><box size="0.02 0.02 0.02"/></geometry>
  </collision></link><joint name="finger_joint" type="prismatic"><parent link="palm"/>
  <child link="finger"/><axis xyz="1 0 0"/><limit lower="0" upper="0.3" effort="50" velocity="1"/>
  </joint>"""
STOP = """<link name="stop"><inertial><mass value="1"/><inertia ixx="0.01" iyy="0.01" izz="0.01"
  ixy="0" ixz="0" iyz="0"/></inertial><collision>
  <origin xyz="0.15 0 0"/><geometry><box size="0.02 0.1 0.1"/>
  </geometry></collision></link><joint name="post" type="fixed"><parent link="world"/>
  <child link="stop"/><origin xyz="0 0 1"/></joint>"""
"""Its face is at 0.14 m, which a finger of 0.02 m reaches at 0.13 m."""


def gripper(bench, stop=""):
    urdf = robot(BODY.format(stop=stop) + transmission("finger_joint", "Position"), ROS1)
    urdf = urdf.replace("</robot>", "<gazebo><self_collide>true</self_collide></gazebo></robot>")
    made = bench(
        urdf,
        {
            "gripper": {
                "type": "position_controllers/GripperActionController",
                "joint": "finger_joint",
                "stall_timeout": 0.3,
                "goal_tolerance": 0.002,
            }
        },
    )
    made.results = made.box("/gripper/gripper_cmd/result")
    made.world.run(0.1)
    return made


def close(made, position, effort=0.0):
    made.publish(
        GOAL,
        "control_msgs/msg/GripperCommandActionGoal",
        goal={"command": {"position": position, "max_effort": effort}},
    )


def test_it_reaches_what_nothing_keeps_it_from(bench):
    made = gripper(bench)
    close(made, 0.2)
    made.world.run(1.0)
    (result,) = made.results.drain()
    assert result.status.status == SUCCEEDED
    assert (result.result.reached_goal, result.result.stalled) == (True, False)
    assert made.position("finger_joint") == pytest.approx(0.2, abs=0.002)


def test_it_stalls_on_what_is_in_its_way_and_presses_as_hard_as_it_may(bench):
    made = gripper(bench, STOP)
    close(made, 0.25, effort=5.0)
    made.world.run(2.0)
    (result,) = made.results.drain()
    assert result.status.status == ABORTED
    assert (result.result.reached_goal, result.result.stalled) == (False, True)
    assert made.position("finger_joint") == pytest.approx(0.13, abs=0.003)
    assert result.result.effort == pytest.approx(5.0, rel=0.05)


def test_a_gripper_that_does_not_run_is_there_and_takes_nothing(bench):
    """A client waits for the status of a server before it sends anything."""
    made = gripper(bench)
    made.world.graph.post = lambda function: function()
    assert made.call(
        "/controller_manager/switch_controller", start_controllers=[],
        stop_controllers=["gripper"], strictness=2, start_asap=False, timeout=0.0,
    ).ok  # fmt: skip
    status = made.box("/gripper/gripper_cmd/status")
    made.world.run(1.0)
    assert len(status.drain()) == pytest.approx(5, abs=1)
    close(made, 0.2)
    made.world.run(0.1)
    (result,) = made.results.drain()
    assert result.status.status == REJECTED


@pytest.fixture
def parallel(bench, tmp_path):
    """ROS 2's gripper whose goals have a velocity and an effort."""

    def made(stop="", **more):
        file = tmp_path / "own.yaml"
        settings = {
            "type": "parallel_gripper_action_controller/GripperActionController",
            "joint": "finger_joint",
            "stall_timeout": 0.3,
            "goal_tolerance": 0.002,
            **more,
        }
        file.write_text(yaml.safe_dump(ros2_parameters(gripper=settings)))
        body = BODY.format(stop=stop) + system(ros2_joint("finger_joint"))
        urdf = robot(body, ros2_plugin(file)).replace(
            "</robot>", "<gazebo><self_collide>true</self_collide></gazebo></robot>"
        )
        bent = bench(urdf)
        bent.world.run(0.1)
        (bent.action,) = bent.world.graph.actions()
        return bent

    return made


def grip(made, **command):
    kind = "control_msgs_ros2/action/ParallelGripperCommand_Goal"
    return made.action.submit(from_dict(kind, {"command": command}))


def test_a_parallel_gripper_goes_at_the_goals_velocity(parallel):
    made = parallel()
    goal = grip(made, position=[0.2], velocity=[0.1])
    made.world.run(1.0)
    assert made.position("finger_joint") == pytest.approx(0.1, abs=0.005)
    assert goal.state is GoalState.ACTIVE
    made.world.run(1.2)
    assert goal.state is GoalState.SUCCEEDED
    assert goal.result.reached_goal
    assert goal.result.state.name == ["finger_joint"]
    assert goal.result.state.position[0] == pytest.approx(0.2, abs=0.002)
    assert grip(made, position=[0.1, 0.1]).state is GoalState.REJECTED


def test_a_parallel_gripper_presses_as_hard_as_the_goal_says(parallel):
    made = parallel(STOP, allow_stalling=True)
    goal = grip(made, position=[0.25], effort=[5.0])
    made.world.run(2.0)
    assert goal.state is GoalState.SUCCEEDED
    assert (goal.result.reached_goal, goal.result.stalled) == (False, True)
    assert goal.result.state.effort[0] == pytest.approx(5.0, rel=0.05)
    assert made.warnings == []
