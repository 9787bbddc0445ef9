"""gz-sim's mecanum drive: its motion, odometry and limits."""

import math
import re

import pytest
from tests.coded import coded
from tests.devices.drives.carts import (
    FOUR,
    cart_sdf,
    spawn,
)

from cartwheel.codes import devices
from cartwheel.codes.robot import WHEEL_AXIS_MISALIGNED

MECANUM = """<plugin name="drive" filename="gz-sim-mecanum-drive-system">
  <front_left_joint>left_front_joint</front_left_joint>
  <front_right_joint>right_front_joint</front_right_joint>
  <back_left_joint>left_rear_joint</back_left_joint>
  <back_right_joint>right_rear_joint</back_right_joint>
  <wheelbase>0.4</wheelbase><wheel_separation>0.3</wheel_separation>
  <wheel_radius>0.1</wheel_radius></plugin>"""


@pytest.mark.parametrize("motion", [(0.3, 0.0, 0.0), (0.0, 0.3, 0.0), (0.2, 0.1, 0.5)])
def test_mecanum_goes_where_it_is_commanded_and_believes_its_wheels(make, cart, read, motion):
    forward, sideways, turn = motion
    world = spawn(make, cart(FOUR, MECANUM, mu=0.3))
    world.publish("/model/cart/cmd_vel", linear_x=forward, linear_y=sideways, angular_z=turn)
    world.run(0.5)
    start = world.model("cart").pose
    reported = read(world, "/model/cart/odometry", 2.0)
    end = start.inverse() @ world.model("cart").pose
    # Along the chord of an arc of 2 s.
    chord = 2.0 * (math.sin(turn) / turn if turn else 1.0)
    cos, sin = math.cos(turn), math.sin(turn)
    expected = (
        chord * (cos * forward - sin * sideways),
        chord * (sin * forward + cos * sideways),
    )
    assert (end.x, end.y) == pytest.approx(expected, abs=0.02)
    assert end.yaw == pytest.approx(2.0 * turn, abs=0.03)
    twist = reported[-1].twist.twist
    assert (twist.linear.x, twist.linear.y, twist.angular.z) == pytest.approx(
        (forward, sideways, turn), abs=0.01
    )


def turned(model):
    """The same cart, facing along y: its wheels are turned about the base."""

    def turn(match):
        x, y = float(match[1]), float(match[2])
        return f"<pose>{-y} {x} {match[3]} {-math.pi / 2} 0 {math.pi / 2}</pose>"

    text = re.sub(rf"<pose>(\S+) (\S+) (\S+) {-math.pi / 2} 0 0</pose>", turn, model)
    assert text != model
    return text


@pytest.mark.parametrize("motion", [(0.3, 0.0, 0.0), (0.0, 0.3, 0.0), (0.0, 0.0, 0.5)])
def test_a_mecanum_drive_that_faces_along_y_moves_as_its_wheels_roll(make, cart, motion):
    forward, sideways, turn = motion
    text = turned(cart_sdf(FOUR, MECANUM, mu=0.3))
    world = spawn(make, make.sdf(text))
    world.publish("/model/cart/cmd_vel", linear_x=forward, linear_y=sideways, angular_z=turn)
    world.run(0.5)
    start = world.model("cart").pose
    world.run(2.0)
    end = start.inverse() @ world.model("cart").pose
    assert (end.x, end.y) == pytest.approx((-2.0 * sideways, 2.0 * forward), abs=0.02)
    assert end.yaw == pytest.approx(2.0 * turn, abs=0.03)


def test_mecanum_wheels_speed_up_no_faster_than_they_may(make, cart, read):
    limits = "<max_velocity>0.4</max_velocity><max_acceleration>0.5</max_acceleration>"
    drive = MECANUM.replace("</plugin>", f"{limits}<max_jerk>1</max_jerk></plugin>")
    world = spawn(make, cart(FOUR, drive, mu=0.3))
    (warning,) = [d for d in world.diagnostics if d.severity == "warning"]
    assert warning.code is devices.PLUGIN_PARAMETER_IGNORED
    assert warning.values["parameter"] == "max_jerk"
    world.publish("/model/cart/cmd_vel", linear_x=1.0)
    world.run(0.4)
    slow = read(world, "/model/cart/odometry", 0.02)[-1].twist.twist.linear.x
    assert slow == pytest.approx(0.5 * 0.4, abs=0.03)
    world.run(1.0)
    fast = read(world, "/model/cart/odometry", 0.02)[-1].twist.twist.linear.x
    assert fast == pytest.approx(0.4, abs=0.01)


@pytest.mark.parametrize("motion", [(0.3, 0.0, 0.0), (0.0, 0.3, 0.0), (0.0, 0.0, 0.5)])
@pytest.mark.parametrize("aside", [False, True])
def test_wheels_whose_axes_point_to_the_right_move_the_robot_backward(make, motion, aside):
    """Each wheel rolls in the opposite direction, so the robot moves and turns in it."""
    forward, sideways, turn = motion
    text = cart_sdf(FOUR, MECANUM, mu=0.3).replace("<xyz>0 0 1</xyz>", "<xyz>0 0 -1</xyz>")
    world = spawn(make, make.sdf(turned(text) if aside else text))
    (warning,) = coded(world, WHEEL_AXIS_MISALIGNED)
    assert warning.values["attribute"] == "backwards"
    world.publish("/model/cart/cmd_vel", linear_x=forward, linear_y=sideways, angular_z=turn)
    world.run(0.5)
    start = world.model("cart").pose
    world.run(2.0)
    end = start.inverse() @ world.model("cart").pose
    wanted = (sideways, -forward) if aside else (-forward, -sideways)
    assert (end.x, end.y) == pytest.approx([2.0 * each for each in wanted], abs=0.02)
    assert end.yaw == pytest.approx(-2.0 * turn, abs=0.03)
