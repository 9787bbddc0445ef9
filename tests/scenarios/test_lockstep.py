"""Lockstep: the time at which commands take effect, and late commands."""

from __future__ import annotations

import os
import shutil
import sys
import threading
from pathlib import Path

import pytest

import cartwheel as cw
from cartwheel.api.exchange.lockstep import Lockstep
from cartwheel.codes.command import COMMAND_EXTRA
from cartwheel.messages import from_dict
from cartwheel.scenarios import Options, Runner, cases_of, digests, load_scenario

DRIVE = "/part2_cmr/cmd_vel"
TWIST = "geometry_msgs/msg/Twist"
FOLDER = Path(__file__).parents[2] / "examples" / "scenarios"


class Stack:
    """A stack under test in a thread: it commands a speed for each message of odometry."""

    def __init__(self, world: cw.World, *, every: int = 10, first: float = 0.0) -> None:
        self._graph, self._every, self._count = world.graph, every, 0
        self._first = first
        """Wall time until the first command, s."""
        self._timers: list[threading.Timer] = []
        self.silent = False
        world.subscribe("/odom", self._take)

    def _take(self, message) -> None:
        self._count += 1
        if self._count % self._every or self.silent:
            return
        speed = 0.5 - 0.2 * message.pose.pose.position.x
        twist = from_dict(TWIST, {"linear": {"x": speed}})
        delay = self._first if self._count == self._every else 0.001 * (self._count % 7)
        timer = threading.Timer(delay, lambda: self._graph.publish(DRIVE, TWIST, twist))
        self._timers.append(timer)
        timer.start()

    def join(self) -> None:
        """Waits until all commands are sent."""
        for timer in self._timers:
            timer.join()


def drive() -> tuple[list[float], int]:
    with cw.World("empty") as world:
        cart = world.spawn("rosbots.xacro")
        stack = Stack(world)
        lockstep = Lockstep(world, [DRIVE], period=0.1, wall_timeout=30.0)
        lockstep.start()
        xs = []
        for _ in range(20):
            lockstep.advance(0.1)
            xs.append(cart.pose.x)
        lockstep.close()
        stack.join()
        return xs, lockstep.late


def test_runs_in_lockstep_are_equal():
    first, late = drive()
    assert late == 0 and first[-1] > 0.3
    assert drive() == (first, 0)


def test_a_slow_first_command_is_not_taken_for_that_of_a_later_period():
    """Time advances meanwhile, so the stack sends two commands for the first period."""
    with cw.World("empty") as world:
        world.spawn("rosbots.xacro")
        stack = Stack(world, first=1.8)
        lockstep = Lockstep(world, [DRIVE], period=0.1, wall_timeout=30.0)
        lockstep.start()
        assert lockstep.extra == 1
        for _ in range(20):
            lockstep.advance(0.1)
        assert (lockstep.extra, lockstep.late) == (1, 0)
        lockstep.close()
        stack.join()


def test_time_continues_after_a_late_command():
    with cw.World("empty") as world:
        world.spawn("rosbots.xacro")
        stack = Stack(world)
        lockstep = Lockstep(world, [DRIVE], period=0.1, wall_timeout=0.2)
        lockstep.start()
        stack.silent = True
        begin = world.time
        lockstep.advance(0.5)
        assert world.time - begin == pytest.approx(0.5)
        assert lockstep.late >= 3 and list(lockstep.missing) == [DRIVE]
        lockstep.close()
        stack.join()


def test_two_commands_in_a_period_are_reported_once():
    with cw.World("empty") as world:
        world.spawn("rosbots.xacro")
        twist = from_dict(TWIST, {"linear": {"x": 0.5}})
        world.subscribe("/odom", lambda _: world.graph.publish(DRIVE, TWIST, twist))
        lockstep = Lockstep(world, [DRIVE], period=0.1, wall_timeout=30.0)
        lockstep.start()
        lockstep.advance(1.0)
        lockstep.close()
        (reported,) = (each for each in world.diagnostics if each.code is COMMAND_EXTRA)
        assert reported.values["topic"] == DRIVE and reported.values["count"] == 10


@pytest.mark.parametrize(
    "name",
    [
        pytest.param(
            "ros1",
            marks=pytest.mark.skipif(
                shutil.which("rostopic") is None, reason="ROS 1 is not installed"
            ),
        ),
        "ros2",
    ],
)
def test_an_example_drives_in_lockstep(name, tmp_path, monkeypatch):
    monkeypatch.setenv("PATH", f"{Path(sys.executable).parent}:{os.environ['PATH']}")
    scenario = load_scenario(FOLDER / f"lockstep_{name}.yaml")
    options = Options(folder=tmp_path, record="none", pictures="none", allow_launch=True)
    (case,) = digests(scenario, cases_of(scenario))
    # Other tests that run at the same time have other domains.
    runner = Runner([scenario], options, worker=os.getpid() % 80)
    outcomes = [runner.run(case) for _ in range(2)]
    assert [each.status for each in outcomes] == ["passed", "passed"], outcomes[0].findings
    first, second = (each.trajectories["cart"] for each in outcomes)
    # Times are rounded to 0.1 ms, and positions to 0.1 mm.
    assert first == second
