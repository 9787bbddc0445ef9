"""Programs under test, which are started for a case and ended with it."""

from __future__ import annotations

import contextlib
import os
import secrets
import signal
import socket
import subprocess
import tempfile
import time
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from types import TracebackType
from typing import IO, Self
from xmlrpc.client import ServerProxy

from cartwheel.blas import environment_for_others
from cartwheel.codes.command import LAUNCH_FAILED
from cartwheel.errors import CartwheelError
from cartwheel.watchers import announce

_GRACE = 5.0
"""Wall time between SIGINT, SIGTERM and SIGKILL, s."""
_OUTPUT = 20_000
"""Maximum length of the kept output in bytes."""
_LINES = 20
"""Maximum number of lines of the output in an error."""
_LOOK = 0.05
_MARK = "CARTWHEEL_LAUNCHED"
"""Environment variable of launched programs."""
_PROCESSES = Path("/proc")
_START = 30.0
"""Wall time within which a ROS master must respond, s."""


class Launched:
    """A program that ends with the block, and with it all processes that it started.

    roslaunch and others start processes in groups of their own. These are found by an environment
    variable, which they inherit.

    Args:
        command: Program and arguments.
        folder: Working directory.
        environment: Additional environment variables.

    Raises:
        CartwheelError: The program cannot be started.
    """

    def __init__(
        self, command: Sequence[str], folder: Path, environment: Mapping[str, str]
    ) -> None:
        self.command = list(command)
        self.reported = False
        """Whether an error contains the last output."""
        mark = secrets.token_hex(16)
        self._mark = f"{_MARK}={mark}"
        self._output: IO[bytes] = tempfile.TemporaryFile()  # noqa: SIM115 - closed by `close`
        try:
            self._process = subprocess.Popen(  # noqa: S603 - the user allowed it
                self.command,
                cwd=folder,
                env={**environment_for_others(), **environment, _MARK: mark},
                stdin=subprocess.DEVNULL,
                stdout=self._output,
                stderr=subprocess.STDOUT,
                start_new_session=True,
            )
        except OSError as error:
            self._output.close()
            raise CartwheelError(
                f'"{self.command[0]}" cannot be started: {error.strerror}',
                code=LAUNCH_FAILED,
                values={"command": self.command[0]},
            ) from None
        announce(self)

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        if error is not None:
            error.add_note(self.summary)
            self.reported = True
        self.close()

    @property
    def summary(self) -> str:
        """The last lines of the program's output, for an error."""
        lines = self.output.splitlines()[-_LINES:]
        if not lines:
            return f'"{self.command[0]}" has printed nothing'
        return "\n  ".join([f'the last output of "{self.command[0]}":', *lines])

    def check(self) -> None:
        """Raises an error if the program has failed.

        Raises:
            CartwheelError: See above.
        """
        status = self._process.poll()
        if status:
            raise CartwheelError(
                f'"{self.command[0]}" ended with status {status}',
                code=LAUNCH_FAILED,
                values={"command": self.command[0], "status": status},
            )

    @property
    def ended(self) -> bool:
        """Whether `close` was called. The output is no longer available then."""
        return self._output.closed

    @property
    def output(self) -> str:
        """The end of the program's output."""
        if self._output.closed:
            return ""
        size = os.fstat(self._output.fileno()).st_size
        start = max(0, size - _OUTPUT)
        data = os.pread(self._output.fileno(), _OUTPUT, start)
        return data.decode(errors="replace")

    def close(self) -> None:
        """Ends the program and all processes that it started."""
        if self._output.closed:
            return
        # On SIGINT, programs that start others end these in their own order.
        for number in (signal.SIGINT, signal.SIGTERM, signal.SIGKILL):
            if not self._signal(number):
                break
            end = time.monotonic() + _GRACE
            while time.monotonic() < end and self._signal(0):
                time.sleep(_LOOK)
        with contextlib.suppress(subprocess.TimeoutExpired):
            self._process.wait(_GRACE)
        self._output.close()

    def _signal(self, number: int) -> bool:
        """Sends a signal to all processes; returns whether one still exists."""
        self._process.poll()
        found = False
        with contextlib.suppress(ProcessLookupError, PermissionError):
            os.killpg(self._process.pid, number)
            found = True
        for process in self._strays():
            with contextlib.suppress(ProcessLookupError, PermissionError):
                # The program itself is responsible for them as long as it can be.
                os.kill(process, 0 if number == signal.SIGINT and found else number)
                found = True
        return found

    def _strays(self) -> Iterator[int]:
        """Processes with the mark in other process groups. Requires Linux's ``/proc``."""
        mark = self._mark.encode()
        for entry in _PROCESSES.glob("[0-9]*/environ"):
            with contextlib.suppress(OSError):
                process = int(entry.parent.name)
                if mark in entry.read_bytes().split(b"\0") and (
                    os.getpgid(process) != self._process.pid
                ):
                    yield process


def launch(
    command: Sequence[str],
    *,
    folder: str | Path = ".",
    environment: Mapping[str, str] | None = None,
) -> Launched:
    """Starts a program under test. Use it in a ``with`` block, which ends it.

    Args:
        command: Program and arguments.
        folder: Its working directory.
        environment: Additional environment variables.

    Returns:
        The program. `Launched.check` raises an error if it has failed, for `World.lockstep`, and
        `Launched.output` is what it has printed. An error that ends the block contains the last
        lines.

    Raises:
        CartwheelError: The program cannot be started.
    """
    return Launched(command, Path(folder), environment or {})


@contextlib.contextmanager
def ros_master(folder: Path) -> Iterator[dict[str, str]]:
    """A ROS master on a free port, in a process group of its own.

    Yields:
        Environment variables of its nodes.

    Raises:
        CartwheelError: The master cannot be started.
    """
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        port = probe.getsockname()[1]
    environment = {"ROS_MASTER_URI": f"http://127.0.0.1:{port}", "ROS_HOSTNAME": "127.0.0.1"}
    with Launched(["rosmaster", "--core", "-p", str(port)], folder, environment) as master:
        end = time.monotonic() + _START
        while not _reachable(port):
            master.check()
            if time.monotonic() > end:
                raise CartwheelError(
                    f"the ROS master did not respond within {_START:g} s", code=LAUNCH_FAILED
                )
            time.sleep(_LOOK)
        # Nodes that start before the simulation is connected would otherwise use the wall clock.
        ServerProxy(environment["ROS_MASTER_URI"]).setParam("/cartwheel", "/use_sim_time", True)
        yield environment


def _reachable(port: int) -> bool:
    with socket.socket() as probe:
        probe.settimeout(1.0)
        return probe.connect_ex(("127.0.0.1", port)) == 0


def ros2_domain(worker: int) -> dict[str, str]:
    """Environment variables for a ROS 2 domain of a worker's own.

    Domains above 101 use ports that Linux may give to other programs.
    """
    return {"ROS_DOMAIN_ID": str(101 - worker % 90)}
