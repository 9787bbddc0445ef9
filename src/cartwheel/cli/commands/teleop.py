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


def drive(sim: str | None, topic: str | None, *, speed: float, turn: float) -> None:
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
                    # If this process dies, the simulation itself stops the robot.
                    client.publish(topic, kind, _message(driver, kind), at_end=_end(driver, kind))
                    _show(driver)
        except interrupts.Interrupted:
            pass  # The normal way to end it.
        finally:
            driver.press("k")
            client.publish(topic, kind, _message(driver, kind))
        note("")


def topics_read(client: ControlClient) -> dict[str, str]:
    """The types of the topics with subscribers for Twist messages, stamped or not."""
    return {
        one["name"]: one["type"]
        for one in client.request("topics")["topics"]
        if one["type"] in (TWIST, STAMPED) and one["subscribers"]
    }


def the_topic(found: Iterable[str]) -> str:
    """The only drive topic.

    Raises:
        CartwheelError: There is none, or there are several.
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
    """Sets the terminal to deliver single keys, and restores it afterwards.

    Yields the previous settings; None if standard input is not a terminal.
    """
    descriptor = sys.stdin.fileno()
    if not os.isatty(descriptor):
        yield None
        return
    before = termios.tcgetattr(descriptor)
    with interrupts.finally_do(lambda: termios.tcsetattr(descriptor, termios.TCSANOW, before)):
        # Ctrl-C remains a signal, which other processes can also send.
        tty.setcbreak(descriptor, termios.TCSANOW)
        yield before


class _SuspendedError(Exception):
    """SIGTSTP was received."""


class Suspension:
    """Delays SIGTSTP (Ctrl-Z in a terminal) until the robot has been stopped.

    Args:
        terminal: Previous terminal settings; None without a terminal.
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
        """The next input; None if the process is about to be suspended."""
        try:
            return self._read()
        except _SuspendedError:
            return None

    def suspend(self) -> None:
        """Suspends the process, and returns when it is resumed."""
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
        # During a request to the simulation, wait for the next key.
        self._asked = True
        if self._reading:
            self._reading = False
            raise _SuspendedError


def keys(suspension: Suspension) -> Iterator[str]:
    """Keys as they are pressed, or the characters of a pipe until it ends.

    A key that stops the robot is returned before the process is suspended.
    """
    while (data := suspension.read()) != b"":
        if data is None:
            yield "k"
            suspension.suspend()
            continue
        text = data.decode("utf-8", "replace")
        # Arrow and function keys are an escape sequence whose letters must be ignored.
        yield from ("k",) if text.startswith("\x1b") else "".join(text.split("\n"))


def _message(driver: Driver, kind: str) -> dict[str, Any]:
    x, y, z = driver.linear
    twist = {"linear": {"x": x, "y": y, "z": z}, "angular": {"z": driver.angular}}
    return {"twist": twist} if kind == STAMPED else twist


def _end(driver: Driver, kind: str) -> dict[str, Any] | None:
    """A stop message for a moving robot; a stationary robot may be driven by others."""
    return _message(Driver(0.0, 0.0), kind) if any(driver.move) else None


def _show(driver: Driver) -> None:
    line = str(driver)
    if sys.stderr.isatty():
        sys.stderr.write(f"\r{line}   ")
        sys.stderr.flush()
    else:
        note(line)
