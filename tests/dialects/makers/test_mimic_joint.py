"""Joints that mimic other joints."""

import pytest
from tests.devices.bodies import arm

from cartwheel.errors import PluginError


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


@pytest.mark.parametrize(
    "mimic",
    [
        '<mimic joint="turn" multiplier="-0.5" offset="0.2" P="10" velocity="true"> wrist </mimic>',
        "<mimic>wrist<joint>turn</joint><multiplier>-0.5</multiplier><offset>0.2</offset></mimic>",
    ],
)
def test_a_list_of_mimic_joints_follows(make, mimic):
    plugin = f'<plugin name="m" filename="libmimic_plugin.so">{mimic}</plugin>'
    world = make.world(make.sdf(arm(plugin, "revolute")), ground=None)
    world.session.simulation.data.joint("arm::turn").qvel[0] = 1.0
    world.run(1.0)
    simulation = world.session.simulation
    leader = simulation.joint_position("arm", "turn")
    assert abs(leader) > 0.1
    assert simulation.joint_position("arm", "wrist") == pytest.approx(0.2 - leader / 2, abs=0.01)


@pytest.mark.parametrize(
    ("mimic", "values"),
    [
        ("<mimic>wrist</mimic>", {"parameter": "joint"}),
        ('<mimic joint="turn"/>', {"parameter": "joint"}),
        ('<mimic joint="wrist">wrist</mimic>', {"joint": "wrist"}),
        ('<mimic joint="turn" offset="far">wrist</mimic>', {"parameter": "offset"}),
    ],
)
def test_an_impossible_entry_of_a_list_is_refused(make, mimic, values):
    plugin = f'<plugin name="m" filename="libmimic_plugin.so">{mimic}</plugin>'
    with pytest.raises(PluginError) as caught:
        make.world(make.sdf(arm(plugin, "revolute")), ground=None)
    assert caught.value.values.items() >= values.items()


def test_the_differential_of_new_gazebo_couples_equally(make):
    plugin = """<plugin name="d" filename="libleo_gz_differential_plugin.so"><jointA>turn</jointA>
      <jointB>wrist</jointB><forceConstant>100</forceConstant></plugin>"""
    world = make.world(make.sdf(arm(plugin, "revolute")), ground=None)
    world.session.simulation.data.joint("arm::turn").qvel[0] = 1.0
    world.run(0.5)
    simulation = world.session.simulation
    leader = simulation.joint_position("arm", "turn")
    assert abs(leader) > 0.1
    assert simulation.joint_position("arm", "wrist") == pytest.approx(leader, abs=0.01)
