"""Suspensions: joints with a spring and a damper."""

from __future__ import annotations

from dataclasses import dataclass

from cartwheel.component import Component, Scope


@dataclass(frozen=True, kw_only=True, slots=True)
class SuspensionConfig:
    joints: tuple[str, ...]
    """Joints, whose springs are at rest at position 0."""
    stiffness: float
    """Stiffness of each spring, N m/rad."""
    damping: float
    """Damping of each joint, N m s/rad."""


class Suspension(Component):
    """Applies a spring and a damper to each of several joints.

    Raises:
        UnknownNameError: A joint does not exist.
    """

    def __init__(self, scope: Scope, config: SuspensionConfig) -> None:
        super().__init__(scope)
        part, origin = self.part, self.origin
        self._config = config
        self._joints = [
            (part.joint(name, origin=origin), part.servo(name, max_effort=None, origin=origin))
            for name in config.joints
        ]
        part.schedule(0, before=self._apply)

    def _apply(self) -> None:
        for joint, servo in self._joints:
            effort = -self._config.stiffness * joint.position
            servo.command_effort(effort, damping=self._config.damping)
