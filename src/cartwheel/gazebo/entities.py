"""The models, links, joints and lights that requests name, and where they are."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np

from cartwheel.codes.graph import ENTITY_AMBIGUOUS, ENTITY_UNKNOWN
from cartwheel.description.model import Joint, Light, Link, RobotDescription
from cartwheel.errors import GraphError, UnknownNameError, suggestion
from cartwheel.geometry import Pose, Vec3, quat_conjugate, rotate
from cartwheel.simulation import LinkHandle, PlacedModel, Simulation
from cartwheel.world.entry import scoped

INERTIAL = ("", "world", "map", "/map", "/world")
"""Names of the world's own frame, as Gazebo takes them."""

_ORIGIN = Pose()


@dataclass(frozen=True, slots=True)
class Motion:
    """Where a frame is in the world and how it moves there."""

    pose: Pose = _ORIGIN
    linear: Vec3 = (0.0, 0.0, 0.0)
    """m/s, of its origin, in the world's axes."""
    angular: Vec3 = (0.0, 0.0, 0.0)
    """rad/s, in the world's axes."""

    def carried(self, offset: Pose) -> Motion:
        """The motion of a frame that is fixed to this one at `offset`."""
        place = self.pose @ offset
        arm = np.subtract(place.position, self.pose.position)
        vx, vy, vz = (np.asarray(self.linear) + np.cross(self.angular, arm)).tolist()
        return Motion(place, (vx, vy, vz), self.angular)

    def seen_from(self, frame: Motion) -> Motion:
        """In another frame: the differences of place and speed, in that frame's axes.

        Source: gazebo_ros, ``GetModelState``; the turning of the frame moves nothing in it.
        """
        back = quat_conjugate(frame.pose.orientation)
        linear, angular = (
            np.subtract(self.linear, frame.linear).tolist(),
            np.subtract(self.angular, frame.angular).tolist(),
        )
        return Motion(frame.pose.inverse() @ self.pose, rotate(back, linear), rotate(back, angular))


class Entities:
    """Finds what a request names; for the simulation's thread alone.

    A link or joint is named as ``model::link``; its own name does where no other model has one
    of that name.
    """

    def __init__(self, simulation: Simulation) -> None:
        self._simulation = simulation

    @property
    def placed(self) -> tuple[PlacedModel, ...]:
        """The models of the world."""
        return self._simulation.scene.models

    def model(self, name: str) -> RobotDescription:
        """The description of a model.

        Raises:
            UnknownNameError: There is no such model.
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
            UnknownNameError: There is no such link.
            GraphError: Several models have one of that name.
        """
        model, link = self._find("link", name, {m.name: m.description.links for m in self.placed})
        assert isinstance(link, Link)
        return model, link

    def joint(self, name: str) -> tuple[str, Joint]:
        """A joint and the name of its model; errors as those of `link`."""
        model, joint = self._find(
            "joint", name, {m.name: m.description.joints for m in self.placed}
        )
        assert isinstance(joint, Joint)
        return model, joint

    def light(self, name: str) -> Light:
        """A light of the world.

        Raises:
            UnknownNameError: There is none of that name.
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
        """The frame of the world, a model or a link, as of the last forward pass.

        Raises:
            GraphError: There is none of that name.
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
        """Of a link's frame, as of the last forward pass."""
        handle = LinkHandle(model, link)
        handle.bind(self._simulation.model, self._simulation.data)
        return Motion(handle.pose, *handle.motion(local=False))

    def model_motion(self, model: str) -> Motion:
        """Of a model's frame, which goes with its canonical link, as of the last forward pass."""
        description = self.model(model)
        link = self.link_motion(model, description.canonical_link)
        return link.carried(description.canonical_pose.inverse())

    def model_acceleration(self, name: str) -> tuple[Vec3, Vec3]:
        """m/s² and rad/s² of a model's frame in the world's axes, as of the last forward pass."""
        description = self.model(name)
        handle = LinkHandle(name, description.canonical_link)
        handle.bind(self._simulation.model, self._simulation.data)
        return handle.acceleration(description.canonical_pose.inverse().position)


def _spelled_alike(name: str, every: Iterable[tuple[str, Link | Joint]]) -> list[str]:
    """Scoped names where a scoped one was asked for; else the parts' own."""
    if "::" in name:
        return [scoped(model, part.name) for model, part in every]
    return [part.name for _, part in every]
