"""Published joint states, compared with the state of the simulation."""

import numpy as np
import pytest
from tests.coded import coded
from tests.devices.bodies import arm

from cartwheel.codes import running
from cartwheel.errors import PluginError, UnknownNameError


def joint_states(tags, name="libgazebo_ros_joint_state_publisher.so"):
    return f'<plugin name="s" filename="{name}">{tags}</plugin>'


def test_classic_joint_states_are_published_in_the_models_namespace(make, read):
    plugin = joint_states("<jointName>wrist, turn</jointName><updateRate>50</updateRate>")
    world = make.world(make.sdf(arm(plugin, "revolute")), ground=None)
    world.session.simulation.data.joint("arm::turn").qvel[0] = 1.0
    messages = read(world, "/arm/joint_states", 1.0)
    assert len(messages) == 51
    assert messages[0].name == ["wrist", "turn"]
    data = world.session.simulation.data
    last = messages[-1]
    assert last.position[1] == pytest.approx(data.joint("arm::turn").qpos[0], abs=1e-9)
    assert last.velocity[1] == pytest.approx(data.joint("arm::turn").qvel[0], abs=1e-9)
    assert len(last.effort) == 0


def test_ros2_joint_states_of_all_movable_joints(make, read):
    plugin = joint_states("<ros><namespace>/r</namespace></ros>")
    world = make.world(make.sdf(arm(plugin)), ground=None)
    messages = read(world, "/r/joint_states", 1.0)
    assert len(messages) == 101
    assert messages[0].name == ["turn"]


def test_gz_joint_states_contain_efforts(make, cart, read):
    """A cart at constant speed needs no torque."""
    plugin = """<plugin name="d" filename="gz-sim-diff-drive-system">
      <left_joint>left_joint</left_joint><right_joint>right_joint</right_joint>
      <wheel_separation>0.3</wheel_separation><wheel_radius>0.1</wheel_radius></plugin>
      <plugin name="s" filename="gz-sim-joint-state-publisher-system">
      <joint_name>left_joint</joint_name><update_rate>50</update_rate></plugin>"""
    wheels = {"left": (0.0, 0.15), "right": (0.0, -0.15)}
    model = cart(wheels, plugin, balls=((0.15, 0.0), (-0.15, 0.0)))
    world = make.world(model)
    world.run(0.5)
    world.publish("/model/cart/cmd_vel", linear_x=0.5)
    world.run(1.0)
    messages = read(world, "/world/test/model/cart/joint_state", 1.0)
    assert len(messages) == 50
    assert messages[-1].velocity[0] == pytest.approx(5.0, rel=0.01)
    assert abs(np.mean([m.effort[0] for m in messages])) < 0.05


def test_an_unknown_joint_is_reported_with_the_similar_name(make):
    plugin = joint_states("<jointName>trun</jointName>")
    with pytest.raises(UnknownNameError) as caught:
        make.world(make.sdf(arm(plugin)), ground=None)
    assert (caught.value.values["name"], caught.value.values["meant"]) == ("trun", "turn")


def test_a_fixed_joint_is_reported(make, read):
    plugin = joint_states("<jointName>turn,wrist</jointName>")
    world = make.world(make.sdf(arm(plugin)), ground=None)
    assert read(world, "/arm/joint_states", 0.1)[0].name == ["turn"]
    assert coded(world, running.JOINT_WITHOUT_STATE, joint="wrist")


@pytest.mark.parametrize("tags", ["<jointName>turn,wrist</jointName>", ""])
def test_the_state_of_a_universal_joint_is_that_of_its_first_axis(make, read, tags):
    world = make.world(make.sdf(arm(joint_states(tags), "universal")), ground=None)
    world.session.simulation.data.joint("arm::wrist").qvel[0] = 1.0
    last = read(world, "/arm/joint_states", 0.1)[-1]
    assert sorted(last.name) == ["turn", "wrist"]
    wrist = world.session.simulation.data.joint("arm::wrist")
    index = last.name.index("wrist")
    assert last.position[index] == pytest.approx(wrist.qpos[0], abs=1e-9)
    assert last.velocity[index] == pytest.approx(wrist.qvel[0], abs=1e-9)
    assert abs(last.position[index]) > 0.01
    assert not coded(world, running.JOINT_WITHOUT_STATE, joint="wrist")


def test_a_joint_that_has_no_single_position_is_reported_and_the_others_are_published(make, read):
    plugin = joint_states("<jointName>turn,wrist</jointName>")
    world = make.world(make.sdf(arm(plugin, "ball")), ground=None)
    assert read(world, "/arm/joint_states", 0.1)[0].name == ["turn"]
    (reported,) = coded(world, running.JOINT_WITHOUT_STATE, joint="wrist")
    assert reported.severity == "warning"


def test_a_negative_rate_is_reported_at_its_tag(make):
    with pytest.raises(PluginError) as caught:
        make.world(make.sdf(arm(joint_states("<updateRate>-1</updateRate>"))), ground=None)
    assert caught.value.values["parameter"] == "updateRate"
    assert caught.value.origin is not None
