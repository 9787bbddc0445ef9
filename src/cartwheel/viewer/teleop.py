"""Driving by keys, with the keys and speeds of ROS's teleop_twist_keyboard."""

from __future__ import annotations

from dataclasses import dataclass

MOVES: dict[str, tuple[float, float]] = {
    "u": (1, 1),
    "i": (1, 0),
    "o": (1, -1),
    "j": (0, 1),
    "k": (0, 0),
    "l": (0, -1),
    "m": (-1, -1),
    ",": (-1, 0),
    ".": (-1, 1),
}
"""Key: direction of travel and of turning, as factors of the two speeds."""

SPEEDS: dict[str, tuple[float, float]] = {
    "q": (1.1, 1.1),
    "z": (0.9, 0.9),
    "w": (1.1, 1.0),
    "x": (0.9, 1.0),
    "e": (1.0, 1.1),
    "c": (1.0, 0.9),
}
"""Key: factors of the linear and the angular speed."""

KEYS = (*MOVES, *SPEEDS)


@dataclass(slots=True)
class Teleop:
    """What the keys have asked for so far. A key holds until the next one, as at a terminal."""

    linear_speed: float = 0.5
    """m/s."""
    angular_speed: float = 1.0
    """rad/s."""
    key: str = "k"
    """The last key that moves."""

    def press(self, key: str) -> bool:
        """Takes a key; any that is not known stops. Returns whether a Twist is to be sent."""
        if key in SPEEDS:
            linear, angular = SPEEDS[key]
            self.linear_speed *= linear
            self.angular_speed *= angular
            # A moving robot takes the new speed at once; one that stands is not sent a stop,
            # which would overrule whoever else drives it.
            return self.key != "k"
        self.key = key if key in MOVES else "k"
        return True

    @property
    def linear(self) -> float:
        """m/s along x."""
        return MOVES[self.key][0] * self.linear_speed

    @property
    def angular(self) -> float:
        """rad/s about z."""
        return MOVES[self.key][1] * self.angular_speed
