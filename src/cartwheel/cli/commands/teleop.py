"""Driving from the terminal, with the keys of ROS's teleop_twist_keyboard."""

from __future__ import annotations

import contextlib
import os
import sys
from collections.abc import Iterator
from dataclasses import dataclass

from cartwheel.cli import interrupts
from cartwheel.cli.commands.clients import connect
from cartwheel.cli.console import note, paint
from cartwheel.control import ControlClient
from cartwheel.errors import CartwheelError

TWIST = "geometry_msgs/msg/Twist"

MOVES: dict[str, tuple[int, int, int, int]] = {
    "i": (1, 0, 0, 0),
    "o": (1, 0, 0, -1),
    "j": (0, 0, 0, 1),
    "l": (0, 0, 0, -1),
    "u": (1, 0, 0, 1),
    ",": (-1, 0, 0, 0),
    ".": (-1, 0, 0, 1),
    "m": (-1, 0, 0, -1),
    "I": (1, 0, 0, 0),
    "O": (1, -1, 0, 0),
    "J": (0, 1, 0, 0),
    "L": (0, -1, 0, 0),
    "U": (1, 1, 0, 0),
    "<": (-1, 0, 0, 0),
    ">": (-1, -1, 0, 0),
    "M": (-1, 1, 0, 0),
    "t": (0, 0, 1, 0),
    "b": (0, 0, -1, 0),
}
"""Key: sense of travel along x, y and z, and of turning about z."""

SPEEDS: dict[str, tuple[float, float]] = {
    "q": (1.1, 1.1),
    "z": (0.9, 0.9),
    "w": (1.1, 1.0),
    "x": (0.9, 1.0),
    "e": (1.0, 1.1),
    "c": (1.0, 0.9),
}
"""Key: factors of the linear and the angular speed."""

HELP = """\
   u  i  o      forward, turning left or right      U I O   sideways with shift,
   j  k  l      turn on the spot; k stops           J K L   for robots that can
   m  ,  .      backward                            M < >

   q z  both speeds up, down      w x  travel      e c  turning      t b  up, down
   any other key stops            Ctrl-C ends"""


@dataclass(slots=True)
class Driver:
    """What the keys have asked for so far; a move goes on until the next key."""

    speed: float
    turn: float
    move: tuple[int, int, int, int] = (0, 0, 0, 0)

    def press(self, key: str) -> None:
        """Takes a key."""
        if key in SPEEDS:
            linear, angular = SPEEDS[key]
            self.speed *= linear
            self.turn *= angular
        else:
            self.move = MOVES.get(key, (0, 0, 0, 0))

    @property
    def twist(self) -> dict[str, dict[str, float]]:
        """The message: m/s and rad/s."""
        x, y, z, yaw = self.move
        return {
            "linear": {"x": x * self.speed, "y": y * self.speed, "z": z * self.speed},
            "angular": {"z": yaw * self.turn},
        }


def drive(sim: int | None, topic: str | None, *, speed: float, turn: float) -> None:
    """Publishes a Twist for each key, and a stop at the end."""
    with connect(sim) as client:
        topic = topic or find_topic(client)
        driver = Driver(speed, turn)
        if not client.publish(topic, TWIST, driver.twist):
            raise CartwheelError(f"nobody reads {topic}", hint="See: cartwheel topic list -v")
        try:
            with single_keys():
                note(f"driving {paint(topic, 'bold', stream=sys.stderr)}\n\n{HELP}\n")
                for key in keys():
                    driver.press(key)
                    client.publish(topic, TWIST, driver.twist)
                    _show(driver)
        except interrupts.Interrupted:
            pass  # The way to end it.
        finally:
            driver.press("k")
            client.publish(topic, TWIST, driver.twist)
        note("")


def find_topic(client: ControlClient) -> str:
    """The one topic on which a robot waits for a Twist.

    Raises:
        CartwheelError: There is none, or several.
    """
    found = [
        one["name"]
        for one in client.request("topics")["topics"]
        if one["type"] == TWIST and one["subscribers"]
    ]
    driven = [name for name in found if name.rsplit("/", 1)[-1] == "cmd_vel"] or found
    if not driven:
        raise CartwheelError(
            "no robot here is driven by a Twist", hint="It needs a plugin such as diff_drive."
        )
    if len(driven) > 1:
        raise CartwheelError(
            f"{len(driven)} robots can be driven; name one with --topic",
            hint=f"They are: {', '.join(driven)}.",
        )
    return str(driven[0])


@contextlib.contextmanager
def single_keys() -> Iterator[None]:
    """Makes a terminal hand over each key as it is pressed, and puts it back as it was."""
    descriptor = sys.stdin.fileno()
    if not os.isatty(descriptor):
        yield
        return
    import termios
    import tty

    before = termios.tcgetattr(descriptor)
    with interrupts.finally_do(lambda: termios.tcsetattr(descriptor, termios.TCSANOW, before)):
        # Ctrl-C stays a signal, which also another process can send.
        tty.setcbreak(descriptor, termios.TCSANOW)
        yield


def keys() -> Iterator[str]:
    """Keys as they are pressed, or the letters of a pipe; ends with it."""
    while data := os.read(sys.stdin.fileno(), 64):
        text = data.decode("utf-8", "replace")
        # An arrow or a function key is an escape and letters that mean nothing here.
        yield from ("k",) if text.startswith("\x1b") else "".join(text.split("\n"))


def _show(driver: Driver) -> None:
    line = f"travel {driver.speed:.2f} m/s   turn {driver.turn:.2f} rad/s"
    if sys.stderr.isatty():
        sys.stderr.write(f"\r{line}   ")
        sys.stderr.flush()
    else:
        note(line)
