"""Shared parts of drives with steered wheels: the command and the ramp of an angle."""

from __future__ import annotations

from cartwheel.dialects.drive import Drive


def toward(value: float, target: float, most: float) -> float:
    """Moves a value toward a target by at most `most`."""
    return value + min(max(target - value, -most), most)


class SteeredDrive(Drive):
    """Base class of drives with steered wheels. Stores the command for `_turn_wheels`."""

    def reset(self) -> None:
        super().reset()
        self._forward = self._turn = 0.0
        """The command: speed in m/s; steering angle in rad or yaw rate in rad/s, by drive."""

    def _aim(self, forward: float, turn: float) -> None:
        self._forward, self._turn = forward, turn
