"""A ROS master of our own, where none answers."""

from __future__ import annotations

import contextlib
import os
import shutil
import signal
import subprocess
import time
from pathlib import Path

from cartwheel.bridges.ros1.address import host_and_port
from cartwheel.bridges.ros1.rpc import Peer, UnreachableError
from cartwheel.errors import CartwheelError

_START = 20.0
"""s that a master may take to answer."""
_PREFIXES = ("/opt/ros/noetic", "/opt/ros/melodic", "/opt/ros/one", "/usr")


class OwnCore:
    """``rosmaster`` and ``rosout`` as children: what ``roscore`` is, but ended in an instant.

    Args:
        uri: Where it is to listen.
    """

    def __init__(self, uri: str) -> None:
        self._uri = uri
        self._master: subprocess.Popen[bytes] | None = None
        self._rosout: subprocess.Popen[bytes] | None = None

    @property
    def dead(self) -> bool:
        """Whether the master has ended, by whatever cause."""
        return self._master is not None and self._master.poll() is not None

    def start(self) -> None:
        """Starts both and waits until the master answers.

        Raises:
            CartwheelError: ROS's master is not installed, or does not start.
        """
        program = _found("rosmaster", "bin/rosmaster")
        if program is None:
            raise CartwheelError(
                f"no ROS master answers at {self._uri}, and none can be started here:"
                " rosmaster is not installed",
                hint="Install python3-rosmaster and rosout (Debian), ros-noetic-roscore (Ubuntu)"
                " or start a roscore elsewhere and set ROS_MASTER_URI.",
            )
        _, port = host_and_port(self._uri)
        self._master = _child([program, "--core", "-p", str(port)], program)
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
                        f"the ROS master that was started for {self._uri} does not answer: {error}",
                        hint="Does roscore run on its own? It may be the port that is taken.",
                    ) from None
            time.sleep(0.02)
        rosout = _found("rosout", "lib/rosout/rosout")
        if rosout is not None and (self._rosout is None or self._rosout.poll() is not None):
            self._rosout = _child([rosout, "__name:=rosout"], rosout, self._uri)

    def stop(self) -> None:
        """Ends both."""
        children = [child for child in (self._rosout, self._master) if child is not None]
        for child in children:
            with contextlib.suppress(OSError):
                child.send_signal(signal.SIGTERM)
        for child in children:
            try:
                child.wait(0.1)
            except subprocess.TimeoutExpired:
                child.kill()


def _found(name: str, below: str) -> str | None:
    on_path = shutil.which(name)
    if on_path is not None:
        return on_path
    for prefix in _PREFIXES:
        path = Path(prefix) / below
        if os.access(path, os.X_OK):
            return str(path)
    return None


def _child(
    command: list[str], program: str, master_uri: str | None = None
) -> subprocess.Popen[bytes]:
    environment = dict(os.environ)
    if master_uri is not None:
        environment["ROS_MASTER_URI"] = master_uri
    prefix = Path(program).parents[1]
    modules = prefix / "lib/python3/dist-packages"
    if prefix != Path("/usr") and modules.is_dir():
        # A distribution that nobody has sourced.
        known = environment.get("PYTHONPATH")
        environment["PYTHONPATH"] = f"{modules}:{known}" if known else str(modules)
    tether = shutil.which("setpriv")
    if tether is not None:
        # Also where we are killed, nothing of ours is to stay.
        command = [tether, "--pdeathsig", "TERM", *command]
    return subprocess.Popen(  # noqa: S603 - a program of ROS, found by us
        command,
        env=environment,
        stdin=subprocess.DEVNULL,
        stdout=subprocess.DEVNULL,
        stderr=subprocess.DEVNULL,
        # Ctrl-C in a terminal is for us: we end them when we have said farewell.
        start_new_session=True,
    )
