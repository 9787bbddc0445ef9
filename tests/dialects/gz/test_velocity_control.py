"""Velocity control: a model that flies."""

import math

import pytest

from cartwheel.geometry import Pose


def test_velocity_control_flies_once_it_is_commanded(make):
    model = """<model name="drone"><link name="link"><inertial><mass>2</mass>
      <inertia><ixx>.02</ixx><iyy>.02</iyy><izz>.02</izz></inertia></inertial></link>
      <plugin name="fly" filename="gz-sim-velocity-control-system"/></model>"""
    world = make.world(ground=None)
    world.session.spawn(make.sdf(model), pose=Pose((0, 0, 50)))
    world.run(1.0)
    fallen = 50 - world.model("drone").pose.z
    assert fallen == pytest.approx(9.8 / 2, rel=0.02)
    world.publish("/model/drone/cmd_vel", linear_x=1.0, linear_z=0.5, angular_z=0.5)
    world.run(3.0)
    before = world.model("drone").pose
    world.run(1.0)
    after = world.model("drone").pose
    # Its weight takes 1/5 of what the servo has.
    assert after.z - before.z == pytest.approx(0.5, abs=0.012)
    assert after.yaw - before.yaw == pytest.approx(0.5, abs=0.01)
    assert math.dist(before.position[:2], after.position[:2]) == pytest.approx(
        2 * 1.0 / 0.5 * math.sin(0.25), abs=0.02
    )
