"""gz-sim's cars: the circle that they drive."""

import math

import pytest
from tests.devices.drives.carts import (
    CAR,
    FRONT,
    circle,
    path,
    spawn,
)


def gz_ackermann(tags=""):
    return f"""<plugin name="drive" filename="gz-sim-ackermann-steering-system">
      <left_joint>rear_left_joint</left_joint><right_joint>rear_right_joint</right_joint>
      <left_steering_joint>front_left_steering</left_steering_joint>
      <right_steering_joint>front_right_steering</right_steering_joint>
      <wheel_separation>0.3</wheel_separation><kingpin_width>0.3</kingpin_width>
      <wheel_base>0.4</wheel_base><wheel_radius>0.1</wheel_radius>
      <steering_limit>0.6</steering_limit>{tags}</plugin>"""


def test_gz_car_goes_round_at_the_rate_it_is_commanded(make, cart, read):
    speed, turn = 0.5, 0.4
    world = spawn(make, cart(CAR, gz_ackermann(), forks=FRONT))
    world.publish("/model/cart/cmd_vel", linear_x=speed, angular_z=turn)
    world.run(2.0)
    start = world.model("cart").pose.yaw
    reported = read(world, "/model/cart/odometry", 5.0)
    assert circle(path(reported)) == pytest.approx(speed / turn, rel=0.02)
    true_turn = math.remainder(world.model("cart").pose.yaw - start, 2 * math.pi)
    assert true_turn == pytest.approx(5.0 * turn, rel=0.03)


def test_gz_car_steers_no_further_than_its_limit(make, cart):
    """If a tighter turn than L / tan 0.6 is commanded, it turns at that radius."""
    world = spawn(make, cart(CAR, gz_ackermann(), forks=FRONT))
    world.publish("/model/cart/cmd_vel", linear_x=0.3, angular_z=5.0)
    world.run(1.0)
    left = world.session.simulation.joint_position("cart", "front_left_steering")
    radius = 0.4 / math.tan(0.6)
    assert left == pytest.approx(math.atan2(0.4, radius - 0.15), abs=0.01)
