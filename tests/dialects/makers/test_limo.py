"""LIMO's car: driven by the plugin, and steered by the position controllers that it commands."""

import math

import pytest
import yaml
from tests.dialects.ros_control.arms import ROS1, transmission
from tests.dialects.ros_control.cars import RADIUS, car, four_wheels

BASE, TRACK, MOST = 0.2, 0.172, 0.523598767
"""Constants of the original: m, m, rad."""
PLUGIN = f"""<plugin name="drive" filename="libgazebo_ros_ackerman.so">
  <leftFrontJoint>front_left_joint</leftFrontJoint>
  <rightFrontJoint>front_right_joint</rightFrontJoint>
  <leftRearJoint>rear_left_joint</leftRearJoint><rightRearJoint>rear_right_joint</rightRearJoint>
  <wheelDiameter>{2 * RADIUS}</wheelDiameter><torque>50</torque>
  <robotBaseFrame>base_link</robotBaseFrame></plugin>"""
FORKS = ("front_left_steer", "front_right_steer")
WHEELS = ("rear_left_joint", "rear_right_joint", "front_left_joint", "front_right_joint")


class Limo:
    def __init__(self, make, folder, *, controllers=True):
        robot, file = folder / "car.urdf", folder / "steering.yaml"
        tags = "".join(transmission(name, "Position") for name in FORKS)
        # Four wheels on the constants' rectangle, so that they roll without slip.
        wheels = {
            name: (x * BASE / 0.5, y * TRACK / 0.4, steered)
            for name, (x, y, steered) in four_wheels(steered=True).items()
        }
        robot.write_text(car(wheels, PLUGIN + ROS1, (), tags))
        kind = "position_controllers/JointPositionController"
        file.write_text(
            yaml.safe_dump(
                {
                    f"limo_f{side}_steering_hinge_controller": {"type": kind, "joint": joint}
                    for side, joint in zip("lr", FORKS, strict=True)
                }
            )
        )
        self.world = make.world()
        self.model = self.world.spawn(robot, z=RADIUS, controllers=[file] * controllers)
        self.simulation = self.world.session.simulation

    def drive(self, seconds, speed, turn):
        self.world.publish("/cmd_vel", linear_x=speed, angular_z=turn)
        self.world.run(seconds)

    def positions(self, *joints):
        return [self.simulation.joint_position("car", joint) for joint in joints]

    def speeds(self):
        """rad/s, of the four wheels."""
        before = self.positions(*WHEELS)
        self.world.run(0.1)
        return [(b - a) / 0.1 for a, b in zip(before, self.positions(*WHEELS), strict=True)]


@pytest.mark.parametrize("turn", [0.5, -0.5])
def test_the_wheels_turn_about_one_point(make, tmp_path, turn):
    limo, speed = Limo(make, tmp_path), 0.3
    limo.drive(1.0, speed, turn)
    radius = speed / turn
    left, right = limo.positions(*FORKS)
    assert left == pytest.approx(math.atan(BASE / (radius - TRACK / 2)), abs=2e-3)
    assert right == pytest.approx(math.atan(BASE / (radius + TRACK / 2)), abs=2e-3)
    lever = 0.2 * TRACK
    sides = [speed - turn * lever, speed + turn * lever]
    front = [side / math.cos(angle) for side, angle in zip(sides, (left, right), strict=True)]
    wanted = [each / RADIUS for each in (*sides, *front)]
    assert limo.speeds() == pytest.approx(wanted, rel=0.01)
    start = limo.model.pose.yaw
    limo.world.run(2.0)
    yaw = math.remainder(limo.model.pose.yaw - start, 2 * math.pi)
    # The steering angles demand the commanded rate, but the speeds of the two sides demand only
    # the part 2 lever / track of it. The wheels slip, and the robot turns at a rate between both.
    assert 2 * lever / TRACK < yaw / (2.0 * turn) < 1.0


def test_the_sign_of_the_angle_is_that_of_the_turn_also_in_reverse(make, tmp_path):
    limo = Limo(make, tmp_path)
    limo.drive(1.0, -0.3, 0.5)
    left, right = limo.positions(*FORKS)
    assert left > right > 0.2
    rear_left, rear_right, *_ = limo.speeds()
    # The inner wheel turns more slowly.
    assert rear_right < rear_left < 0


def test_a_turn_at_standstill_only_steers(make, tmp_path):
    limo = Limo(make, tmp_path)
    limo.drive(1.0, 0.0, -1.0)
    assert limo.positions(*FORKS) == pytest.approx([-MOST, -MOST], abs=2e-3)
    assert limo.speeds() == pytest.approx([0.0] * 4, abs=1e-3)


def test_odometry_is_the_pose_in_the_world(make, tmp_path):
    limo = Limo(make, tmp_path, controllers=False)
    box = limo.world.mailbox("/odom", size=1000)
    limo.drive(2.0, 0.3, 0.0)
    messages = box.drain()
    assert len(messages) == pytest.approx(200, abs=1)
    last = messages[-1]
    assert last.pose.pose.position.x == pytest.approx(limo.model.pose.x, abs=0.01)
    assert last.twist.twist.linear.x == pytest.approx(0.3, rel=0.02)
    assert last.pose.covariance[0] == 1e-4
    assert last.pose.covariance[35] == 0.01
    assert (last.header.frame_id, last.child_frame_id) == ("odom", "base_link")
