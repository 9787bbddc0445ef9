"""Driving from the terminal, with the keys of ROS's teleop_twist_keyboard."""

from __future__ import annotations

import contextlib
import os
import signal
import sys
import termios
import tty
from collections.abc import Iterable, Iterator
from typing import Any, Self

from cartwheel.cli import interrupts
from cartwheel.cli.commands.clients import connect
from cartwheel.cli.console import note, paint
from cartwheel.cli.teleop_keys import HELP, Driver
from cartwheel.codes.command import DRIVE_AMBIGUOUS, NOTHING_TO_DRIVE
from cartwheel.control import ControlClient
from cartwheel.errors import CartwheelError

TWIST = "geometry_msgs/msg/Twist"
STAMPED = "geometry_msgs/msg/TwistStamped"


def drive(sim: int | None, topic: str | None, *, speed: float, turn: float) -> None:
    """Publishes a Twist for each key, and a stop at the end."""
    with connect(sim) as client:
        read = topics_read(client)
        topic = topic or the_topic(read)
        kind = read.get(topic, TWIST)
        driver = Driver(speed, turn)
        if not client.publish(topic, kind, _message(driver, kind)):
            raise CartwheelError(
                f"{topic} has no subscribers",
                code=NOTHING_TO_DRIVE,
                hint="See: cartwheel topic list -v",
                values={"topic": topic},
            )
        try:
            with single_keys() as terminal, Suspension(terminal) as suspension:
                note(f"driving {paint(topic, 'bold', stream=sys.stderr)}\n\n{HELP}\n")
                for key in keys(suspension):
                    driver.press(key)
                    # Where this process ends without a word, the simulation itself stops the robot.
                    client.publish(topic, kind, _message(driver, kind), at_end=_end(driver, kind))
                    _show(driver)
        except interrupts.Interrupted:
            pass  # The way to end it.
        finally:
            driver.press("k")
            client.publish(topic, kind, _message(driver, kind))
        note("")


def topics_read(client: ControlClient) -> dict[str, str]:
    """The types of the topics on which robots wait for a Twist, stamped or not."""
    return {
        one["name"]: one["type"]
        for one in client.request("topics")["topics"]
        if one["type"] in (TWIST, STAMPED) and one["subscribers"]
    }


def the_topic(found: Iterable[str]) -> str:
    """The one of them that drives.

    Raises:
        CartwheelError: There is none, or several.
    """
    found = list(found)
    driven = [name for name in found if name.rsplit("/", 1)[-1] == "cmd_vel"] or found
    if not driven:
        raise CartwheelError(
            "no robot subscribes to velocity commands (Twist)",
            code=NOTHING_TO_DRIVE,
            hint="Add a drive plugin, such as diff_drive, to the robot.",
        )
    if len(driven) > 1:
        raise CartwheelError(
            f"{len(driven)} robots can be driven; select one with --topic",
            code=DRIVE_AMBIGUOUS,
            hint=f"Valid topics: {', '.join(driven)}.",
            values={"topics": tuple(driven)},
        )
    return driven[0]


@contextlib.contextmanager
def single_keys() -> Iterator[list[Any] | None]:
    """Makes a terminal hand over each key as it is pressed, and puts it back as it was.

    Yields how it was; None where standard input is no terminal.
    """
    descriptor = sys.stdin.fileno()
    if not os.isatty(descriptor):
        yield None
        return
    before = termios.tcgetattr(descriptor)
    with interrupts.finally_do(lambda: termios.tcsetattr(descriptor, termios.TCSANOW, before)):
        # Ctrl-C stays a signal, which also another process can send.
        tty.setcbreak(descriptor, termios.TCSANOW)
        yield before


class _SuspendedError(Exception):
    """SIGTSTP came."""


class Suspension:
    """Puts SIGTSTP, Ctrl-Z at a terminal, off until the robot has been stopped.

    Args:
        terminal: How it was before; None is no terminal.
    """

    def __init__(self, terminal: list[Any] | None) -> None:
        self._terminal = terminal
        self._asked = self._reading = False

    def __enter__(self) -> Self:
        signal.signal(signal.SIGTSTP, self._on_signal)
        return self

    def __exit__(self, *_: object) -> None:
        signal.signal(signal.SIGTSTP, signal.SIG_DFL)

    def read(self) -> bytes | None:
        """What comes next from standard input; None where the process is to be suspended."""
        try:
            return self._read()
        except _SuspendedError:
            return None

    def suspend(self) -> None:
        """Suspends the process, and returns once it goes on."""
        self._asked = False
        signal.signal(signal.SIGTSTP, signal.SIG_DFL)
        descriptor = sys.stdin.fileno()
        if self._terminal is not None:
            termios.tcsetattr(descriptor, termios.TCSANOW, self._terminal)
        os.kill(os.getpid(), signal.SIGTSTP)
        if self._terminal is not None:
            tty.setcbreak(descriptor, termios.TCSANOW)
        signal.signal(signal.SIGTSTP, self._on_signal)

    def _read(self) -> bytes | None:
        self._reading = True
        try:
            return None if self._asked else os.read(sys.stdin.fileno(), 64)
        finally:
            self._reading = False

    def _on_signal(self, *_: object) -> None:
        # In the middle of a request to the simulation it waits for the next key.
        self._asked = True
        if self._reading:
            self._reading = False
            raise _SuspendedError


def keys(suspension: Suspension) -> Iterator[str]:
    """Keys as they are pressed, or the letters of a pipe; ends with it.

    One that stops the robot comes before the process is suspended.
    """
    while (data := suspension.read()) != b"":
        if data is None:
            yield "k"
            suspension.suspend()
            continue
        text = data.decode("utf-8", "replace")
        # An arrow or a function key is an escape and letters that mean nothing here.
        yield from ("k",) if text.startswith("\x1b") else "".join(text.split("\n"))


def _message(driver: Driver, kind: str) -> dict[str, Any]:
    x, y, z = driver.linear
    twist = {"linear": {"x": x, "y": y, "z": z}, "angular": {"z": driver.angular}}
    return {"twist": twist} if kind == STAMPED else twist


def _end(driver: Driver, kind: str) -> dict[str, Any] | None:
    """What stops a robot that moves; one that stands may be driven by others."""
    return _message(Driver(0.0, 0.0), kind) if any(driver.move) else None


def _show(driver: Driver) -> None:
    line = str(driver)
    if sys.stderr.isatty():
        sys.stderr.write(f"\r{line}   ")
        sys.stderr.flush()
    else:
        note(line)
