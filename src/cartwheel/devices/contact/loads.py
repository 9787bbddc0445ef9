"""Forces and torques on links and joints, without a topic."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal, Protocol

import numpy as np

from cartwheel.codes import devices
from cartwheel.devices.noise import VectorNoise, VectorNoiseConfig
from cartwheel.errors import Origin, UnknownNameError
from cartwheel.geometry import (
    IDENTITY,
    Quat,
    matrix_from_quat,
    quat_conjugate,
    quat_multiply,
    rotate,
)
from cartwheel.simulation import LinkHandle, Part


class Load(Protocol):
    """A force and a torque that can be measured."""

    def measure(self) -> Sequence[float]:
        """Returns the force in N, then the torque in N m."""


@dataclass(frozen=True, kw_only=True, slots=True)
class LinkLoadConfig:
    """Measures the force and torque of contacts, attachments and applied wrenches on a link.

    The torque is about the link's centre of mass. Both vectors are in the world frame.
    """

    link: str
    """The link."""

    def load(self, part: Part, origin: Origin | None) -> Load:
        """Creates the measurement; `origin` is the place of the error about an unknown link."""
        return _LinkLoad(part, self, origin)


class _LinkLoad:
    def __init__(self, part: Part, config: LinkLoadConfig, origin: Origin | None) -> None:
        self._link = part.link(config.link, origin=origin)
        part.feel(config.link)

    def measure(self) -> Sequence[float]:
        force, torque = self._link.load()
        return [*force.tolist(), *torque.tolist()]


@dataclass(frozen=True, kw_only=True, slots=True)
class ContactForceConfig:
    """Measures the sum of the contact forces on collisions, in a link's frame; without torque."""

    link: str
    """The link."""
    collisions: frozenset[str]
    """The collisions, ``link::collision``."""

    def load(self, part: Part, origin: Origin | None) -> Load:
        """Creates the measurement; `origin` is the place of the error about an unknown link."""
        return _ContactForce(part, self, origin)


class _ContactForce:
    def __init__(self, part: Part, config: ContactForceConfig, origin: Origin | None) -> None:
        self._part, self._collisions = part, config.collisions
        self._link = part.link(config.link, origin=origin)

    def measure(self) -> Sequence[float]:
        forces = [contact.force for contact in self._part.contacts(self._collisions)]
        total = np.sum(forces, axis=0) if forces else np.zeros(3)
        _, orientation = self._link.place()
        return [*rotate(quat_conjugate(orientation), total.tolist()), 0.0, 0.0, 0.0]


@dataclass(frozen=True, kw_only=True, slots=True)
class JointReactionConfig:
    """Measures the force and torque that a joint's child link exerts on its parent link.

    The torque is about the joint. Both vectors are in the child link's frame.
    """

    joint: str
    """The joint. It can be fixed."""

    def load(self, part: Part, origin: Origin | None) -> Load:
        """Creates the measurement; `origin` is the place of the error about an unknown joint."""
        reaction = JointReaction(part, self.joint, origin=origin)
        part.feel(reaction.child.name)
        return reaction


class JointReaction:
    """Measures the reaction of a joint; see `JointReactionConfig`.

    Args:
        part: The model's part of the simulation.
        name: Name of the joint.
        origin: File and line for the error about an unknown joint.

    Raises:
        UnknownNameError: The joint does not exist.
    """

    def __init__(self, part: Part, name: str, *, origin: Origin | None = None) -> None:
        description = part.description
        joint = description.joint(name)
        if joint is None:
            raise UnknownNameError(
                "joint",
                name,
                [each.name for each in description.joints],
                code=devices.PLUGIN_JOINT_UNKNOWN,
                origin=origin,
            )
        self.child = part.link(joint.child)
        known = description.link(joint.parent) is not None
        self.parent = part.link(joint.parent) if known else None
        """None: the world."""
        self._anchor = joint.pose.position

    def measure(self) -> list[float]:
        """Returns the force in N, then the torque in N m about the joint."""
        force, torque = self.child.reaction(self._anchor)
        return [*force.tolist(), *torque.tolist()]


Axes = Literal["child", "parent", "sensor"]


@dataclass(frozen=True, kw_only=True, slots=True)
class JointLoadConfig:
    joint: str
    """The joint. It can be fixed."""
    axes: Axes
    """Frame of both vectors: the child link, the parent link or the sensor."""
    rotation: Quat
    """Orientation of the sensor in the child link."""
    parent_to_child: bool
    """Measure the wrench of the parent on the child instead of the reaction."""
    noise: VectorNoiseConfig
    """Noise on the force, N, and on the torque, N m."""

    def load(self, part: Part, origin: Origin | None) -> Load:
        """Creates the measurement; `origin` is the place of the error about an unknown joint."""
        load = JointLoad(part, self, origin=origin)
        part.feel(load.child.name)
        return load


class JointLoad:
    """Measures the force and torque on a joint, in selectable axes and with noise.

    Args:
        part: The model's part of the simulation.
        config: Joint, axes and noise.
        origin: File and line for the error about an unknown joint.

    Raises:
        UnknownNameError: The joint does not exist.
    """

    def __init__(
        self, part: Part, config: JointLoadConfig, *, origin: Origin | None = None
    ) -> None:
        self._reaction = JointReaction(part, config.joint, origin=origin)
        self._axes = config.axes
        self._sign = -1.0 if config.parent_to_child else 1.0
        self._to_sensor = quat_conjugate(config.rotation)
        self._noise = VectorNoise(part, config.noise)

    @property
    def child(self) -> LinkHandle:
        """The joint's child link."""
        return self._reaction.child

    def measure(self) -> list[float]:
        """Returns the force in N, then the torque in N m about the joint."""
        measured = self._reaction.measure()
        matrix = self._sign * matrix_from_quat(self._rotation())
        force, torque = np.array(measured[:3]), np.array(measured[3:])
        both = [*(matrix @ force).tolist(), *(matrix @ torque).tolist()]
        return list(self._noise.add(both))

    def _rotation(self) -> Quat:
        """Rotation from the child link's axes to those of the measurement."""
        if self._axes == "sensor":
            return self._to_sensor
        if self._axes == "child":
            return IDENTITY
        parent = self._reaction.parent
        back = quat_conjugate(parent.place()[1]) if parent is not None else IDENTITY
        return quat_multiply(back, self.child.place()[1])
