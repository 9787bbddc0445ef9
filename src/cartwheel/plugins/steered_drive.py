"""What drives with steered wheels share: the command, and the ramp of an angle."""

from __future__ import annotations

from cartwheel.plugins.drive import Drive


def toward(value: float, target: float, most: float) -> float:
    """A value moved towards a target by at most `most`."""
    return value + min(max(target - value, -most), most)


class SteeredDrive(Drive):
    """Keeps the command; a subclass steers in `_turn_wheels`."""

    def reset(self) -> None:
        super().reset()
        self._forward = self._turn = 0.0
        """The command: m/s, and rad or rad/s as the drive takes it."""

    def _aim(self, forward: float, turn: float) -> None:
        self._forward, self._turn = forward, turn
