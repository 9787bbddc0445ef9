"""A base that is moved by its velocity or by forces, and may not move sideways."""

import pytest
from tests.coded import coded

from cartwheel.codes import devices

MASS = 20.0


def base(make, tags):
    return make.sdf(f"""<model name="base"><link name="base_link"><inertial><mass>{MASS}</mass>
      <inertia><ixx>1</ixx><iyy>1</iyy><izz>1</izz></inertia></inertial></link>
      <plugin name="p" filename="libgazebo_ros_planar_force_move.so">{tags}</plugin></model>""")


def moved(make, read, tags, **command):
    world = make.world(ground=None, gravity=0.0, step=0.001)
    world.session.spawn(base(make, tags))
    world.publish("/cmd_vel", **command)
    return world, read(world, "/odom", 0.5)[-1].twist.twist


def test_its_velocity_is_controlled_without_gains(make, read):
    _, twist = moved(make, read, "", linear_x=0.3, linear_y=-0.2, angular_z=0.0)
    assert (twist.linear.x, twist.linear.y) == pytest.approx((0.3, -0.2), abs=1e-3)


def test_forces_approach_the_velocity_with_their_gain(make, read):
    """k / m is 2 /s, so after 0.5 s a part of 1 - exp(-1) is reached, less the last period."""
    tags = f"""<useForceFeedback>true</useForceFeedback><forceGainX>{2 * MASS}</forceGainX>
      <forceGainY>{2 * MASS}</forceGainY><forceGainRot>10</forceGainRot>"""
    _, twist = moved(make, read, tags, linear_x=0.3)
    assert twist.linear.x == pytest.approx(0.3 * 0.63, rel=0.06)


def test_it_does_not_move_sideways_if_that_is_switched_off(make, read):
    _, twist = moved(make, read, "<enableYAxis>false</enableYAxis>", linear_x=0.3, linear_y=-0.2)
    assert (twist.linear.x, twist.linear.y) == pytest.approx((0.3, 0.0), abs=1e-3)


def test_gains_that_differ_are_reported(make, read):
    tags = "<useForceFeedback>1</useForceFeedback><forceGainY>5</forceGainY>"
    world, _ = moved(make, read, tags, linear_x=0.1)
    (reported,) = coded(world, devices.PLUGIN_PARAMETER_IGNORED)
    assert reported.values["parameter"] == "forceGainY"


LOW = """<model name="base"><link name="base_link"><inertial><mass>20</mass><inertia><ixx>0.1</ixx>
  <iyy>0.1</iyy><izz>0.1</izz></inertia></inertial><pose>0 0 0.05 0 0 0</pose><collision name="c">
  <geometry><box><size>0.3 0.3 0.1</size></box></geometry></collision></link>
  <link name="head"><pose>0 0 1 0 0 0</pose><inertial><mass>20</mass><inertia><ixx>0.1</ixx>
  <iyy>0.1</iyy><izz>0.1</izz></inertia></inertial></link><joint name="neck" type="fixed">
  <parent>base_link</parent><child>head</child></joint><plugin name="p"
  filename="libgazebo_ros_planar_force_move.so"><useForceFeedback>true</useForceFeedback>
  <forceGainX>10000</forceGainX><forceGainY>10000</forceGainY>{}</plugin></model>"""


@pytest.mark.parametrize(("link", "tips"), [("base_link", False), ("head", True)])
def test_the_force_acts_at_the_named_link(make, link, tips):
    """Friction of m g at the ground and the force at 1 m exceed the weight at 0.15 m."""
    world = make.world()
    world.session.spawn(make.sdf(LOW.format(f"<appliedForceLink>{link}</appliedForceLink>")))
    world.publish("/cmd_vel", linear_x=0.3)
    world.run(2.0)
    assert (abs(world.model("base").pose.rpy[1]) > 0.3) == tips
