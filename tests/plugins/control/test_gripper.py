"""A gripper that closes: on nothing, and on what is in its way."""

import pytest
from tests.plugins.control.arms import ROS1, robot, transmission

GOAL = "/gripper/gripper_cmd/goal"
SUCCEEDED, ABORTED = 3, 4
BODY = """<link name="palm"><inertial><mass value="1"/><inertia ixx="1" iyy="1" izz="1" ixy="0"
  ixz="0" iyz="0"/></inertial>{stop}</link><joint name="bolt" type="fixed"><parent link="world"/>
  <child link="palm"/><origin xyz="0 0 1"/></joint>
  <link name="finger"><inertial><mass value="0.2"/><inertia ixx="1e-4" iyy="1e-4" izz="1e-4"
  ixy="0" ixz="0" iyz="0"/></inertial><collision><geometry><box size="0.02 0.02 0.02"/></geometry>
  </collision></link><joint name="finger_joint" type="prismatic"><parent link="palm"/>
  <child link="finger"/><axis xyz="1 0 0"/><limit lower="0" upper="0.3" effort="50" velocity="1"/>
  </joint>"""
STOP = """<collision><origin xyz="0.15 0 0"/><geometry><box size="0.02 0.1 0.1"/></geometry>
  </collision>"""
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
