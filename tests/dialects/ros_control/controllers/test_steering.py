"""Drives that steer: the angles and speeds of their wheels, the circle that they drive."""

import math

import pytest
from tests.dialects.ros_control.cars import (
    BASE,
    FRONT,
    RADIUS,
    REAR,
    TRACK,
    Car,
    four_wheels,
    heading,
)

from cartwheel.codes.robot import STEERING_REVERSED, WHEEL_AXIS_MISALIGNED

SPEED, TURN = 0.4, 0.4
CIRCLE = SPEED / TURN
"""m: radius of the circle of the rear axle's middle."""
MIDDLE = math.atan(BASE / CIRCLE)
"""rad: how a wheel in the middle of the front axle points, about the same centre."""


@pytest.fixture
def ackermann(make, tmp_path):
    def made(**more):
        settings = {
            "type": "ackermann_steering_controller/AckermannSteeringController",
            "traction_joints_names": ["rear_right_joint", "rear_left_joint"],
            "steering_joints_names": ["front_right_steer", "front_left_steer"],
            "wheelbase": BASE,
            "traction_track_width": TRACK,
            "steering_track_width": TRACK,
            "traction_wheels_radius": RADIUS,
            **more,
        }
        return Car(make, tmp_path, four_wheels(steered=True), "reference", **settings)

    return made


def test_both_front_wheels_point_about_one_centre_and_rear_ones_differ(ackermann):
    """The centre is on the rear axle's line, a circle's radius to the left."""
    made = ackermann()
    made.go(1.0, x=SPEED, turn=TURN)
    left = math.atan(BASE / (CIRCLE - TRACK / 2))
    right = math.atan(BASE / (CIRCLE + TRACK / 2))
    assert made.joint("front_left_steer") == pytest.approx(left, abs=1e-3)
    assert made.joint("front_right_steer") == pytest.approx(right, abs=1e-3)
    rims = [TURN * (CIRCLE + side * TRACK / 2) / RADIUS for side in (-1, 1)]
    assert made.speeds("rear_left_joint", "rear_right_joint") == pytest.approx(rims, rel=0.01)


def test_wheels_and_commands_are_published_in_the_order_of_the_lists(ackermann):
    made = ackermann()
    box = made.world.mailbox("/base/controller_state", size=1000)
    made.go(1.0, x=SPEED, turn=TURN)
    state = box.drain()[-1]
    right, left = (math.atan(BASE / (CIRCLE + side * TRACK / 2)) for side in (1, -1))
    assert list(state.steering_angle_command) == pytest.approx([right, left])
    assert list(state.steer_positions) == pytest.approx([right, left], abs=1e-3)
    rims = [TURN * (CIRCLE + side * TRACK / 2) / RADIUS for side in (1, -1)]
    assert list(state.linear_velocity_command) == pytest.approx(rims)
    assert list(state.traction_wheels_velocity) == pytest.approx(rims, rel=0.01)
    assert len(state.traction_wheels_position) == 0


def backward(text):
    """The car, driven along -x and steered by the axle behind, whose steering axes point down."""
    return text.replace('<axis xyz="0 1 0"/>', '<axis xyz="0 -1 0"/>').replace(
        '<axis xyz="0 0 1"/>', '<axis xyz="0 0 -1"/>'
    )


def reported(made, code):
    return [each.values["joint"] for each in made.world.diagnostics if each.code is code]


def test_a_car_that_faces_backward_has_its_right_wheels_where_they_are_listed(ackermann):
    """Its wheels roll along -x, and the joints that are listed first are at the larger y."""
    made = ackermann(
        edit=backward,
        traction_joints_names=["rear_left_joint", "rear_right_joint"],
        steering_joints_names=["front_left_steer", "front_right_steer"],
    )
    assert reported(made, STEERING_REVERSED) == reported(made, WHEEL_AXIS_MISALIGNED) == []
    made.go(0.5, x=SPEED, turn=TURN)
    before = made.place[2]
    made.go(2.0, x=SPEED, turn=TURN)
    assert made.place[2] - before == pytest.approx(2.0 * TURN, rel=0.05)
    inner, outer = (math.atan(BASE / (CIRCLE + side * TRACK / 2)) for side in (-1, 1))
    assert made.joint("front_right_steer") == pytest.approx(inner, abs=1e-3)
    assert made.joint("front_left_steer") == pytest.approx(outer, abs=1e-3)


def test_wheels_that_roll_backward_by_mistake_keep_their_sides(ackermann):
    made = ackermann(edit=lambda text: text.replace('xyz="0 1 0"', 'xyz="0 -1 0"'))
    assert reported(made, WHEEL_AXIS_MISALIGNED) == ["rear_left_joint", "rear_right_joint"]
    made.go(0.5, x=SPEED, turn=TURN)
    left = math.atan(BASE / (CIRCLE - TRACK / 2))
    assert made.joint("front_left_steer") == pytest.approx(left, abs=1e-3)


@pytest.mark.parametrize(("axis", "wrong"), [("0 0 1", True), ("0 0 -1", False)])
def test_a_steering_axis_behind_the_driven_wheels_must_point_down(ackermann, axis, wrong):
    made = ackermann(
        edit=lambda text: text.replace('xyz="0.25 ', 'xyz="-0.75 ').replace("0 0 1", axis)
    )
    steers = ["front_left_steer", "front_right_steer"]
    assert sorted(reported(made, STEERING_REVERSED)) == (steers if wrong else [])
    assert reported(made, WHEEL_AXIS_MISALIGNED) == []


def test_positions_of_wheels_are_published_where_the_odometry_is_of_them(ackermann):
    made = ackermann(position_feedback=True)
    box = made.world.mailbox("/base/controller_state", size=1000)
    made.go(0.5, x=SPEED)
    state = box.drain()[-1]
    assert len(state.traction_wheels_velocity) == 0
    right = made.joint("rear_right_joint")
    # A step of control earlier.
    assert state.traction_wheels_position[0] == pytest.approx(right, abs=SPEED / RADIUS * 0.011)


def test_it_drives_that_circle_and_publishes_it(ackermann):
    made = ackermann()
    # Into the curve; the circle counts from there.
    made.go(0.5, x=SPEED, turn=TURN)
    x, y, yaw = made.place
    first = made.odometry()
    before = made.place[2]
    made.go(2.0, x=SPEED, turn=TURN)
    turned = made.place[2] - before
    assert turned == pytest.approx(2.0 * TURN, rel=0.05)
    reported = made.odometry()
    assert heading(reported) - heading(first) == pytest.approx(2.05 * TURN, rel=0.02)
    assert reported.twist.twist.linear.x == pytest.approx(SPEED, rel=0.02)
    assert reported.twist.twist.angular.z == pytest.approx(TURN, rel=0.02)
    assert (reported.header.frame_id, reported.child_frame_id) == ("odom", "base_link")
    # From the rear axle's middle at the start, the centre is a radius to the left.
    rear = (x - BASE / 2 * math.cos(yaw), y - BASE / 2 * math.sin(yaw))
    centre = (rear[0] - CIRCLE * math.sin(yaw), rear[1] + CIRCLE * math.cos(yaw))
    assert math.dist(made.place[:2], centre) == pytest.approx(
        math.hypot(CIRCLE, BASE / 2), rel=0.05
    )


def test_a_command_counts_for_a_second(ackermann):
    made = ackermann()
    made.send(x=SPEED)
    made.world.run(0.5)
    assert made.speeds("rear_left_joint")[0] == pytest.approx(SPEED / RADIUS, rel=0.01)
    made.world.run(0.6)
    assert made.speeds("rear_left_joint")[0] == pytest.approx(0.0, abs=0.01)


def test_odometry_of_commands_needs_no_wheels(ackermann):
    made = ackermann(open_loop=True)
    made.go(1.0, x=SPEED, turn=TURN)
    assert heading(made.odometry()) == pytest.approx(1.0 * TURN, abs=0.03)


def test_a_bicycle_has_one_wheel_of_each(make, tmp_path):
    """A trike's middle wheels alone are commanded; its outer ones only carry."""
    wheels = {**FRONT, **REAR}
    made = Car(
        make, tmp_path, wheels, "reference",
        type="bicycle_steering_controller/BicycleSteeringController",
        traction_joints_names=["rear_left_joint"], steering_joints_names=["front_steer"],
        wheelbase=BASE, traction_wheel_radius=RADIUS,
    )  # fmt: skip
    made.send(x=SPEED, turn=TURN)
    made.world.run(0.5)
    assert made.joint("front_steer") == pytest.approx(MIDDLE, abs=1e-3)
    assert made.speeds("rear_left_joint")[0] == pytest.approx(SPEED / RADIUS, rel=0.01)
    # Without speed there is nothing but to point across.
    made.go(0.5, turn=0.5)
    assert made.joint("front_steer") == pytest.approx(1.4, abs=0.01)


def test_a_tricycle_steers_one_wheel_and_drives_two(make, tmp_path):
    wheels = {**FRONT, **REAR}
    made = Car(
        make, tmp_path, wheels, "reference",
        type="tricycle_steering_controller/TricycleSteeringController",
        traction_joints_names=["rear_right_joint", "rear_left_joint"],
        steering_joints_names=["front_steer"],
        wheelbase=BASE, traction_track_width=TRACK, traction_wheels_radius=RADIUS,
    )  # fmt: skip
    made.go(1.0, x=SPEED, turn=-TURN)
    assert made.joint("front_steer") == pytest.approx(-MIDDLE, abs=1e-3)
    rims = [TURN * (CIRCLE + side * TRACK / 2) / RADIUS for side in (1, -1)]
    assert made.speeds("rear_left_joint", "rear_right_joint") == pytest.approx(rims, rel=0.01)
    before = made.place[2]
    made.go(1.0, x=SPEED, turn=-TURN)
    assert made.place[2] - before == pytest.approx(-TURN, rel=0.06)
