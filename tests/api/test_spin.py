"""Runs in real time, which end in many ways."""

import os
import queue
import signal
import threading
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
from tests.bridges.ros1_peers import wait_for
from tests.coded import raises

import cartwheel as cw
from cartwheel.codes.world import SIMULATION_CLOSED
from cartwheel.control import ControlClient, running

pytestmark = pytest.mark.usefixtures("tidy")


def until_running(world: cw.World) -> None:
    start = world.time
    wait_for(lambda: world.time > start, "time to pass")


@pytest.fixture(autouse=True)
def default_sigint() -> Iterator[None]:
    """SIGINT has its default handler, also where the tests were started in the background."""
    before = signal.signal(signal.SIGINT, signal.default_int_handler)
    yield
    signal.signal(signal.SIGINT, before)


def test_it_lasts_as_long_as_its_time() -> None:
    with cw.World("empty") as world:
        start = time.perf_counter()
        world.spin(0.3)
        assert world.time == 0.3
        # Real time: never faster. On a busy machine, slower.
        assert time.perf_counter() - start >= 0.29
        start = time.perf_counter()
        world.spin(0.4, speed=2.0)
        assert world.time == 0.7
        assert time.perf_counter() - start >= 0.19
        world.run(0.2, speed=2.0)
        world.run(1.0)
        assert world.time == pytest.approx(1.9)


def test_it_is_stopped_from_another_thread_and_goes_on(on_thread: Any) -> None:
    with cw.World("empty") as world:

        def stop() -> None:
            until_running(world)
            world.stop()

        for _ in range(2):
            before = world.time
            on_thread(stop)
            world.spin()
            assert world.time > before
        before = world.time
        world.stop()  # nothing runs
        world.run(0.5)
        assert world.time == pytest.approx(before + 0.5)


def test_a_callback_stops_it() -> None:
    with cw.World("empty") as world:
        world.subscribe("/clock", lambda message: message.clock.nanosec and world.stop())
        world.spin()
        assert 0 < world.time < 1
        before = world.time
        world.run(1.0)
        assert before < world.time < before + 1.0


def test_other_threads_use_the_world_meanwhile(on_thread: Any) -> None:
    with cw.World("empty") as world:
        cart = world.spawn("rosbots.xacro")
        found: queue.Queue[Any] = queue.Queue()

        def use() -> None:
            try:
                until_running(world)
                cart.publish("/part2_cmr/cmd_vel", linear_x=0.5)
                wait_for(lambda: cart.pose.x > 0.05, "the cart to move")
                post = world.spawn("object.urdf", name="thing", y=9.0)
                found.put(post.pose.y)
                cart.delete()
                with world.lock:
                    before = world.time
                    world.session.simulation.refresh()
                    found.put(world.time - before)
            finally:
                world.stop()

        on_thread(use)
        world.spin(speed=None)
        assert found.get(timeout=60) == pytest.approx(9.0, abs=0.01)
        assert found.get(timeout=60) == 0.0
        assert world.models == ("ground_plane", "thing")


def test_a_run_of_another_thread_does_not_change_the_speed(on_thread: Any) -> None:
    with cw.World("empty") as world:
        world.serve_commands()

        def run() -> None:
            until_running(world)
            world.run(0.2)

        on_thread(run)
        start = time.perf_counter()
        world.spin(1.0)
        assert world.time == pytest.approx(1.0, abs=0.2)
        # The other 0.8 s take at least as long in real time.
        assert time.perf_counter() - start >= 0.75


def test_another_thread_closes_the_world(tmp_path: Path, on_thread: Any) -> None:
    file = tmp_path / "a.mcap"
    world = cw.World("empty", record=file)
    closed = threading.Event()

    def close() -> None:
        until_running(world)
        world.close()
        closed.set()

    thread = on_thread(close)
    world.spin()
    thread.join(60)
    assert closed.is_set()
    assert file.stat().st_size > 0
    with raises(SIMULATION_CLOSED):
        world.spin(1.0)


@pytest.mark.parametrize("seconds", [None, 3600.0])
def test_ctrl_c_ends_it_after_a_step(seconds: float | None, on_thread: Any) -> None:
    with cw.World("empty") as world:
        assert signal.getsignal(signal.SIGINT) is signal.default_int_handler

        def press() -> None:
            until_running(world)
            os.kill(os.getpid(), signal.SIGINT)

        on_thread(press)
        if seconds is None:
            world.spin()
        else:
            with pytest.raises(KeyboardInterrupt):
                world.spin(seconds)
        assert signal.getsignal(signal.SIGINT) is signal.default_int_handler
        before = world.time
        world.run(0.1)
        assert world.time == pytest.approx(before + 0.1)


@pytest.mark.parametrize("connected", [False, True])
def test_ctrl_c_ends_a_run_after_a_step(connected: bool) -> None:
    completed: list[float] = []
    with cw.World("empty") as world:
        if connected:
            world.serve_commands()

        def press(_: Any) -> None:
            if not completed:
                signal.raise_signal(signal.SIGINT)
            completed.append(world.time)

        world.subscribe("/clock", press)
        with pytest.raises(KeyboardInterrupt):
            world.run(1000.0)
        assert len(completed) == 1
        assert signal.getsignal(signal.SIGINT) is signal.default_int_handler
        before = world.time
        world.run(0.1)
        assert world.time == pytest.approx(before + 0.1)


def test_a_program_with_its_own_handler_keeps_it(on_thread: Any) -> None:
    pressed: list[int] = []
    with cw.World("empty") as world:

        def own(number: int, _: Any) -> None:
            pressed.append(number)
            world.stop()

        before = signal.signal(signal.SIGINT, own)
        try:

            def press() -> None:
                until_running(world)
                os.kill(os.getpid(), signal.SIGINT)

            on_thread(press)
            world.spin()
        finally:
            signal.signal(signal.SIGINT, before)
    assert pressed == [signal.SIGINT]


def test_clients_command_it(on_thread: Any) -> None:
    with cw.World("empty") as world:
        world.serve_commands()
        states: queue.Queue[Any] = queue.Queue()

        def command() -> None:
            until_running(world)
            with ControlClient(running()[0]) as client:
                states.put(client.request("status")["state"])
                states.put(client.request("pause")["state"])
                states.put(client.request("step", count=3)["state"])
                states.put(client.request("resume")["state"])
            world.stop()

        on_thread(command)
        world.spin()
        assert [states.get(timeout=60) for _ in range(4)] == [
            "running",
            "paused",
            "paused",
            "running",
        ]
