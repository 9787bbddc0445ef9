"""Skid steering: what sliding tyres leave of a turn."""

import math

import numpy as np
import pytest
from tests.devices.drives.carts import (
    FOUR,
    skid,
    spawn,
    turned,
    where,
)

from cartwheel.errors import UnknownNameError


def test_skid_steer_goes_straight_as_commanded(make, cart, read):
    world = spawn(make, cart(FOUR, skid()))
    world.publish("/cmd_vel", linear_x=0.5)
    world.run(1.0)
    reported = read(world, "/odom", 4.0)
    assert len(reported) == 400
    x, y, yaw = np.array(where(reported[-1])) - np.array(where(reported[0]))
    assert math.hypot(x, y) == pytest.approx(0.5 * 3.99, rel=0.01)
    assert abs(yaw) < 0.01
    assert np.diag(reported[0].pose.covariance.reshape(6, 6)) == pytest.approx(
        [1e-4, 1e-4, 1e12, 1e12, 1e12, 1e-2]
    )


def test_skid_steer_turns_by_what_sliding_leaves(make, cart, read):
    """In place, every tyre slides along and across, and its friction points against the sum.

    A wheel at (L/2, W/2) slides by (ω - ω₀) W/2 along and ω L/2 across, all by the same
    speed; the moments of their friction cancel where (ω - ω₀) W² + ω L² = 0.
    """
    length, width, wanted = 0.4, 0.3, 1.0
    world = spawn(make, cart(FOUR, skid()))
    world.publish("/cmd_vel", angular_z=wanted)
    world.run(2.0)
    reported = read(world, "/odom", 6.0)
    rate = turned(reported) / 5.99
    assert rate == pytest.approx(wanted * width**2 / (width**2 + length**2), rel=0.1)
    # The odometry is the truth, not what the wheels believe.
    yaw = world.model("cart").pose.yaw
    assert math.remainder(where(reported[-1])[2] - yaw, 2 * math.pi) == pytest.approx(0, abs=0.02)
    assert reported[-1].twist.twist.angular.z == pytest.approx(rate, rel=0.2)


def test_skid_steer_publishes_its_transform_only_when_asked(make, cart):
    world = spawn(make, cart(FOUR, skid()))
    assert "/tf" not in [topic.name for topic in world.graph.topics()]
    world = spawn(make, cart(FOUR, skid("<broadcastTF>true</broadcastTF>")))
    assert "/tf" in [topic.name for topic in world.graph.topics()]


def test_skid_steer_names_a_wheel_it_lacks(make, cart):
    wheels = {name: place for name, place in FOUR.items() if name != "left_rear"}
    with pytest.raises(UnknownNameError) as caught:
        spawn(make, cart(wheels, skid()))
    assert caught.value.values["name"] == "left_rear_joint"
    assert caught.value.origin is not None
