"""Topics after time was set: they contain no messages of another future."""

import numpy as np
import pytest


@pytest.fixture
def world(make, rosbots):
    world = make.world()
    world.spawn(rosbots, z=0.1)
    return world


def test_a_restored_topic_ends_at_the_restored_time(world):
    clock = world.topic("/clock")
    world.run(1)
    state, before, count = world.save(), clock.times(), clock.count
    world.run(1)
    world.restore(state)
    assert clock.times() == before and clock.latest_time <= world.time == 1.0
    assert clock.latest.clock.sec == 1
    assert clock.count > count
    world.run(1)
    assert (np.diff(clock.times()) > 0).all() and clock.latest_time == 2.0


@pytest.mark.parametrize("how", ["method", "callback"])
def test_a_reset_topic_is_empty(world, how):
    clock = world.topic("/clock")
    world.run(1)
    if how == "method":
        world.reset()
        assert clock.latest is None and clock.latest_time is None and clock.times() == []
        world.run(0.1)
    else:
        world.on(1.1, world.reset)
        world.run(0.2)
        world.run(0.1)
    assert clock.times()[0] <= 0.01 and (np.diff(clock.times()) > 0).all()


def test_a_latched_message_stays_after_a_reset(world):
    text = world.topic("/robot_description")
    world.run(0.1)
    latest = text.latest
    assert latest is not None
    world.reset()
    assert text.latest is latest and text.latest_time == 0.0


def test_a_closed_topic_keeps_its_messages(world):
    clock = world.topic("/clock")
    world.run(1)
    clock.close()
    world.reset()
    assert clock.latest_time == 1.0
