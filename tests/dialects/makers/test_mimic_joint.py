"""Joints that mimic other joints."""

import pytest
from tests.devices.bodies import arm


def test_a_mimic_joint_follows(make):
    plugin = """<plugin name="m" filename="libroboticsgroup_upatras_gazebo_mimic_joint_plugin.so">
      <joint>turn</joint><mimicJoint>wrist</mimicJoint><multiplier>-0.5</multiplier>
      <offset>0.2</offset></plugin>"""
    world = make.world(make.sdf(arm(plugin, "revolute")), ground=None)
    world.session.simulation.data.joint("arm::turn").qvel[0] = 1.0
    world.run(1.0)
    simulation = world.session.simulation
    leader = simulation.joint_position("arm", "turn")
    assert abs(leader) > 0.1
    assert simulation.joint_position("arm", "wrist") == pytest.approx(0.2 - leader / 2, abs=0.01)
