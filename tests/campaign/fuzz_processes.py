"""Kills of every process at random moments, and worlds used in every order, thread and fork.

An input is the seed of what is done.
"""

from __future__ import annotations

import contextlib
import os
import random
import signal
import subprocess
import threading
import time
import traceback
from collections.abc import Sequence
from pathlib import Path
from random import Random

from tests.campaign.live import PATIENCE_S, PROGRAM, LiveRun, processes_of
from tests.campaign.target import FaultError, Target

from cartwheel.errors import CartwheelError

_MOST_PROCESSES = 12
_RECORDED_S = 0.5
"""Wall time after which a message is with the recorder."""
_WRITTEN_S = 1.0
"""Wall time after which it is in the file, even if the recorder is killed: `docs/recording.md`."""
_MOST_KILLS = 4
"""Of one run, which takes seconds to start."""
_CLOCK_NS = 100_000_000
"""Simulated time between two messages on ``/clock``, at most."""
_BALL = """<robot name="{}"><link name="b"><inertial><mass value="1"/><inertia ixx="1" iyy="1"
 izz="1" ixy="0" ixz="0" iyz="0"/></inertial><collision><geometry><sphere radius=".1"/></geometry>
</collision></link></robot>"""


def _kill(data: bytes) -> None:
    """Starts a run with all wires and a recording, and kills one of its processes."""
    dice = Random(data)
    name = dice.choice(("a.mcap", "a.bag", "a.db3", "a"))
    at_start = dice.random() < 0.3
    options = ("--record", name, "--record-topics", "/clock", "--overwrite")
    run = LiveRun(*options, wait=not at_start)
    before = set(Path.cwd().iterdir())
    try:
        time.sleep(dice.random())
        recorded = 0 if at_start else _now(run)
        processes = run.processes() or [run.process.pid]
        if len(processes) > _MOST_PROCESSES:
            raise FaultError(f"{len(processes)} processes")
        groups = _groups(processes) - {os.getpgrp()}
        shared = _shared_memory(processes)
        victims = dice.sample(processes, min(len(processes), dice.randint(1, _MOST_KILLS)))
        sent = dice.choice((signal.SIGKILL, signal.SIGKILL, signal.SIGTERM, signal.SIGINT))
        what = f"{sent.name} to"
        for victim in victims:
            what += f" {victim} ({_command(victim)})"
            if not at_start and "recording" in _command(victim):
                time.sleep(_WRITTEN_S)
            time.sleep((0.0 if at_start else _RECORDED_S) + dice.random() / 2)
            if run.process.poll() is not None:
                break
            with contextlib.suppress(ProcessLookupError):
                os.kill(victim, sent)
            # A bridge: the run goes on, or says why it ends.
            if "Traceback" in run.output():
                raise FaultError(f"after {what}:\n{run.output()}")
        if run.process.pid not in victims:
            time.sleep(dice.random())
            with contextlib.suppress(ProcessLookupError):
                run.process.send_signal(signal.SIGINT)
        _wait_for_end(run, what)
        if not at_start:
            _check_recording(Path(name).resolve(), recorded, what)
        _check_leftovers(run, what, groups, shared)
        if left := set(Path.cwd().iterdir()) - before - {Path(name).resolve()}:
            raise FaultError(f"{what}: left behind {left}")
    finally:
        run.close()


def _now(run: LiveRun) -> int:
    """Simulated time in ns."""
    with run.client() as client:
        return int(client.request("status")["time_ns"])  # type: ignore[attr-defined]


def _command(pid: int) -> str:
    try:
        return Path(f"/proc/{pid}/cmdline").read_bytes().replace(b"\0", b" ")[-100:].decode()
    except OSError:
        return "gone"


def _groups(processes: Sequence[int]) -> set[int]:
    found = set()
    for pid in processes:
        with contextlib.suppress(ProcessLookupError):
            found.add(os.getpgid(pid))
    return found


def _shared_memory(processes: Sequence[int]) -> set[Path]:
    """Files of /dev/shm that they have mapped."""
    found = set()
    for pid in processes:
        with contextlib.suppress(OSError):
            for line in Path(f"/proc/{pid}/maps").read_text().splitlines():
                name = line.partition("/dev/shm/")[2]
                if name and not name.endswith(" (deleted)"):
                    found.add(Path("/dev/shm") / name)
    return found


def _check_leftovers(run: LiveRun, what: str, groups: set[int], shared: set[Path]) -> None:
    """No process, shared memory or control socket may be left.

    Raises:
        FaultError: There is something.
    """
    living = [int(each.name) for each in Path("/proc").iterdir() if each.name.isdecimal()]
    if left := [pid for pid in living if _groups([pid]) & groups and _command(pid)]:
        raise FaultError(f"{what}: still there are {[_command(pid) for pid in left]}")
    if kept := [path for path in shared if path.exists()]:
        raise FaultError(f"{what}: left in /dev/shm: {kept}")
    if run.process.returncode == -signal.SIGKILL:
        # It could remove nothing: the next command that looks does.
        subprocess.run([PROGRAM, "status"], env=run.environment, capture_output=True, check=False)
    if entries := run.entries():
        raise FaultError(f"{what}: left in its folder of sockets: {entries}")


def _wait_for_end(run: LiveRun, what: str) -> None:
    deadline = time.monotonic() + PATIENCE_S
    while left := processes_of(run.mark):
        if run.process.poll() is None:
            with contextlib.suppress(Exception):
                run.process.wait(0.1)
        if time.monotonic() > deadline:
            raise FaultError(
                f"{what}: still there are {[_command(pid) for pid in left]}\n{run.output()}"
            )
        time.sleep(0.1)
    run.process.wait()
    if "Traceback" in run.output():
        raise FaultError(f"{what}:\n{run.output()}")


def _check_recording(path: Path, until: int, what: str) -> None:
    """It is readable, in order, and holds what was published until a time in ns.

    Raises:
        FaultError: It is not.
    """
    from cartwheel.bridges.recording.opening import open_recording

    if not path.exists():
        raise FaultError(f"{what}: there is no recording")
    recording = open_recording(path)
    times = [message.time_ns for message in recording.messages()]
    recording.close()
    if times != sorted(times):
        raise FaultError(f"{what}: the recording's times are out of order")
    if not times or times[-1] < until - _CLOCK_NS:
        last = times[-1] / 1e9 if times else None
        raise FaultError(f"{what}: the recording ends at {last} s, not after {until / 1e9} s")


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
        share=5.0,
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
