"""An optical mouse, which measures the travel of a link."""

from __future__ import annotations

from dataclasses import dataclass

from cartwheel.component import Component, Scope
from cartwheel.geometry import Quat, Vec3, quat_conjugate, rotate
from cartwheel.messages import header, message_class

_MESSAGE = "irobot_create_msgs/msg/Mouse"


@dataclass(frozen=True, kw_only=True, slots=True)
class MouseConfig:
    link: str
    """Link whose travel is measured. Its name is the frame ID."""
    topic: str
    rate: float
    """Publish rate, Hz."""


class Mouse(Component):
    """Publishes the accumulated travel of a link along its own x and y axes, in m.

    Raises:
        UnknownNameError: The link does not exist.
    """

    def __init__(self, scope: Scope, config: MouseConfig) -> None:
        super().__init__(scope)
        self._link = self.part.link(config.link, origin=self.origin)
        self._Mouse = message_class(_MESSAGE)
        self._frame = self.frame(config.link)
        self._publisher = self.advertise(config.topic, _MESSAGE, rate=config.rate, qos="sensor")
        self.part.schedule(config.rate, after=self._publish)
        self.reset()

    def reset(self) -> None:
        super().reset()
        self._last_pose: tuple[Vec3, Quat] | None = None
        self._travel = [0.0, 0.0]

    def _publish(self) -> None:
        pose = self._link.place()
        if self._last_pose is not None:
            position, orientation = self._last_pose
            step = [a - b for a, b in zip(pose[0], position, strict=True)]
            x, y, _ = rotate(quat_conjugate(orientation), step)
            self._travel = [self._travel[0] + x, self._travel[1] + y]
        self._last_pose = pose
        if self._publisher.wanted:
            head = header(self.part.time_ns, self._frame)
            # The surface quality is always good, and tracking is never lost.
            self._publisher.publish(self._Mouse(head, *self._travel, frame_id=0, last_squal=90))
