"""Starts a ROS master if none is running."""

from __future__ import annotations

import os
import shutil
import subprocess
import threading
import time
from pathlib import Path

from cartwheel.bridges.ros1.address import host_and_port
from cartwheel.bridges.ros1.rpc import Peer, UnreachableError
from cartwheel.codes.wires import ROS_MASTER_NOT_STARTED, ROS_MASTER_UNAVAILABLE
from cartwheel.errors import CartwheelError

_START = 20.0
"""Timeout in s for the master to respond."""
_EXIT = 0.1
"""Time in s for a child process to exit before it is killed."""
_IF_CHILD_OF = '[ "$PPID" = "$0" ] && exec "$@"'
"""Shell script: runs a program unless the process with the given ID has already exited."""
_PREFIXES = ("/opt/ros/noetic", "/opt/ros/melodic", "/opt/ros/one", "/usr")


class OwnCore:
    """Runs ``rosmaster`` and ``rosout`` as child processes, like ``roscore``, but stops at once.

    Args:
        uri: URI of the master.
        host: Own host name or address. If it is loopback, both listen only on loopback.
    """

    def __init__(self, uri: str, host: str) -> None:
        self._uri = uri
        self._host = host
        self._master: _Child | None = None
        self._rosout: _Child | None = None

    @property
    def dead(self) -> bool:
        """Whether the master has exited, for any reason."""
        return self._master is not None and self._master.ended

    def start(self) -> None:
        """Starts both and waits until the master responds.

        Raises:
            CartwheelError: ROS's master is not installed, or does not start.
        """
        program = _found("rosmaster", "bin/rosmaster")
        if program is None:
            raise CartwheelError(
                f"no ROS master responds at {self._uri}, and rosmaster is not installed",
                code=ROS_MASTER_UNAVAILABLE,
                hint=(
                    "Install python3-rosmaster and rosout (Debian), ros-noetic-roscore (Ubuntu), "
                    "or set ROS_MASTER_URI to a running roscore."
                ),
                values={"uri": self._uri},
            )
        _, port = host_and_port(self._uri)
        self._master = _Child([program, "--core", "-p", str(port)], self._environment(program))
        peer = Peer(self._uri, timeout=1.0)
        deadline = time.monotonic() + _START
        while True:
            try:
                peer.call("getPid", "/cartwheel")
                break
            except UnreachableError as error:
                if self.dead or time.monotonic() > deadline:
                    self.stop()
                    raise CartwheelError(
                        f"the ROS master started for {self._uri} does not respond: {error.message}",
                        code=ROS_MASTER_NOT_STARTED,
                        hint="Check that roscore starts by itself. Its port may be in use.",
                        values={"uri": self._uri},
                    ) from None
            time.sleep(0.02)
        rosout = _found("rosout", "lib/rosout/rosout")
        if rosout is not None and (self._rosout is None or self._rosout.ended):
            self._rosout = _Child([rosout, "__name:=rosout"], self._environment(rosout))

    def stop(self) -> None:
        """Stops both."""
        children = [child for child in (self._rosout, self._master) if child is not None]
        for child in children:
            child.process.terminate()
        for child in children:
            try:
                child.process.wait(_EXIT)
            except subprocess.TimeoutExpired:
                child.process.kill()

    def _environment(self, program: str) -> dict[str, str]:
        environment = dict(os.environ, ROS_MASTER_URI=self._uri, ROS_HOSTNAME=self._host)
        prefix = Path(program).parents[1]
        modules = prefix / "lib/python3/dist-packages"
        if prefix != Path("/usr") and modules.is_dir():
            # A ROS distribution that was not sourced.
            known = environment.get("PYTHONPATH")
            environment["PYTHONPATH"] = f"{modules}:{known}" if known else str(modules)
        return environment


class _Child:
    """A child process that exits with this process, even if this process is killed.

    The kernel kills the child when the thread that started it exits, so that thread waits for it.
    """

    def __init__(self, command: list[str], environment: dict[str, str]) -> None:
        tether = shutil.which("setpriv")
        if tether is not None:
            # The shell exits if this process was killed before the kernel was set up to kill the
            # child.
            shell = ["/bin/sh", "-c", _IF_CHILD_OF, str(os.getpid())]
            command = [tether, "--pdeathsig", "KILL", *shell, *command]
        self._command = command
        self._environment = environment
        self._error: OSError | None = None
        self._started = threading.Event()
        threading.Thread(target=self._run, name="ros1 child", daemon=True).start()
        self._started.wait()
        if self._error is not None:
            raise CartwheelError(
                f"{command[0]} cannot be started: {self._error}",
                code=ROS_MASTER_NOT_STARTED,
                values={"command": command[0]},
            )

    @property
    def ended(self) -> bool:
        """Whether the process has exited."""
        return self.process.poll() is not None

    def _run(self) -> None:
        try:
            self.process = subprocess.Popen(  # noqa: S603 - a ROS program found by Cartwheel
                self._command,
                env=self._environment,
                stdin=subprocess.DEVNULL,
                stdout=subprocess.DEVNULL,
                stderr=subprocess.DEVNULL,
                # Cartwheel handles Ctrl-C in a terminal: it stops them after it has unregistered.
                start_new_session=True,
            )
        except OSError as error:
            self._error = error
            return
        finally:
            self._started.set()
        self.process.wait()


def _found(name: str, below: str) -> str | None:
    on_path = shutil.which(name)
    if on_path is not None:
        return on_path
    for prefix in _PREFIXES:
        path = Path(prefix) / below
        if os.access(path, os.X_OK):
            return str(path)
    return None
