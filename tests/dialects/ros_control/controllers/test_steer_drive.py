"""ROS 1's steer drive: its wheel, its steering joint and the curve that its odometry reports."""

import math

import pytest
import yaml
from tests.coded import coded
from tests.dialects.ros_control.arms import ROS1, transmission
from tests.dialects.ros_control.cars import BASE, FRONT, RADIUS, REAR, Driven, car

from cartwheel.codes import running

SPEED, ANGLE = 0.4, 0.3


class Bicycle(Driven):
    """A tricycle of which one rear wheel is driven."""

    def __init__(self, make, folder, **settings):
        robot, file = folder / "car.urdf", folder / "drive.yaml"
        joints = transmission("rear_left_joint", "Velocity") + transmission(
            "front_steer", "Position"
        )
        robot.write_text(car({**FRONT, **REAR}, ROS1, (), joints))
        kind = "steer_drive_controller/SteerDriveController"
        names = {"rear_wheel": "rear_left_joint", "front_steer": "front_steer"}
        file.write_text(yaml.safe_dump({"base": {"type": kind, **names, **settings}}))
        self.world = make.world()
        self.world.spawn(robot, z=RADIUS, controllers=[file])
        self.world.run(0.2)

    def position(self, joint):
        return self.world.session.simulation.joint_position("car", joint)


def test_a_command_is_a_speed_and_a_steering_angle(make, tmp_path):
    bicycle = Bicycle(make, tmp_path)
    twist = bicycle.drive(1.0, SPEED, ANGLE)
    before = bicycle.position("rear_left_joint")
    bicycle.drive(0.1, SPEED, ANGLE)
    assert bicycle.position("rear_left_joint") - before == pytest.approx(
        0.1 * SPEED / RADIUS, rel=0.01
    )
    assert bicycle.position("front_steer") == pytest.approx(ANGLE, abs=1e-3)
    # The wheel base and the radius are those of the robot description.
    assert twist.linear.x == pytest.approx(SPEED, rel=0.01)
    assert twist.angular.z == pytest.approx(SPEED * math.tan(ANGLE) / BASE, rel=0.01)


def test_limits_and_factors_apply(make, tmp_path):
    """At 0.2 m/s², a speed of 0.1 m/s is reached after half a second."""
    limits = {"has_acceleration_limits": True, "max_acceleration": 0.2}
    bicycle = Bicycle(
        make, tmp_path, linear={"x": limits}, wheel_separation_h_multiplier=2.0, open_loop=True
    )
    twist = bicycle.drive(0.5, SPEED, ANGLE)
    # The mean of the last ten of 50 updates.
    assert twist.linear.x == pytest.approx(0.09, abs=0.005)
    assert twist.angular.z == pytest.approx(twist.linear.x * math.tan(ANGLE) / (2 * BASE))


def test_a_wheel_base_must_be_positive(make, tmp_path):
    bicycle = Bicycle(make, tmp_path, wheel_separation_h=-0.2)
    (warning,) = coded(bicycle.world, running.CONTROLLER_NOT_STARTED)
    assert warning.values["parameter"] == "wheel_separation_h"
