"""Forces that are applied to links."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from cartwheel.codes import running
from cartwheel.component import Component, Scope
from cartwheel.devices.elementwise import Number, sqrt
from cartwheel.devices.transforms import TF_MESSAGE, transform_stamped
from cartwheel.errors import PluginError
from cartwheel.geometry import Array, Quat, quat_conjugate, quat_multiply, rotate
from cartwheel.graph.frames import Frames
from cartwheel.messages import header, message_class

_WORLD = "world"


@dataclass(frozen=True, kw_only=True, slots=True)
class CommandedWrenchConfig:
    link: str
    """Link to which the wrench is applied, at its centre of mass."""
    topic: str
    """Topic of the Wrench messages."""
    in_link: bool
    """Whether the commanded vectors are in the link frame instead of the world frame."""


class CommandedWrench(Component):
    """Applies the last received force and torque to a link.

    Args:
        scope: The link's model and names.
        config: Link and topic.

    Raises:
        UnknownNameError: The link does not exist.
    """

    def __init__(self, scope: Scope, config: CommandedWrenchConfig) -> None:
        super().__init__(scope)
        self._in_link = config.in_link
        self._link = self.part.link(config.link, origin=self.origin)
        self._applied = self.part.wrench(config.link, origin=self.origin)
        self._commanded: tuple[list[float], list[float]] | None = None
        self.subscribe(config.topic, "geometry_msgs/msg/Wrench", self._on_wrench)
        if config.in_link:
            self.part.schedule(0, before=self._rotate)

    def reset(self) -> None:
        """Discards the command."""
        super().reset()
        self._commanded = None

    def _on_wrench(self, message: Any) -> None:
        force, torque = message.force, message.torque
        self._commanded = ([force.x, force.y, force.z], [torque.x, torque.y, torque.z])
        if not self._in_link:
            self._applied.apply(*self._commanded)

    def _rotate(self) -> None:
        if self._commanded is not None:
            _, orientation = self._link.place()
            self._applied.apply(*(rotate(orientation, vector) for vector in self._commanded))


@dataclass(frozen=True, kw_only=True, slots=True)
class FrameSpringConfig:
    link: str
    """Link to pull. Gravity does not act on it."""
    target: str
    """Frame to which the link is pulled."""
    actual: str
    """Frame that is published at the link."""
    stiffness: float
    """Stiffness of the linear spring, N/m."""
    half_angle_stiffness: float
    """Torque per half of the angle, N m/rad."""


class FrameSpring(Component):
    """Pulls a link to a tf frame with a critically damped spring, and publishes its pose.

    Until tf provides the target, the link is not pulled.

    Args:
        scope: The link's model and names.
        config: Link, frames and stiffness.

    Raises:
        UnknownNameError: The link does not exist.
        PluginError: The link has no mass.
    """

    def __init__(self, scope: Scope, config: FrameSpringConfig) -> None:
        super().__init__(scope)
        part, origin = self.part, self.origin
        self._config = config
        self._link = part.link(config.link, origin=origin)
        described = part.description.link(config.link)
        if described is None or described.inertial is None:
            raise PluginError(
                f'link "{config.link}" has no mass, so it cannot be pulled',
                code=running.MODEL_NOT_MOVABLE,
                origin=origin,
                values={"link": config.link},
            )
        self._applied = part.wrench(config.link, origin=origin)
        self._frames = self.keep(Frames(self.graph, self.node))
        self._TFMessage = message_class(TF_MESSAGE)
        self._publisher = self.advertise("/tf", TF_MESSAGE)
        part.schedule(0, before=self._pull)
        part.schedule(0, after=self._publish, topics=self.publishers)

    def reset(self) -> None:
        """Removes the target."""
        super().reset()
        self._frames.forget()

    def _pull(self) -> None:
        link, config = self._link, self._config
        weight = np.array(self.part.world.gravity) * link.mass
        target = self._frames.pose(config.target, _WORLD)
        if target is None:
            self._applied.apply((-weight).tolist(), (0.0, 0.0, 0.0))
            return
        # A stiff spring that uses the state of the previous step is unstable.
        self.part.locate()
        place, orientation = link.place()
        linear, _ = link.motion(local=False)
        _, angular = link.motion(local=True)
        seconds = self.part.period_ns(0) * 1e-9
        force = spring_force(
            np.subtract(target.position, place),
            np.array(linear),
            config.stiffness,
            link.mass,
            seconds,
        )
        error = half_rotation(quat_multiply(quat_conjugate(orientation), target.orientation))
        # All axes are damped equally, with the inertia about the first axis.
        torque = spring_force(
            error, np.array(angular), config.half_angle_stiffness, float(link.inertia[0]), seconds
        )
        self._applied.apply((force - weight).tolist(), rotate(orientation, torque.tolist()))

    def _publish(self) -> None:
        # This device also receives this transform, which has no effect because its parent is the
        # world.
        moment = header(self.part.time_ns, _WORLD)
        transform = transform_stamped(moment, self._config.actual, *self._link.place())
        self._publisher.publish(self._TFMessage([transform]))


def spring_force(
    error: Number, speed: Number, stiffness: Number, inertia: Number, seconds: float
) -> Number:
    """Returns the force of a critically damped spring, integrated implicitly for stability.

    Args:
        error: Distance to the target, m or rad.
        speed: m/s or rad/s.
        stiffness: N/m or N m/rad.
        inertia: kg or kg m².
        seconds: Length of a step.
    """
    damping = 2.0 * sqrt(stiffness * inertia)
    slowed = 1.0 + (damping + stiffness * seconds) * seconds / inertia
    return (stiffness * (error - speed * seconds) - damping * speed) / slowed


def half_rotation(turn: Sequence[float] | Quat) -> Array:
    """Returns half the rotation vector of the shorter rotation, rad, shape (3,)."""
    x, y, z, w = turn
    vector = np.array([x, y, z]) * (1.0 if w >= 0 else -1.0)
    length = float(np.linalg.norm(vector))
    if length < 1e-12:
        return vector
    angle: Array = math.atan2(length, abs(w)) / length * vector
    return angle
