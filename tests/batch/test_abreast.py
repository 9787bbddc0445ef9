"""Worlds that run abreast are as if each ran alone."""

from __future__ import annotations

import signal

import numpy as np
import pytest

import cartwheel as cw
from cartwheel.batch.abreast import run_abreast
from cartwheel.errors import SimulationError
from cartwheel.messages import to_dict

TOPIC = "/part2_cmr/cmd_vel"


@pytest.fixture(scope="module")
def built():
    return cw.build("empty", ["rosbots.xacro"])


@pytest.fixture
def worlds(built):
    made = [built.world(seed=seed) for seed in range(3)]
    yield made
    for each in made:
        each.close()


def state(world):
    data = world.session.simulation.data
    return np.concatenate([data.qpos, data.qvel, data.qacc_warmstart, [data.time]])


def test_the_states_and_messages_are_those_of_single_runs(built, worlds):
    def drive(made, index, run):
        imu = [each.topic("/imu/data") for each in made]
        for number, each in zip(index, made, strict=True):
            each.publish(TOPIC, linear_x=0.1 * number, angular_z=0.5)
        for seconds in (0.3, 0.0, 0.123, 0.1):
            run(made, seconds)
        return [state(each) for each in made], [each.history() for each in imu]

    states, messages = drive(worlds, range(3), run_abreast)
    for index in range(3):
        with built.world(seed=index) as world:
            alone = drive([world], [index], lambda made, seconds: made[0].run(seconds))
            assert np.array_equal(states[index], alone[0][0])
            assert len(messages[index]) == len(alone[1][0]) > 10
            assert to_dict(messages[index][-1]) == to_dict(alone[1][0][-1])


def test_an_error_in_one_world_leaves_the_others_complete(worlds):
    def fail(_):
        raise ValueError("of the callback")

    worlds[1].subscribe("/odom", fail)
    with pytest.raises(ValueError, match="of the callback"):
        run_abreast(worlds, 0.2)
    assert [worlds[0].time, worlds[2].time] == [0.2, 0.2]
    assert worlds[1].time < 0.2
    for each in worlds[::2]:
        each.run(0.1)


def test_closed_worlds_and_nested_runs_are_errors(worlds):
    worlds[2].close()
    with pytest.raises(SimulationError, match="closed"):
        run_abreast(worlds, 0.1)
    assert worlds[0].time == worlds[1].time == 0.1
    failed = []

    def nested(_):
        try:
            run_abreast(worlds[:1], 0.1)
        except SimulationError as error:
            failed.append(str(error))

    worlds[0].subscribe("/odom", nested)
    run_abreast(worlds[:2], 0.05)
    assert failed
    assert worlds[0].time == pytest.approx(0.15)


def test_ctrl_c_stops_all_worlds_after_the_step(worlds):
    # Processes in the background ignore Ctrl-C.
    before = signal.signal(signal.SIGINT, signal.default_int_handler)
    try:
        worlds[0].on(0.1, lambda: signal.raise_signal(signal.SIGINT))
        with pytest.raises(KeyboardInterrupt):
            run_abreast(worlds, 10.0)
        assert signal.getsignal(signal.SIGINT) is signal.default_int_handler
    finally:
        signal.signal(signal.SIGINT, before)
    assert all(0.1 <= each.time < 1.0 for each in worlds)
    run_abreast(worlds, 0.1)


def test_worlds_with_a_pace_run_too(worlds):
    worlds[1].pace = 100.0
    run_abreast(worlds, 0.1)
    assert [each.time for each in worlds] == [0.1, 0.1, 0.1]
    with pytest.raises(cw.CartwheelError, match="duration"):
        run_abreast(worlds, -1.0)
