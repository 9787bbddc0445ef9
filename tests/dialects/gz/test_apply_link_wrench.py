"""Commanded forces on any link in the world."""

import contextlib

import pytest
from tests.coded import coded

from cartwheel import World
from cartwheel.codes import devices, running

MODEL, LINK = 2, 3
BODY = (
    '<model name="{name}"><pose>{x} 0 1 0 0 0</pose><link name="a"><inertial><mass>2</mass>'
    "<inertia><ixx>0.5</ixx><iyy>0.5</iyy><izz>0.5</izz></inertia></inertial></link>"
    '<link name="b"><pose>0 1 0 0 0 0</pose><inertial><mass>1</mass></inertial></link></model>'
)


@pytest.fixture
def space():
    with contextlib.ExitStack() as started:

        def make(inside=""):
            text = (
                '<sdf version="1.9"><world name="space"><gravity>0 0 0</gravity>'
                '<plugin name="w" filename="gz-sim-apply-link-wrench-system">'
                f"{inside}</plugin>{BODY.format(name='one', x=0)}{BODY.format(name='two', x=9)}"
                "</world></sdf>"
            )
            return started.enter_context(World(text))

        yield make


def push(world, topic, name, kind, **force):
    wrench = {"force": force}
    world.publish(topic, {"entity": {"name": name, "type": kind}, "wrench": wrench})


def speed(world, model, link="a"):
    return world.model(model).link(link).velocity.linear


def test_a_wrench_acts_for_one_step_on_the_named_model(space):
    world = space()
    step = world.step_size
    push(world, "/world/space/wrench", "one", MODEL, x=10.0)
    world.run(0.1)
    assert speed(world, "one") == pytest.approx((10.0 / 2.0 * step, 0.0, 0.0), abs=1e-9)
    assert speed(world, "two") == (0.0, 0.0, 0.0)
    assert speed(world, "one", "b") == (0.0, 0.0, 0.0)


def test_a_persistent_wrench_acts_until_it_is_cleared(space):
    world = space()
    push(world, "/world/space/wrench/persistent", "two::b", LINK, y=3.0)
    world.run(0.2)
    assert speed(world, "two", "b") == pytest.approx((0.0, 3.0 * 0.2, 0.0), rel=0.03)
    world.publish("/world/space/wrench/clear", {"name": "two::b", "type": LINK})
    before = speed(world, "two", "b")[1]
    world.run(0.2)
    assert speed(world, "two", "b")[1] - before == pytest.approx(0.0, abs=0.02)
    assert speed(world, "two") == (0.0, 0.0, 0.0)


WRENCH = (
    "<persistent><entity_name>{}</entity_name><entity_type>{}</entity_type><force>4 0 0</force>"
    "<torque>0 0 0.5</torque></persistent>"
)


def test_stated_wrenches_act_again_after_a_reset(space):
    world = space(WRENCH.format("one", "model"))
    for _ in range(2):
        world.run(0.5)
        one = world.model("one").link("a").velocity
        assert one.linear == pytest.approx((4.0 / 2.0 * 0.5, 0.0, 0.0), rel=0.02)
        assert one.angular == pytest.approx((0.0, 0.0, 0.5 / 0.5 * 0.5), rel=0.02)
        world.reset()


def test_a_wrong_type_is_reported(space):
    world = space(WRENCH.format("one", "world"))
    (reported,) = coded(world, running.PLUGIN_LEFT_OUT)
    assert reported.values["cause"] == devices.PLUGIN_PARAMETER_INVALID.number
    world.run(0.1)
    assert speed(world, "one") == (0.0, 0.0, 0.0)
