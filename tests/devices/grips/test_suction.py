"""Suction cups."""

import math

import pytest
from tests.devices.grips.hands import SIDE, Hand

CUP = """<plugin name="v" filename="libgazebo_ros_vacuum_gripper.so">{}</plugin>"""
ROS1 = (
    "<robotNamespace>cup</robotNamespace><bodyName>palm</bodyName><topicName>grasping</topicName>"
)
ROS2 = """<ros><namespace>cup</namespace></ros><link_name>palm</link_name>
  <max_distance>{}</max_distance>{}"""


class Cup(Hand):
    """The palm alone, 3 cm above the middle of a cube; the lift's zero is at 0.2 m."""

    def __init__(self, make, plugin, **more):
        super().__init__(make, plugin, sides=(), **more)
        self.lift(-0.14, speed=-0.1)


def reported(world, seconds=0.02):
    box = world.mailbox("/cup/grasping")
    world.run(seconds)
    return {message.data for message in box.drain()}


def test_a_cup_that_is_on_carries_what_it_was_put_on(make, ask):
    hand = Cup(make, CUP.format(ROS1))
    assert reported(hand.world) == {False}
    ask(hand.world, "/cup/on")
    hand.lift(0.1)
    assert hand.cube.z == pytest.approx(SIDE / 2 + 0.1, abs=2e-3)
    assert hand.cube.yaw == pytest.approx(0.0, abs=1e-3)
    assert reported(hand.world) == {True}
    ask(hand.world, "/cup/off")
    # It falls 10 cm, and a while on is still there.
    hand.world.run(math.sqrt(2 * 0.1 / 9.8) + 0.3)
    assert hand.cube.z == pytest.approx(SIDE / 2, abs=2e-3)
    assert reported(hand.world) == {False}


def test_what_is_beyond_reach_is_taken_when_the_cup_comes_near(make, ask):
    hand = Cup(make, CUP.format(ROS1))
    hand.lift(0.05)
    ask(hand.world, "/cup/on")
    hand.world.run(0.2)
    assert reported(hand.world) == {False}
    hand.lift(-0.035, speed=-0.1)
    assert reported(hand.world) == {True}


def test_ros_2_s_cup_has_one_switch_a_reach_and_exceptions(make, ask):
    hand = Cup(make, CUP.format(ROS2.format(0.02, "")))
    answer = ask(hand.world, "/cup/switch", data=True)
    assert answer.success
    assert not ask(hand.world, "/cup/switch", data=True).success
    # 3 cm away, and it reaches 2.
    assert reported(hand.world) == {False}
    spared = Cup(make, CUP.format(ROS2.format(0.04, "<fixed>cube</fixed>")))
    ask(spared.world, "/cup/switch", data=True)
    assert reported(spared.world) == {False}
    taken = Cup(make, CUP.format(ROS2.format(0.04, "<fixed>other</fixed>")))
    ask(taken.world, "/cup/switch", data=True)
    assert reported(taken.world) == {True}


def test_a_reset_switches_the_cup_off(make, ask):
    hand = Cup(make, CUP.format(ROS1))
    ask(hand.world, "/cup/on")
    hand.world.reset()
    assert reported(hand.world) == {False}
