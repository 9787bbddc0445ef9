"""The keys of ROS's teleop_twist_keyboard and their commands; requires only Python.

`cartwheel teleop` and the ROS 1 program with that name (folder ros1) both use this file.
"""

from __future__ import annotations

from dataclasses import dataclass

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
"""By key: direction along x, y and z, and of rotation about z."""

SPEEDS: dict[str, tuple[float, float]] = {
    "q": (1.1, 1.1),
    "z": (0.9, 0.9),
    "w": (1.1, 1.0),
    "x": (0.9, 1.0),
    "e": (1.0, 1.1),
    "c": (1.0, 0.9),
}
"""By key: factors of the linear and the angular speed."""

HELP = """\
   u  i  o      forward            with Shift: sideways,
   j  k  l      spin, stop, spin   for robots that can move sideways
   m  ,  .      backward           t  b   up, down (multicopters)

   q  z  both speeds +10 %, -10 %     w  x  linear speed     e  c  angular speed
   any other key stops                Ctrl-C quits"""


@dataclass
class Driver:
    """The state set by the keys; a movement continues until the next key."""

    speed: float
    """m/s."""
    turn: float
    """rad/s."""
    move: tuple[int, int, int, int] = (0, 0, 0, 0)

    def press(self, key: str) -> None:
        """Handles a key."""
        if key in SPEEDS:
            linear, angular = SPEEDS[key]
            self.speed *= linear
            self.turn *= angular
        else:
            self.move = MOVES.get(key, (0, 0, 0, 0))

    @property
    def linear(self) -> tuple[float, float, float]:
        """m/s along x, y and z."""
        x, y, z, _ = self.move
        return x * self.speed, y * self.speed, z * self.speed

    @property
    def angular(self) -> float:
        """rad/s about z."""
        return self.move[3] * self.turn

    def __str__(self) -> str:
        return f"linear {self.speed:.2f} m/s   angular {self.turn:.2f} rad/s"
