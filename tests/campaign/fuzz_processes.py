"""Kills of every process at random moments, and worlds used in every order, thread and fork.

An input is the seed of what is done.
"""

from __future__ import annotations

import contextlib
import os
import random
import signal
import threading
import time
import traceback
from collections.abc import Sequence
from pathlib import Path
from random import Random

from tests.campaign.live import PATIENCE_S, LiveRun, processes_of
from tests.campaign.target import FaultError, Target

from cartwheel.errors import CartwheelError

_MOST_PROCESSES = 12
_BALL = """<robot name="{}"><link name="b"><inertial><mass value="1"/><inertia ixx="1" iyy="1"
 izz="1" ixy="0" ixz="0" iyz="0"/></inertial><collision><geometry><sphere radius=".1"/></geometry>
</collision></link></robot>"""


def _kill(data: bytes) -> None:
    """Starts a run with all wires and a recording, and kills one of its processes."""
    dice = Random(data)
    name = dice.choice(("a.mcap", "a.bag", "a.db3", "a"))
    before = set(Path("/tmp").glob("cartwheel-*/*"))
    run = LiveRun("--record", name, "--record-topics", "/clock", "--overwrite")
    recording = Path(name).resolve()
    try:
        processes = run.processes()
        if len(processes) > _MOST_PROCESSES:
            raise FaultError(f"{len(processes)} processes")
        time.sleep(dice.random() * 2)
        victim = run.process.pid if dice.random() < 0.4 else dice.choice(processes)
        sent = dice.choice((signal.SIGKILL, signal.SIGKILL, signal.SIGTERM, signal.SIGINT))
        with contextlib.suppress(ProcessLookupError):
            os.kill(victim, sent)
        if victim != run.process.pid:
            # A bridge: the run goes on, or says why it ends.
            time.sleep(dice.random())
            if "Traceback" in run.output():
                raise FaultError(f"after {sent.name} to a bridge:\n{run.output()}")
            with contextlib.suppress(ProcessLookupError):
                run.process.send_signal(signal.SIGINT)
        _wait_for_end(run, f"{sent.name} to {victim} of {processes}")
        _check_recording(recording)
        left = set(Path("/tmp").glob("cartwheel-*/*")) - before
        own = [path for path in left if path.name.startswith(f"{run.process.pid}")]
        if own:
            raise FaultError(f"left behind: {own}")
    finally:
        run.close()


def _wait_for_end(run: LiveRun, what: str) -> None:
    deadline = time.monotonic() + PATIENCE_S
    while left := processes_of(run.mark):
        if run.process.poll() is None:
            with contextlib.suppress(Exception):
                run.process.wait(0.1)
        if time.monotonic() > deadline:
            commands = [Path(f"/proc/{pid}/cmdline").read_bytes()[-200:] for pid in left]
            raise FaultError(f"{what}: still there are {commands}\n{run.output()}")
        time.sleep(0.1)
    if "Traceback" in run.output():
        raise FaultError(f"{what}:\n{run.output()}")


def _check_recording(path: Path) -> None:
    from cartwheel.bridges.recording.opening import open_recording

    if not path.exists():
        raise FaultError("there is no recording")
    recording = open_recording(path)
    times = [message.time_ns for message in recording.messages()]
    if times != sorted(times):
        raise FaultError("the recording's times are out of order")
    recording.close()


def _world(data: bytes) -> None:
    """Spawns, deletes, runs, resets, and uses other threads and forks, in any order."""
    import cartwheel as cw
    from cartwheel.description import load_text

    dice = Random(data)
    balls = [load_text(_BALL.format(f"ball{i}")) for i in range(4)]
    robot = dice.random() < 0.3
    expected: dict[str, cw.Model] = {}
    with cw.World(dice.choice(("empty", "post", "shapes"))) as world:
        others = set(world.models)

        def act() -> None:
            kind = dice.random()
            if kind < 0.35:
                ball = dice.choice(balls)
                try:
                    made = world.spawn(ball, x=dice.uniform(-5, 5), y=dice.uniform(-5, 5), z=2.0)
                except CartwheelError:
                    assert ball.name in expected
                else:
                    assert ball.name not in expected
                    expected[ball.name] = made
            elif kind < 0.6 and expected:
                name = dice.choice(sorted(expected))
                expected.pop(name).delete()
            elif kind < 0.9:
                world.run(0.02)
            else:
                world.reset()
            assert set(world.models) - others == set(expected) | ({"rosbots"} if robot else set())

        if robot:
            world.spawn("rosbots.xacro")
        for _ in range(12):
            chance = dice.random()
            if chance < 0.15:
                _in_thread(act)
            elif chance < 0.2:
                _in_fork(lambda: world.run(0.02))
            else:
                act()


def _in_thread(act: object) -> None:
    failed: list[BaseException] = []

    def run() -> None:
        try:
            act()  # type: ignore[operator]
        except BaseException as error:  # noqa: BLE001 - handed to the one who waits
            failed.append(error)

    thread = threading.Thread(target=run)
    thread.start()
    thread.join()
    if failed:
        raise failed[0]


def _in_fork(act: object) -> None:
    child = os.fork()
    if child == 0:
        status = 0
        try:
            act()  # type: ignore[operator]
        except CartwheelError:
            pass
        except BaseException:  # noqa: BLE001 - printed, which is a finding
            traceback.print_exc()
            status = 1
        finally:
            os._exit(status)
    _, status = os.waitpid(child, 0)
    if status:
        raise FaultError(f"the fork ended with {status}")


def _seed(_data: bytes, _others: Sequence[bytes], dice: random.Random) -> bytes:
    return dice.randbytes(8)


TARGETS = (
    Target(
        name="kills",
        seeds=lambda: [b"1"],
        run_one=_kill,
        mutate=_seed,
        memory_mb=None,
        seconds=PATIENCE_S,
        share=1.0,
    ),
    Target(
        name="worlds-in-use",
        seeds=lambda: [b"1", b"2", b"3"],
        run_one=_world,
        mutate=_seed,
        memory_mb=2048,
        seconds=60.0,
        share=1.0,
    ),
)
