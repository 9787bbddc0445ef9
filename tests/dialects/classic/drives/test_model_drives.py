"""Drives of Gazebo Classic that measure their wheels: one pair, and four wheels."""

import math

import pytest
from tests.coded import raises
from tests.devices.drives.carts import FOUR, RADIUS, cart_sdf

from cartwheel.codes import devices
from cartwheel.description import load_text
from cartwheel.errors import PluginError, UnknownNameError

PAIR = {"left": (0.0, 0.15), "right": (0.0, -0.15)}
BALLS = ((0.2, 0.0), (-0.2, 0.0))
TOPIC = "/cart/cmd_vel"


def plugin(file, tags=""):
    return f'<plugin name="drive" filename="lib{file}.so">{tags}</plugin>'


def pair(tags="", *, names="left right"):
    left, right = names.split()
    tags += f"<left_joint>{left}_joint</left_joint><right_joint>{right}_joint</right_joint>"
    return cart_sdf(PAIR, plugin("DiffDrivePlugin", tags), balls=BALLS)


def four(tags=None):
    """A cart with four wheels. Without tags, their joints have the default names."""
    if tags is not None:
        return cart_sdf(FOUR, plugin("SkidSteerDrivePlugin", tags))
    text = cart_sdf(FOUR, plugin("SkidSteerDrivePlugin"))
    for name in FOUR:
        text = text.replace(f'"{name}_joint"', f'"{name}"')
    return text


NAMED = "".join(f"<{name}>{name}_joint</{name}>" for name in FOUR)


class Cart:
    def __init__(self, make, model):
        self.world = make.world()
        text = f'<sdf version="1.7">{model}</sdf>'
        self.model = self.world.spawn(load_text(text, file="cart.sdf"))
        self.world.run(0.3)

    def driven(self, forward=0.0, turn=0.0):
        """The distance in a second, and the yaw rate, that a command results in."""
        self.world.publish(TOPIC, linear_x=forward, angular_z=turn)
        self.world.run(1.0)
        before = self.model.pose
        self.world.run(1.0)
        after = self.model.pose
        x, y = after.x - before.x, after.y - before.y
        middle = (before.yaw + after.yaw) / 2
        ahead = math.cos(middle) * x + math.sin(middle) * y
        return ahead, math.remainder(after.yaw - before.yaw, 2 * math.pi)


@pytest.mark.parametrize("text", [pair(), four(), four(NAMED)])
@pytest.mark.parametrize("speed", [0.5, -0.5])
def test_it_drives_straight(make, text, speed):
    forward, turn = Cart(make, text).driven(speed)
    assert forward == pytest.approx(speed, rel=0.01)
    assert turn == pytest.approx(0.0, abs=0.01)


@pytest.mark.parametrize("rate", [0.8, -0.8])
def test_a_positive_rate_turns_a_pair_of_wheels_to_the_left(make, rate):
    forward, turn = Cart(make, pair()).driven(turn=rate)
    assert turn == pytest.approx(rate, rel=0.03)
    assert forward == pytest.approx(0.0, abs=0.01)


def test_four_wheels_slide_less_than_their_double_speeds_turn_them(make):
    """What sliding leaves of twice the rate; see the test of the ROS plugin for skid steering."""
    length, width, wanted = 0.4, 0.3, 0.5
    _, turn = Cart(make, four()).driven(turn=wanted)
    assert turn == pytest.approx(2 * wanted * width**2 / (width**2 + length**2), rel=0.1)


def test_the_radius_is_that_of_the_wheels(make):
    """Rims of spheres with twice the radius have the commanded speed, too."""
    disc = f"<cylinder><radius>{RADIUS}</radius><length>0.04</length></cylinder>"
    ball = f"<sphere><radius>{2 * RADIUS}</radius></sphere>"
    text = cart_sdf(FOUR, plugin("SkidSteerDrivePlugin", NAMED)).replace(disc, ball)
    made = Cart(make, text)
    made.world.run(0.5)
    assert made.driven(0.5)[0] == pytest.approx(0.5, rel=0.02)


@pytest.mark.parametrize("tag", ["torque", "MaxForce", "max_force"])
def test_neither_the_torque_nor_an_effort_limit_holds_it_back(make, tag):
    weak = f"<{tag}>1e-6</{tag}>"
    text = pair(weak) if tag == "torque" else four(NAMED + weak)
    text = text.replace("</xyz></axis>", "</xyz><limit><effort>1e-6</effort></limit></axis>")
    assert Cart(make, text).driven(0.5)[0] == pytest.approx(0.5, rel=0.01)


def test_after_a_reset_it_stands(make):
    made = Cart(make, pair())
    made.driven(0.5)
    made.world.reset()
    made.world.run(1.0)
    assert made.model.pose.x == pytest.approx(0.0, abs=1e-3)


def test_it_publishes_nothing(make):
    made = Cart(make, pair())
    topics = {topic.name for topic in made.world.graph.topics()}
    assert TOPIC in topics
    assert not {"/odom", "/tf", "/cart/odom"} & topics


@pytest.mark.parametrize("missing", ["left_joint", "right_joint"])
def test_a_pair_requires_both_joints(make, missing):
    text = pair().replace(f"<{missing}>", "<other>").replace(f"</{missing}>", "</other>")
    with raises(devices.PLUGIN_PARAMETER_MISSING, PluginError, parameter=missing):
        Cart(make, text)


def test_an_unknown_joint_is_named(make):
    with pytest.raises(UnknownNameError, match='joint "none_joint"'):
        Cart(make, pair(names="none right"))
    with pytest.raises(UnknownNameError, match='joint "left_front"'):
        Cart(make, four(""))


def test_a_wheel_without_a_collision_is_refused(make):
    head, _, tail = pair().partition('<link name="left_wheel">')
    wheel, end, tail = tail.partition("</link>")
    wheel = wheel.partition("<collision")[0]
    with raises(devices.PLUGIN_PARAMETER_INVALID, PluginError, parameter="joint"):
        Cart(make, f'{head}<link name="left_wheel">{wheel}{end}{tail}')


def test_joints_at_one_place_are_refused(make):
    text = pair(names="left left")
    with raises(devices.PLUGIN_PARAMETER_INVALID, PluginError, parameter="separation"):
        Cart(make, text)
