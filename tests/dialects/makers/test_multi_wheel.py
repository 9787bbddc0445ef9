"""Hector's drive with any number of wheels on each side."""

import math

import numpy as np
import pytest
from tests.devices.drives.carts import (
    FOUR,
    RADIUS,
    spawn,
    where,
)


def test_multi_wheel_drives_sides_of_unlike_count(make, cart, read):
    wheels = {**FOUR, "left_middle": (0.0, 0.15)}
    plugin = """<plugin name="drive" filename="libdiffdrive_plugin_multi_wheel.so">
      <leftJoints>left_front_joint left_middle_joint left_rear_joint</leftJoints>
      <rightJoints>right_front_joint right_rear_joint</rightJoints>
      <wheelSeparation>0.3</wheelSeparation><wheelDiameter>0.2</wheelDiameter>
      <torque>50</torque><robotBaseFrame>base_link</robotBaseFrame></plugin>"""
    world = spawn(make, cart(wheels, plugin))
    world.publish("/cmd_vel", linear_x=0.5)
    world.run(1.0)
    reported = read(world, "/odom", 2.0)
    x, y, _ = np.array(where(reported[-1])) - np.array(where(reported[0]))
    assert math.hypot(x, y) == pytest.approx(0.5 * 1.99, rel=0.01)
    speeds = [world.session.simulation.data.joint(f"cart::{name}_joint").qvel[0] for name in wheels]
    assert speeds == pytest.approx([0.5 / RADIUS] * 5, rel=0.01)
