"""A saved world continues bit for bit: a robot for each plugin, and all robots of the corpus."""

import multiprocessing
import os
from concurrent.futures import ProcessPoolExecutor
from pathlib import Path

import pytest
from tests.golden.adapter import robots_in
from tests.saving.journeys import ROBOTS, Journey, continued

import cartwheel as cw

CORPUS = Path(os.environ.get("CARTWHEEL_CORPUS", ROBOTS.parents[3] / "shared" / "corpus"))
CONNECTED = {
    "ArduPilotPlugin.urdf": ["Conversation"],
    "libgazebo_mavlink_interface.urdf": ["Px4Link"],
}
"""Robots with a connection to a flight controller, which is not saved, and its class."""

SLOW, SHORT = {"large_model.urdf.xacro", "turtlebot3_waffle.urdf.xacro"}, (0.35, 0.1)
"""Robots with many links or large images, and the times for which they are simulated, s."""


@pytest.fixture(scope="module")
def elsewhere():
    """Another process, which has not been forked from this one."""
    context = multiprocessing.get_context("spawn")
    with ProcessPoolExecutor(1, mp_context=context) as pool:
        yield lambda *call: pool.submit(*call).result(120)


def compare(file, elsewhere, times=(1.0, 0.5)):
    journey = Journey(file)
    with journey.world as world:
        journey.set_out(times[0])
        state = world.save()
        expected = journey.go_on(times[1])
        for _ in range(2):
            world.restore(state)
            assert journey.go_on(times[1]) == expected
    # The world is closed, because two worlds cannot use the same port.
    assert elsewhere(continued, file, state, journey.height, times[1]) == expected
    return [each for each in state.left_out if not each.startswith("subscriber")]


NAMES = sorted(each.name for each in ROBOTS.iterdir() if each.suffix in (".urdf", ".world"))


@pytest.mark.parametrize("name", NAMES)
def test_each_plugin_continues(name, elsewhere):
    left_out = compare(ROBOTS / name, elsewhere)
    assert [each.rpartition("(")[2].rstrip(")") for each in left_out] == CONNECTED.get(name, [])


@pytest.mark.parametrize("name", NAMES)
def test_a_reset_plugin_is_that_of_a_new_world(name):
    new = Journey(ROBOTS / name, seed=3)
    with new.world:
        expected = new.go_on()
    used = Journey(ROBOTS / name, seed=4)
    with used.world as world:
        used.set_out()
        world.reset(seed=3)
        assert used.go_on() == expected


@pytest.mark.skipif(not CORPUS.is_dir(), reason=f"{CORPUS} does not exist")
@pytest.mark.parametrize("file", robots_in(CORPUS) if CORPUS.is_dir() else [], ids=str)
def test_each_robot_of_the_corpus_continues(file, elsewhere):
    try:
        assert compare(file, elsewhere, SHORT if file.name in SLOW else (1.0, 0.5)) == []
    except cw.CartwheelError as error:
        if error.code.name in ("state-mismatch", "simulation-diverged"):
            raise
        pytest.skip(f"the robot cannot be simulated: {error.code.name}")
