"""Resolves the models, links, joints and lights in requests, and their poses."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np

from cartwheel.codes.graph import ENTITY_AMBIGUOUS, ENTITY_UNKNOWN
from cartwheel.description.model import Joint, Light, Link, RobotDescription
from cartwheel.errors import GraphError, UnknownNameError
from cartwheel.geometry import Pose, Vec3, cross, quat_conjugate, rotate
from cartwheel.similar_names import suggestion
from cartwheel.simulation import LinkHandle, PlacedModel, Simulation
from cartwheel.world.entry import scoped

INERTIAL = ("", "world", "map", "/map", "/world")
"""Names that Gazebo accepts for the world frame."""

_ORIGIN = Pose()


@dataclass(frozen=True, slots=True)
class Motion:
    """The pose and velocity of a frame in the world."""

    pose: Pose = _ORIGIN
    linear: Vec3 = (0.0, 0.0, 0.0)
    """Velocity of the origin, m/s, in world axes."""
    angular: Vec3 = (0.0, 0.0, 0.0)
    """rad/s, in world axes."""

    def carried(self, offset: Pose) -> Motion:
        """The motion of a frame fixed to this frame at `offset`."""
        place = self.pose @ offset
        arm = np.subtract(place.position, self.pose.position)
        vx, vy, vz = (np.asarray(self.linear) + cross(self.angular, arm)).tolist()
        return Motion(place, (vx, vy, vz), self.angular)

    def seen_from(self, frame: Motion) -> Motion:
        """Relative pose and velocity in another frame's axes.

        The frame's rotation adds no velocity. Source: gazebo_ros, ``GetModelState``.
        """
        back = quat_conjugate(frame.pose.orientation)
        linear, angular = (
            np.subtract(self.linear, frame.linear).tolist(),
            np.subtract(self.angular, frame.angular).tolist(),
        )
        return Motion(frame.pose.inverse() @ self.pose, rotate(back, linear), rotate(back, angular))


class Entities:
    """Resolves names in requests. Use it on the simulation's thread.

    Links and joints are specified as ``model::link``. A short name works if it is unique among all
    models.
    """

    def __init__(self, simulation: Simulation) -> None:
        self._simulation = simulation

    @property
    def placed(self) -> tuple[PlacedModel, ...]:
        """The models in the world."""
        return self._simulation.scene.models

    def model(self, name: str) -> RobotDescription:
        """The description of a model.

        Raises:
            UnknownNameError: The model does not exist.
        """
        for placed in self.placed:
            if placed.name == name:
                return placed.description
        raise UnknownNameError(
            "model", name, [placed.name for placed in self.placed], code=ENTITY_UNKNOWN
        )

    def link(self, name: str) -> tuple[str, Link]:
        """A link and the name of its model.

        Raises:
            UnknownNameError: The link does not exist.
            GraphError: Several models have a link with this name.
        """
        model, link = self._find("link", name, {m.name: m.description.links for m in self.placed})
        assert isinstance(link, Link)
        return model, link

    def joint(self, name: str) -> tuple[str, Joint]:
        """A joint and the name of its model; raises the same errors as `link`."""
        model, joint = self._find(
            "joint", name, {m.name: m.description.joints for m in self.placed}
        )
        assert isinstance(joint, Joint)
        return model, joint

    def light(self, name: str) -> Light:
        """A light in the world.

        Raises:
            UnknownNameError: The light does not exist.
        """
        lights = self._simulation.world.lights
        for light in lights:
            if light.name == name:
                return light
        raise UnknownNameError("light", name, [light.name for light in lights], code=ENTITY_UNKNOWN)

    def _find(
        self,
        kind: str,
        name: str,
        by_model: dict[str, tuple[Link, ...]] | dict[str, tuple[Joint, ...]],
    ) -> tuple[str, Link | Joint]:
        every = [(model, part) for model, parts in by_model.items() for part in parts]
        for model, part in every:
            if scoped(model, part.name) == name:
                return model, part
        alike = [(model, part) for model, part in every if part.name == name]
        if len(alike) == 1:
            return alike[0]
        if alike:
            names = ", ".join(scoped(model, part.name) for model, part in alike)
            raise GraphError(
                f'several models contain a {kind} named "{name}"',
                code=ENTITY_AMBIGUOUS,
                hint=f"Use one of these names: {names}.",
                values={"kind": kind, "name": name},
            )
        if name in by_model:
            parts = [scoped(name, part.name) for model, part in every if model == name]
            raise GraphError(
                f'"{name}" is a model, not a {kind}',
                code=ENTITY_AMBIGUOUS,
                hint=suggestion("", parts),
                values={"kind": kind, "name": name},
            )
        raise UnknownNameError(kind, name, _spelled_alike(name, every), code=ENTITY_UNKNOWN)

    def frame(self, name: str) -> Motion:
        """The frame of the world, a model or a link, from the last forward pass.

        Raises:
            GraphError: The frame does not exist.
        """
        if name in INERTIAL:
            return Motion()
        if any(placed.name == name for placed in self.placed):
            return self.model_motion(name)
        try:
            model, link = self.link(name)
        except UnknownNameError as error:
            names = [placed.name for placed in self.placed]
            names += [scoped(*pair) for pair in self._simulation.scene.links]
            raise UnknownNameError("reference frame", name, names, code=ENTITY_UNKNOWN) from error
        return self.link_motion(model, link.name)

    def link_motion(self, model: str, link: str) -> Motion:
        """Motion of a link's frame, from the last forward pass."""
        handle = LinkHandle(model, link)
        handle.bind(self._simulation.model, self._simulation.data)
        return Motion(handle.pose, *handle.motion(local=False))

    def model_motion(self, model: str) -> Motion:
        """Motion of a model's frame, which is fixed to its canonical link, from the last forward
        pass.
        """
        description = self.model(model)
        link = self.link_motion(model, description.canonical_link)
        return link.carried(description.canonical_pose.inverse())

    def model_acceleration(self, name: str) -> tuple[Vec3, Vec3]:
        """Acceleration of a model's frame in world axes, m/s² and rad/s², from the last forward
        pass.
        """
        description = self.model(name)
        handle = LinkHandle(name, description.canonical_link)
        handle.bind(self._simulation.model, self._simulation.data)
        return handle.acceleration(description.canonical_pose.inverse().position)


def _spelled_alike(name: str, every: Iterable[tuple[str, Link | Joint]]) -> list[str]:
    """Scoped names if the requested name is scoped, otherwise short names."""
    if "::" in name:
        return [scoped(model, part.name) for model, part in every]
    return [part.name for _, part in every]
