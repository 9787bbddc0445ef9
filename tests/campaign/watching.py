"""One worker process under a watchdog."""

from __future__ import annotations

import contextlib
import json
import os
import shutil
import signal
import struct
import subprocess
import sys
import time
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from tests.campaign.finding import Finding
from tests.campaign.target import Target
from tests.campaign.worker import COUNTERS

ROOT = Path(__file__).parents[2]
_LOADING_S = 300.0
"""Wall time until a worker reads its first input."""
_LEAST_WALL_S = 60.0
"""A busy machine gives an input this much wall time, however little CPU time it may take."""
_POLL_S = 0.05
_SOCKETS = Path("/tmp")
"""Where live runs have a folder each, since the path of a socket must be short."""


@dataclass(frozen=True, kw_only=True)
class Watched:
    """What came of a worker."""

    begun: int
    accepted: int
    refused: int
    faulty: int
    slowest_ms: int
    ended: bool
    """False: it was killed or died, and its last input is a finding."""
    stopped: bool = False
    """The campaign was interrupted meanwhile."""


def watch(target: Target, task: Mapping[str, Any], room: Path) -> Watched:
    """Runs a worker until it ends, dies, or takes too long for an input.

    Args:
        target: Whose limits hold.
        task: For the worker; `target`, `room` and what it needs beyond.
        room: The target's folder.
    """
    shutil.rmtree(room / "tmp", ignore_errors=True)
    for folder in ("tmp", "corpus"):
        (room / folder).mkdir(parents=True, exist_ok=True)
    counters = room / "counters"
    counters.write_bytes(bytes(COUNTERS.size))
    environment = {
        **os.environ,
        "PYTHONPATH": os.pathsep.join((str(ROOT), str(ROOT / "src"), str(ROOT / "tools"))),
        "PYTHONHASHSEED": "0",
        # Each thread's own arena and each library's own threads would count as address space.
        "MALLOC_ARENA_MAX": "2",
        "OMP_NUM_THREADS": "1",
        "OPENBLAS_NUM_THREADS": "1",
    }
    process = subprocess.Popen(
        [sys.executable, "-m", "tests.campaign.worker", json.dumps({**task, "room": str(room)})],
        cwd=ROOT,
        env=environment,
        start_new_session=True,
        stdin=subprocess.DEVNULL,
        stdout=subprocess.DEVNULL,
        stderr=(room / "starting").open("wb"),
    )
    reason, stopped = "", False
    try:
        reason = _guard(process, target, counters)
    except KeyboardInterrupt:
        stopped = True
    finally:
        if process.poll() is None and reason:
            process.send_signal(signal.SIGUSR1)  # it writes where it is
            with contextlib.suppress(subprocess.TimeoutExpired):
                process.wait(0.5)
        with contextlib.suppress(ProcessLookupError):
            os.killpg(process.pid, signal.SIGKILL)
        process.wait()
        shutil.rmtree(room / "tmp", ignore_errors=True)
        sweep()
    loaded, begun, accepted, refused, faulty, slowest = COUNTERS.unpack(counters.read_bytes())
    if stopped:
        return Watched(
            begun=begun,
            accepted=accepted,
            refused=refused,
            faulty=faulty,
            slowest_ms=slowest,
            ended=True,
            stopped=True,
        )
    if not loaded or (begun == 0 and process.returncode):
        _startless(target, room).save(room.parent / "findings")
        return Watched(begun=0, accepted=0, refused=0, faulty=1, slowest_ms=0, ended=True)
    if not reason and process.returncode:
        reason = "death"
    if reason:
        faulty += 1
        _finding(target, room, reason, process.returncode).save(room.parent / "findings")
    return Watched(
        begun=begun,
        accepted=accepted,
        refused=refused,
        faulty=faulty,
        slowest_ms=slowest,
        ended=not reason,
    )


def sweep() -> None:
    """Removes folders of live runs whose worker has ended without doing it."""
    for folder in _SOCKETS.glob("cw[0-9]*-*"):
        pid = folder.name[2:].partition("-")[0]
        if not Path("/proc", pid).exists():
            shutil.rmtree(folder, ignore_errors=True)


def _startless(target: Target, room: Path) -> Finding:
    """That the target's module or seeds fail, before any input."""
    text = _text(room / "starting") + _text(room / "output")
    return Finding(target=target.name, kind="start", where="start", text=text, inputs=())


def _guard(process: subprocess.Popen[bytes], target: Target, counters: Path) -> str:
    """Waits for its end; ``time`` where an input takes too long."""
    last, since, used = -1, time.monotonic(), 0.0
    while True:
        with contextlib.suppress(subprocess.TimeoutExpired):
            process.wait(_POLL_S)
            return ""
        loaded, begun, *_ = COUNTERS.unpack(counters.read_bytes())
        now, cpu = time.monotonic(), _cpu_seconds(process.pid)
        if begun != last or not loaded:
            if begun != last:
                last, since, used = begun, now, cpu
            if not loaded and now - since > _LOADING_S:
                return "time"
        elif cpu - used > target.seconds or now - since > max(10 * target.seconds, _LEAST_WALL_S):
            return "time"


def _cpu_seconds(pid: int) -> float:
    try:
        words = Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()
    except OSError:
        return 0.0
    return (int(words[11]) + int(words[12])) / os.sysconf("SC_CLK_TCK")


def _finding(target: Target, room: Path, reason: str, status: int) -> Finding:
    stacks = _text(room / "stacks")
    lines = [line.strip() for line in stacks.splitlines() if line.strip().startswith("File")]
    ours = [line for line in lines if "/cartwheel/" in line] or lines
    place = ours[0].rpartition("/")[2] if ours else "?"
    return Finding(
        target=target.name,
        kind=reason,
        where=place if reason == "time" else f"{place} status {status}",
        text=f"status {status}\n{stacks}\n{_text(room / 'output')}",
        inputs=_current(room / "current"),
    )


def _current(file: Path) -> tuple[bytes, ...]:
    """The inputs that the worker wrote down last."""
    data = file.read_bytes() if file.exists() else b""
    if len(data) < 8:
        return ()
    end = 8 + struct.unpack_from("<Q", data)[0]
    found, at = [], 8
    while at + 8 <= min(end, len(data)):
        size = struct.unpack_from("<Q", data, at)[0]
        found.append(data[at + 8 : at + 8 + size])
        at += 8 + size
    return tuple(found)


def _text(file: Path) -> str:
    return file.read_text(errors="replace")[-20_000:] if file.exists() else ""
