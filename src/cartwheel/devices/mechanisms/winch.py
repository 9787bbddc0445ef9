"""Ropes from which links are suspended, and a winch that winds one of them."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any, Literal

import numpy as np

from cartwheel.codes import running
from cartwheel.component import Component, Scope
from cartwheel.devices.elementwise import Number, clamp
from cartwheel.errors import Origin
from cartwheel.geometry import Array, Vec3, rotate
from cartwheel.simulation.dynamics.fixed_joints import AttachmentHandle
from cartwheel.simulation.handles import LinkHandle


@dataclass(frozen=True, kw_only=True, slots=True)
class RopeConfig:
    """Configuration of a rope."""

    link: str
    """Link that hangs from the rope."""
    axis: Vec3
    """Direction of the rope in the link frame, of length 1."""
    limits: tuple[float, float]
    """Lowest and highest position of the rope's end relative to the position at the start, m."""
    origin: Origin | None = None
    """File and line of the rope."""


@dataclass(frozen=True, kw_only=True, slots=True)
class WinchConfig:
    ropes: tuple[RopeConfig, ...]
    wound: int | None
    """Index of the rope that the winch winds. None: there is no winch."""
    detachable: int | None
    """Index of the rope that a message detaches. None: no rope can be detached."""
    velocity: float
    """Initial velocity of the winch, m/s. Positive velocities wind the rope up."""
    velocity_topic: str
    """Topic of the winch's velocity in m/s, as Float32."""
    detach_topic: str
    """Topic of the messages that detach a rope."""
    detach_type: Literal["std_msgs/msg/Bool", "std_msgs/msg/Empty"]
    """A Bool detaches the rope if it is true, an Empty always."""


class Winch(Component):
    """Suspends links from the world by ropes, and raises and lowers one of them with a winch.

    A rope pulls, but does not push. A taut rope holds its link rigidly.

    Args:
        scope: The winch's model and names.
        config: Ropes and topics.

    Raises:
        UnknownNameError: A link does not exist.
    """

    def __init__(self, scope: Scope, config: WinchConfig) -> None:
        super().__init__(scope)
        self._config = config
        self._ropes = [
            _Rope(
                link=self.part.link(rope.link, origin=rope.origin),
                joint=self.part.attachment(),
                config=rope,
            )
            for rope in config.ropes
        ]
        self.wound = None if config.wound is None else self._ropes[config.wound]
        self._detachable = None if config.detachable is None else self._ropes[config.detachable]
        self.subscribe(config.velocity_topic, "std_msgs/msg/Float32", self._on_velocity)
        self.subscribe(config.detach_topic, config.detach_type, self._on_detach)
        self._suspended = False
        self._velocity = config.velocity
        self._last_ns = self.part.time_ns
        self.part.schedule(0, before=self._hold)

    def reset(self) -> None:
        super().reset()
        for rope in self._ropes:
            rope.joint.release()
        self._suspended = False
        self._velocity = self._config.velocity
        self._last_ns = self.part.time_ns

    def _on_velocity(self, message: Any) -> None:
        if self.wound is None:
            self.warn(running.COMMAND_IGNORED, "a command is ignored: the harness has no <winch>")
        else:
            self._velocity = float(message.data)

    def _on_detach(self, message: Any) -> None:
        if not getattr(message, "data", True):
            return
        rope = self._detachable
        if rope is None or not rope.attached:
            self.warn(
                running.ATTACHMENT_FAILED,
                "a command is ignored: the harness has no attached joint to detach",
            )
        else:
            rope.attached = False
            rope.joint.release()

    def _hold(self) -> None:
        seconds = (self.part.time_ns - self._last_ns) * 1e-9
        self._last_ns = self.part.time_ns
        self.part.locate()
        if not self._suspended:
            self._suspended = True
            for rope in self._ropes:
                rope.attach(self.part.name)
        for rope in self._ropes:
            if rope.attached:
                wound = self._velocity * seconds if rope is self.wound else 0.0
                rope.move(self.part.name, rope_end(rope.end, rope.start, rope.config.limits, wound))


@dataclass(kw_only=True, slots=True)
class _Rope:
    link: LinkHandle
    joint: AttachmentHandle
    config: RopeConfig
    attached: bool = False
    axis: Array = field(default_factory=lambda: np.zeros(3))
    """In the world, at the time of attachment."""
    start: float = 0.0
    end: float = 0.0
    """Positions along the axis, m: the link's at attachment, and the rope's end."""

    @property
    def position(self) -> float:
        """Position of the link along the axis, m."""
        return float(np.dot(self.link.place()[0], self.axis))

    def attach(self, model: str) -> None:
        """Suspends the link at its present position."""
        self.joint.hold(None, (model, self.link.name))
        _, orientation = self.link.place()
        self.axis = np.array(rotate(orientation, self.config.axis))
        self.start = self.end = self.position
        self.attached = True

    def move(self, model: str, end: float) -> None:
        """Moves the rope's end, and updates whether the rope is slack or taut."""
        distance = end - self.end
        self.end += distance
        joint = self.joint
        if joint.held is None:
            if self.position > self.end:
                return
            joint.hold(None, (model, self.link.name))
            distance = self.end - self.position
        elif float(np.dot(joint.force(), self.axis)) < 0:
            joint.release()
            return
        if distance:
            x, y, z = (distance * self.axis).tolist()
            joint.shift((x, y, z))


def rope_end(end: Number, start: Number, limits: tuple[float, float], wound: Number) -> Number:
    """Returns the position of a rope's end after it is wound up, m.

    Args:
        end: The present position, m.
        start: The position at which the rope was attached, m.
        limits: Lowest and highest position relative to the start, m.
        wound: Length that is wound up, m; negative: lowered.
    """
    return clamp(end + wound, start + limits[0], start + limits[1])
