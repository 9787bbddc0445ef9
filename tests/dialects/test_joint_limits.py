"""What moves a joint stops at the joint's limits, which a file states or a program sets."""

import numpy as np
import pytest
from tests.dialects.ros_control.arms import (
    ROS1,
    beam,
    robot,
    ros2_joint,
    ros2_parameters,
    ros2_plugin,
    transmission,
)
from tests.dialects.ros_control.arms import ros2_system as system

PLUGINS = {
    "libgazebo_ros_diff_drive.so": """<left_joint>left</left_joint><right_joint>right</right_joint>
      <wheelSeparation>0.3</wheelSeparation><wheelDiameter>0.2</wheelDiameter>""",
    "libgazebo_ros_skid_steer_drive.so": """<leftFrontJoint>left</leftFrontJoint>
      <rightFrontJoint>right</rightFrontJoint><leftRearJoint>left</leftRearJoint>
      <rightRearJoint>right</rightRearJoint>
      <wheelSeparation>0.3</wheelSeparation><wheelDiameter>0.2</wheelDiameter>""",
    "gz-sim-diff-drive-system": """<left_joint>left</left_joint><right_joint>right</right_joint>
      <wheel_separation>0.3</wheel_separation><wheel_radius>0.1</wheel_radius>
      <topic>cmd_vel</topic>""",
}
WHEEL = """<link name="{0}_wheel"><pose>0 {1} 0.1 -1.5707963 0 0</pose><inertial><mass>0.5</mass>
  <inertia><ixx>0.00125</ixx><iyy>0.00125</iyy><izz>0.0025</izz></inertia></inertial>
  <collision name="c"><geometry><sphere><radius>0.1</radius></sphere></geometry></collision></link>
  <joint name="{0}" type="revolute"><parent>body</parent><child>{0}_wheel</child>
  <axis><xyz>0 0 1</xyz>{2}</axis></joint>"""


def cart(make, plugin, limits=None, speed=None):
    """A cart, with the limits of its left wheel: positions, or a velocity."""
    stated = "<limit><lower>{}</lower><upper>{}</upper></limit>".format(*limits) if limits else ""
    if speed is not None:
        stated = f"<limit><velocity>{speed}</velocity></limit>"
    wheels = WHEEL.format("left", 0.15, stated) + WHEEL.format("right", -0.15, "")
    tag = f'<plugin name="p" filename="{plugin}">{PLUGINS[plugin]}</plugin>'
    return make.world(
        make.sdf(
            f"""<model name="cart"><link name="body"><pose>0 0 0.1 0 0 0</pose><inertial>
            <pose>0 0 -0.05 0 0 0</pose><mass>8</mass><inertia><ixx>0.1</ixx><iyy>0.1</iyy>
            <izz>0.1</izz></inertia></inertial></link>{wheels}{tag}</model>"""
        )
    )


@pytest.mark.parametrize("limits", [(-0.5, 0.5), (0.0, 0.0)])
@pytest.mark.parametrize("plugin", PLUGINS)
def test_a_drive_stops_its_wheels_at_their_limits(make, plugin, limits):
    angles = []
    for stated in (True, False):
        world = cart(make, plugin, limits if stated else None)
        joints = world.model("cart").joints
        world.run(0.1)
        if not stated:
            joints["left"].limits = limits
        world.publish("/cmd_vel", linear_x=0.2)
        world.run(2.0)
        angles.append(joints.positions["left"])
        # The other wheel still turns.
        assert joints.positions["right"] > 2.0
    assert angles == pytest.approx([limits[1]] * 2, abs=1e-3)


@pytest.mark.parametrize("plugin", PLUGINS)
def test_a_wheel_turns_again_when_its_limits_are_removed(make, plugin):
    world = cart(make, plugin, (-0.5, 0.5))
    left = world.model("cart").joints["left"]
    world.publish("/cmd_vel", linear_x=0.2)
    world.run(2.0)
    left.limits = (None, None)
    world.run(2.0)
    assert left.position == pytest.approx(0.5 + 2 * 2.0, abs=0.1)
    left.limits = (None, 6.0)
    world.run(2.0)
    assert left.position == pytest.approx(6.0, abs=1e-3)


LIMIT = 'lower="-1" upper="0.5" effort="100" velocity="10"'


def _ros1(bench):
    body = beam("beam", "world", axis="0 0 1", limit=LIMIT) + transmission("beam_joint", "Effort")
    one = {"type": "effort_controllers/JointEffortController", "joint": "beam_joint"}
    made = bench(robot(body, ROS1), {"one": one})
    made.publish("/one/command", "std_msgs/msg/Float64", data=20.0)
    return made.world


def _ros2(bench):
    body = beam("beam", "world", axis="0 0 1", limit=LIMIT)
    one = {"type": "effort_controllers/JointGroupEffortController", "joints": ["beam_joint"]}
    made = bench(
        robot(body + system(ros2_joint("beam_joint", "effort")), ros2_plugin("x")),
        ros2_parameters(200, one=one),
    )
    made.publish("/one/commands", "std_msgs/msg/Float64MultiArray", data=[20.0])
    return made.world


def _gz(bench):
    body = beam("beam", "world", axis="0 0 1", limit=LIMIT)
    plugin = """<plugin name="p" filename="gz-sim-apply-joint-force-system">
      <joint_name>beam_joint</joint_name></plugin>"""
    made = bench(robot(body, plugin))
    made.publish("/model/arm/joint/beam_joint/cmd_force", "std_msgs/msg/Float64", data=20.0)
    return made.world


def _pid(bench):
    body = beam("beam", "world", axis="0 0 1", limit=LIMIT) + transmission("beam_joint", "Effort")
    one = {
        "type": "effort_controllers/JointVelocityController",
        "joint": "beam_joint",
        "pid": {"p": 10.0},
    }
    made = bench(robot(body, ROS1), {"one": one})
    made.publish("/one/command", "std_msgs/msg/Float64", data=2.0)
    return made.world


def _program(bench):
    made = bench(robot(beam("beam", "world", axis="0 0 1", limit=LIMIT), ""))
    made.model.joints.efforts["beam_joint"] = 20.0
    return made.world


@pytest.mark.parametrize("commanded", [_ros1, _ros2, _gz, _pid, _program])
def test_a_joint_that_an_effort_pushes_against_its_limit_rests_there(bench, commanded):
    world = commanded(bench)
    joint = world.model("arm").joints["beam_joint"]
    world.run(3.0)
    positions, efforts = [], []
    for _ in range(100):
        world.step()
        positions.append(joint.position)
        efforts.append(joint.effort)
    assert positions == pytest.approx([0.5] * 100, abs=1e-3)
    assert np.ptp(positions) < 1e-6
    assert efforts == pytest.approx([20.0] * 100, abs=0.1)


def test_velocity_controllers_stop_at_limits_that_a_program_sets(bench):
    body = beam("beam", "world", axis="0 0 1", limit=LIMIT)
    one = {"type": "velocity_controllers/JointGroupVelocityController", "joints": ["beam_joint"]}
    made = bench(
        robot(body + system(ros2_joint("beam_joint", "velocity")), ros2_plugin("x")),
        ros2_parameters(200, one=one),
    )
    made.publish("/one/commands", "std_msgs/msg/Float64MultiArray", data=[1.0])
    made.world.run(2.0)
    assert made.position("beam_joint") == pytest.approx(0.5, abs=1e-3)
    made.model.joints["beam_joint"].limits = (-1.0, 0.8)
    made.world.run(1.0)
    assert made.position("beam_joint") == pytest.approx(0.8, abs=1e-3)


def test_a_saved_wheel_continues_to_its_limit(make):
    """Also if the limit was set after the state was saved."""
    world = cart(make, "gz-sim-diff-drive-system")
    left = world.model("cart").joints["left"]
    world.publish("/cmd_vel", linear_x=0.2)
    world.run(0.5)
    free = world.save()
    left.limits = (-1.0, 1.5)
    world.run(0.1)
    limited = world.save()
    world.run(2.0)
    end = left.position
    assert end == pytest.approx(1.5, abs=1e-3)
    world.restore(limited)
    world.run(2.0)
    assert left.position == end
    world.restore(free)
    world.run(2.0)
    assert left.position > 3.0


STILL = LIMIT.replace('velocity="10"', 'velocity="0"')
CONTROLS = {
    "gz_ros2_control-system": ("gz_ros2_control/GazeboSimSystem", False),
    "libgazebo_ros2_control.so": ("gazebo_ros2_control/GazeboSystem", True),
}


@pytest.mark.parametrize("command", ["position", "velocity"])
@pytest.mark.parametrize("manager", CONTROLS)
def test_a_velocity_limit_of_0_holds_the_joints_of_gz_sim(bench, manager, command):
    """gazebo_ros2_control sets positions and velocities, without velocity limits."""
    hardware, moves = CONTROLS[manager]
    body = beam("beam", "world", axis="0 0 1", limit=STILL)
    body += system(ros2_joint("beam_joint", command))
    one = {"type": f"{command}_controllers/JointGroup{command.title()}Controller"}
    made = bench(
        robot(body, ros2_plugin("x"))
        .replace("gz_ros2_control/GazeboSimSystem", hardware)
        .replace("gz_ros2_control-system", manager),
        ros2_parameters(200, one={**one, "joints": ["beam_joint"]}),
    )
    made.publish("/one/commands", "std_msgs/msg/Float64MultiArray", data=[0.2])
    made.world.run(1.0)
    expected = pytest.approx(0.2, abs=0.02) if moves else pytest.approx(0.0, abs=1e-6)
    assert made.position("beam_joint") == expected


@pytest.mark.parametrize("kind", ["Position", "Velocity"])
def test_a_velocity_limit_of_0_holds_the_joints_of_ros_1(bench, kind):
    body = beam("beam", "world", axis="0 0 1", limit=STILL) + transmission("beam_joint", kind)
    group = f"{kind.lower()}_controllers/Joint{kind}Controller"
    made = bench(robot(body, ROS1), {"one": {"type": group, "joint": "beam_joint"}})
    made.publish("/one/command", "std_msgs/msg/Float64", data=0.2)
    made.world.run(1.0)
    assert made.position("beam_joint") == pytest.approx(0.0, abs=1e-6)


def test_a_velocity_limit_of_0_holds_a_wheel_of_a_gz_sim_drive(make):
    left = []
    for speed in (9.0, 0.0):
        world = cart(make, "gz-sim-diff-drive-system", speed=speed)
        world.publish("/cmd_vel", linear_x=0.2)
        world.run(1.0)
        left.append(world.model("cart").joints.positions["left"])
    assert left == pytest.approx([2.0, 0.0], abs=0.05)
