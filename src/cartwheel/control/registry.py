"""Lists the simulations on this computer: each has a socket and a small file.

They are in a folder that only the user can access, so that other users cannot control or
impersonate a simulation.
"""

from __future__ import annotations

import json
import os
import socket
import stat
import time
from collections import Counter
from collections.abc import Iterable, Sequence
from dataclasses import asdict, dataclass, field, replace
from pathlib import Path

from cartwheel.codes.command import (
    CONTROL_FOLDER_UNUSABLE,
    SIMULATION_AMBIGUOUS,
    SIMULATION_NOT_RUNNING,
)
from cartwheel.errors import ControlError

VARIABLE = "CARTWHEEL_SIM"
"""Selects the simulation for commands if several are running."""

_LONGEST_SOCKET = 100
"""Maximum length of a socket path, bytes; the system's limit is 104 or 108."""


@dataclass(frozen=True, kw_only=True, slots=True)
class Running:
    """A running simulation."""

    pid: int
    title: str
    """A short description of what is simulated."""
    world: str
    url: str | None = None
    """URL of the web viewer; None without a viewer."""
    port: int | None = None
    ros_master: str | None = None
    """URI of the ROS 1 master where it is registered; empty until then, None without ROS."""
    started: float = field(default_factory=time.time)
    """Seconds since 1970."""
    path: Path
    """Path of the socket."""
    has_siblings: bool = False
    """Whether its process has several simulations."""

    def __str__(self) -> str:
        since = time.strftime("%H:%M:%S", time.localtime(self.started))
        page = f", {self.url}" if self.url else ""
        return f"{self.selector}: {self.title}{page}, since {since}"

    @property
    def number(self) -> str:
        """``PID-2`` for the second simulation of its process."""
        return f"{self.pid}-{self.path.stem.partition('-')[2] or 1}"

    @property
    def selector(self) -> str:
        """The value of ``--sim`` for this simulation."""
        return self.number if self.has_siblings else str(self.pid)


def folder() -> Path:
    """The user's folder for sockets, which is created if necessary.

    Raises:
        ControlError: Other users could write to the folder.
    """
    base = os.environ.get("XDG_RUNTIME_DIR", "")
    chosen = Path(base, "cartwheel") if base.startswith("/") and Path(base).is_dir() else None
    if chosen is None or len(os.fsencode(chosen)) > _LONGEST_SOCKET - len("/4194304-99.sock"):
        # TMPDIR is ignored, because all processes of a user must use the same folder.
        chosen = Path(f"/tmp/cartwheel-{os.getuid()}")  # noqa: S108 - owner and mode are checked
    try:
        chosen.mkdir(mode=0o700, exist_ok=True)
        found = chosen.lstat()
    except OSError as error:
        raise ControlError(
            f"{chosen} cannot be used: {error.strerror}",
            code=CONTROL_FOLDER_UNUSABLE,
            values={"path": str(chosen)},
        ) from error
    if not stat.S_ISDIR(found.st_mode) or found.st_uid != os.getuid():
        raise ControlError(
            f"another user owns {chosen}",
            code=CONTROL_FOLDER_UNUSABLE,
            hint="Set XDG_RUNTIME_DIR to a folder that you own.",
            values={"path": str(chosen)},
        )
    if found.st_mode & 0o077:
        chosen.chmod(0o700)
    return chosen


def running() -> list[Running]:
    """All running simulations of this user, oldest first; removes files of dead processes."""
    found = []
    for file in sorted(folder().glob("*.json")):
        entry = _read(file)
        if entry is not None and answers(entry.path):
            found.append(entry)
        else:
            file.unlink(missing_ok=True)
            file.with_suffix(".sock").unlink(missing_ok=True)
    processes = Counter(entry.pid for entry in found)
    found = [replace(entry, has_siblings=processes[entry.pid] > 1) for entry in found]
    return sorted(found, key=lambda entry: entry.started)


def find(selector: str | None = None) -> Running:
    """The simulation that a command applies to: the selected one, or the only one.

    Args:
        selector: Process ID, process ID and number as ``4711-2``, or the name of the world. The
            environment variable `VARIABLE` is the default.

    Raises:
        ControlError: No simulation is running, or several are and none is selected.
    """
    known = running()
    selector = selector or os.environ.get(VARIABLE, "").strip()
    if selector:
        found = (
            [entry for entry in known if selector == str(entry.pid)]
            or [entry for entry in known if selector == entry.number]
            or [entry for entry in known if selector == entry.world]
        )
        if len(found) == 1:
            return found[0]
        if found:
            raise _ambiguous(f'{len(found)} simulations match "{selector}"', found)
        raise ControlError(
            f'no running simulation has the process ID or world "{selector}"',
            code=SIMULATION_NOT_RUNNING,
            hint=_listing(known),
            values={"sim": selector},
        )
    if not known:
        raise ControlError(
            "no simulation is running",
            code=SIMULATION_NOT_RUNNING,
            hint="Start one with: cartwheel run",
        )
    if len(known) > 1:
        raise _ambiguous(f"{len(known)} simulations are running", known)
    return known[0]


def listen() -> tuple[socket.socket, Path]:
    """Creates a listening socket for this process in the folder."""
    base = folder()
    for count in range(1, 100):
        name = str(os.getpid()) if count == 1 else f"{os.getpid()}-{count}"
        path = base / f"{name}.sock"
        server = socket.socket(socket.AF_UNIX, socket.SOCK_STREAM)
        if path.exists() and not answers(path):
            # Left by a dead process with the same process ID.
            path.unlink(missing_ok=True)
        try:
            server.bind(str(path))
        except OSError:
            server.close()
            continue
        server.listen(128)
        return server, path
    raise ControlError(
        f"no socket can be created in {base}",
        code=CONTROL_FOLDER_UNUSABLE,
        values={"path": str(base)},
    )


def announce(entry: Running) -> None:
    """Writes or replaces a simulation's file atomically."""
    values = asdict(entry)
    del values["path"], values["has_siblings"]
    file = entry.path.with_suffix(".json")
    draft = entry.path.with_suffix(".draft")
    draft.write_text(json.dumps(values))
    draft.replace(file)


def withdraw(path: Path) -> None:
    """Removes a simulation's files."""
    path.with_suffix(".json").unlink(missing_ok=True)
    path.unlink(missing_ok=True)


def answers(path: Path) -> bool:
    """Whether a process is listening on a socket."""
    with socket.socket(socket.AF_UNIX, socket.SOCK_STREAM) as probe:
        probe.settimeout(1.0)
        try:
            probe.connect(str(path))
        except (BlockingIOError, TimeoutError):
            # The queue is full: busy, but alive.
            return True
        except OSError:
            return False
    return True


def _read(file: Path) -> Running | None:
    try:
        values = json.loads(file.read_text())
        return Running(**values, path=file.with_suffix(".sock"))
    except (OSError, ValueError, TypeError):
        return None


def _ambiguous(problem: str, found: Sequence[Running]) -> ControlError:
    return ControlError(
        f"{problem}; select one with --sim",
        code=SIMULATION_AMBIGUOUS,
        hint=f"For example, use --sim {found[-1].selector}. {_listing(found)}",
        values={"sims": tuple(sorted(entry.selector for entry in found))},
    )


def _listing(known: Iterable[Running]) -> str:
    return (
        ("Running simulations:\n") + "\n".join(f"    {entry}" for entry in known)
        if known
        else ("No simulation is running.")
    )
