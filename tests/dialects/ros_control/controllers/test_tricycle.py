"""ROS 2's tricycle: its driven and steered wheel, and the circle that it drives."""

import math

import pytest
from tests.coded import coded
from tests.dialects.ros_control import cars
from tests.dialects.ros_control.cars import (
    BASE,
    FRONT,
    RADIUS,
    REAR,
    Car,
)

from cartwheel.codes import robot

SPEED, TURN = 0.4, 0.4
CIRCLE = SPEED / TURN
"""m: radius of the circle of the rear axle's middle."""
MIDDLE = math.atan(BASE / CIRCLE)
"""rad: how a wheel in the middle of the front axle points, about the same centre."""


def test_a_tricycle_of_one_driven_wheel(make, tmp_path):
    """``tricycle_controller``: the front wheel's rim goes a longer way than the rear axle."""
    wheels = {**FRONT, **REAR}
    made = Car(
        make, tmp_path, wheels, "cmd_vel",
        type="tricycle_controller/TricycleController",
        traction_joint_name="front_joint", steering_joint_name="front_steer",
        wheelbase=BASE, wheel_radius=RADIUS, cmd_vel_timeout=500,
    )  # fmt: skip
    made.go(1.0, x=SPEED, turn=TURN)
    assert made.joint("front_steer") == pytest.approx(MIDDLE, abs=1e-3)
    rim = SPEED / math.cos(MIDDLE) / RADIUS
    assert made.speeds("front_joint")[0] == pytest.approx(rim, rel=0.01)
    before = made.place[2]
    made.go(1.0, x=SPEED, turn=TURN)
    assert made.place[2] - before == pytest.approx(TURN, rel=0.06)
    reported = made.odometry("/base/odom")
    assert reported.twist.twist.linear.x == pytest.approx(SPEED, rel=0.03)
    assert reported.twist.twist.angular.z == pytest.approx(TURN, rel=0.03)


def test_a_tricycle_takes_plain_twists_where_that_is_set(make, tmp_path):
    made = Car(
        make, tmp_path, {**FRONT, **REAR}, "cmd_vel",
        type="tricycle_controller/TricycleController",
        traction_joint_name="front_joint", steering_joint_name="front_steer",
        wheelbase=BASE, wheel_radius=RADIUS, use_stamped_vel=False,
    )  # fmt: skip
    made.world.publish("/base/cmd_vel", linear_x=SPEED)
    made.world.run(0.3)
    assert made.speeds("front_joint")[0] == pytest.approx(SPEED / RADIUS, rel=0.01)


def test_an_axis_that_points_the_wrong_way_is_reported(make, tmp_path, monkeypatch):
    """Published robots have such joints, and steer right if left is commanded."""
    plain = cars.car
    upside_down = ('<axis xyz="0 0 1"/>', '<axis xyz="0 0 -1"/>')
    monkeypatch.setattr(cars, "car", lambda *parts: plain(*parts).replace(*upside_down))
    made = Car(
        make, tmp_path, {**FRONT, **REAR}, "cmd_vel",
        type="tricycle_controller/TricycleController",
        traction_joint_name="front_joint", steering_joint_name="front_steer",
        wheelbase=BASE, wheel_radius=RADIUS,
    )  # fmt: skip
    (reported,) = coded(made.world, robot.WHEEL_AXIS_MISALIGNED, axis="-z")
    assert reported.values["joint"] == "front_steer"
    assert str(reported.origin).startswith(str(tmp_path / "car.urdf"))
