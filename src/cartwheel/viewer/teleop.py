"""Driving with the keys and speeds of ROS's teleop_twist_keyboard."""

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
"""By key: linear and angular direction, as factors of the two speeds."""

SPEEDS: dict[str, tuple[float, float]] = {
    "q": (1.1, 1.1),
    "z": (0.9, 0.9),
    "w": (1.1, 1.0),
    "x": (0.9, 1.0),
    "e": (1.0, 1.1),
    "c": (1.0, 0.9),
}
"""By key: factors of the linear and the angular speed."""

KEYS = (*MOVES, *SPEEDS)


@dataclass(slots=True)
class Teleop:
    """The state set by the keys. As in a terminal, a key is active until the next one."""

    linear_speed: float = 0.5
    """m/s."""
    angular_speed: float = 1.0
    """rad/s."""
    key: str = "k"
    """The last movement key."""

    def press(self, key: str) -> bool:
        """Handles a key; unknown keys stop. Returns whether to publish a Twist."""
        if key in SPEEDS:
            linear, angular = SPEEDS[key]
            self.linear_speed *= linear
            self.angular_speed *= angular
            # A moving robot gets the new speed at once. A stationary robot gets no stop command,
            # which could interrupt a different driver.
            return self.key != "k"
        self.key = key if key in MOVES else "k"
        return True

    @property
    def linear(self) -> float:
        """Velocity along x, m/s."""
        return MOVES[self.key][0] * self.linear_speed

    @property
    def angular(self) -> float:
        """Angular velocity about z, rad/s."""
        return MOVES[self.key][1] * self.angular_speed
