"""The force on a foot, in its link's axes; and the differential of two rockers."""

import math

import numpy as np
import pytest

from cartwheel.codes import devices
from cartwheel.errors import PluginError

G = 9.8
MASS = 4.0
TILT = 0.3


def foot(make):
    """A leaning leg that ends in a ball, on a post that only goes up and down."""
    return make.sdf(f"""<model name="dog"><pose>0 0 0.52 0 0 0</pose>
      <link name="trunk"><inertial><mass>{MASS - 1}</mass></inertial></link>
      <joint name="rail" type="prismatic"><parent>world</parent><child>trunk</child>
        <axis><xyz>0 0 1</xyz></axis></joint>
      <link name="calf"><pose>0 0 0 0 {TILT} 0</pose><inertial><mass>1</mass></inertial>
        <collision name="ball"><pose>0 0 -0.5 0 0 0</pose><geometry><sphere>
          <radius>0.02</radius></sphere></geometry></collision>
        <sensor name="FR_foot_contact" type="contact"><update_rate>100</update_rate>
          <contact><collision>ball</collision></contact>
          <plugin name="c" filename="libunitreeFootContactPlugin.so"/></sensor></link>
      <joint name="knee" type="fixed"><parent>trunk</parent><child>calf</child></joint></model>""")


def test_a_foot_publishes_the_weight_on_it_in_its_own_axes(make, read):
    world = make.world(foot(make), ground=0.0)
    reported = read(world, "/visual/FR_foot_contact/the_force", 0.01)[-1]
    assert reported.wrench.force.z == 0
    world.run(3.0)
    reported = read(world, "/visual/FR_foot_contact/the_force", 1.0)
    assert len(reported) == 100
    force = reported[-1].wrench.force
    # Up in the world, seen from a link that leans forward about y.
    assert np.array([force.x, force.y, force.z]) == pytest.approx(
        [-MASS * G * math.sin(TILT), 0, MASS * G * math.cos(TILT)], abs=0.05
    )
    assert reported[-1].header.frame_id == "calf"


ROVER = """<model name="rover"><link name="base"><inertial><mass>1</mass></inertial></link>
  <joint name="bolt" type="fixed"><parent>world</parent><child>base</child></joint>
  <link name="left"><inertial><pose>0.2 0 0 0 0 0</pose><mass>1</mass></inertial></link>
  <link name="right"><inertial><pose>-0.1 0 0 0 0 0</pose><mass>1</mass></inertial></link>
  <joint name="L" type="revolute"><parent>base</parent><child>left</child>
    <axis><xyz>0 1 0</xyz><dynamics><damping>2</damping></dynamics></axis></joint>
  <joint name="R" type="revolute"><parent>base</parent><child>right</child>
    <axis><xyz>0 1 0</xyz><dynamics><damping>2</damping></dynamics></axis></joint>
  <plugin name="d" filename="libleo_gazebo_differential_plugin.so"><jointA>L</jointA>
    <jointB>{}</jointB><forceConstant>100</forceConstant></plugin></model>"""


def test_two_rockers_turn_alike(make):
    """The heavier side goes down, and takes the other one up with it, to where both hang."""
    world = make.world(make.sdf(ROVER.format("R")), ground=None)
    world.run(1.0)
    joints = [world.session.simulation.joint_position("rover", name) for name in "LR"]
    assert joints[0] > 0.1
    assert joints[1] == pytest.approx(joints[0], abs=1e-3)
    world.run(20.0)
    # 0.2 - 0.1 m of arm is left, which hangs straight down.
    joints = [world.session.simulation.joint_position("rover", name) for name in "LR"]
    assert joints == pytest.approx([math.pi / 2] * 2, abs=0.02)


def test_a_rocker_without_another_is_refused(make):
    with pytest.raises(PluginError) as caught:
        make.world().session.spawn(make.sdf(ROVER.format("L")))
    assert caught.value.code is devices.PLUGIN_PARAMETER_INVALID
