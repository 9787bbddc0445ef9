"""Models that a restored state adds or removes, and what is reported about them."""

import pickle

import pytest

import cartwheel as cw

COMMANDS = "/part2_cmr/cmd_vel"


def test_a_state_from_before_the_first_robot() -> None:
    with cw.World("empty") as world:
        before = world.save()
        world.spawn("rosbots.xacro")
        with_cart = world.save()
        for state in (before, pickle.loads(pickle.dumps(before))):
            world.restore(state)
            assert world.models == ("ground_plane",)
            world.run(0.1)
            world.restore(with_cart)
            world.publish(COMMANDS, linear_x=0.5)
            world.run(1.0)
            assert world.model("rosbots").pose.x == pytest.approx(0.375, abs=0.01)


def test_diagnostics_are_those_of_a_spawn_and_reported_once() -> None:
    with cw.World("empty") as world:
        world.spawn("rosbots.xacro")
        state = world.save()
        expected = world.diagnostics
        assert expected
        world.model("rosbots").delete()
        world.restore(state)
        world.restore(state)
        assert world.diagnostics == expected
    with cw.World("empty") as other:
        for _ in range(2):
            other.restore(pickle.loads(pickle.dumps(state)))
            assert other.diagnostics == expected
