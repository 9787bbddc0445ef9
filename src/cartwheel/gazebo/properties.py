"""Services for properties of links, joints, models, lights and the world."""

from __future__ import annotations

import dataclasses
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from cartwheel.codes.graph import PROPERTY_INVALID
from cartwheel.description.inertia import impossibility, principal_moments
from cartwheel.description.model import MOMENTS, Inertial, Joint, Light, RobotDescription
from cartwheel.errors import GraphError, WorldError
from cartwheel.gazebo.entities import Entities
from cartwheel.gazebo.requests import (
    Answer,
    Offer,
    camel,
    named,
    pose,
    pose_message,
    refused,
    vector,
)
from cartwheel.geometry import Pose
from cartwheel.messages import message_class
from cartwheel.simulation import Simulation
from cartwheel.simulation.limits import STRONGEST, number
from cartwheel.world.entry import scoped

_JOINT_TYPES = {
    "revolute": 0,
    "continuous": 1,
    "prismatic": 2,
    "fixed": 3,
    "ball": 4,
    "universal": 5,
}
_NO_TYPE = 255
_JOINT_FIELDS = (
    "damping",
    "hiStop",
    "loStop",
    "erp",
    "cfm",
    "stop_erp",
    "stop_cfm",
    "fudge_factor",
    "fmax",
    "vel",
)
_IN_ROS2 = {"hiStop": "hi_stop", "loStop": "lo_stop"}
_HEAVIEST = 1e9
"""Maximum, kg, kg m² or N m s/rad."""


class Properties:
    """The ``get_`` and ``set_`` services of properties.

    Changes become part of the model's description, so they persist when other models are spawned or
    deleted, and after a reset. Source: gazebo_ros, gazebo_ros_api_plugin; gazebo_ros_properties.
    """

    def __init__(self, simulation: Simulation, entities: Entities) -> None:
        self._simulation = simulation
        self._entities = entities

    def offers(self) -> list[Offer]:
        """The ROS 1 services."""
        return named(
            self.get_model_properties,
            self.get_world_properties,
            self.get_link_properties,
            self.set_link_properties,
            self.get_joint_properties,
            self.set_joint_properties,
            self.get_light_properties,
            self.set_light_properties,
        )

    def ros2_offers(self) -> list[Offer]:
        """The ROS 2 services: some of the ROS 1 services, with separate types if they differ."""
        own = [
            Offer(name, f"{package}/srv/{camel(name)}", handler)
            for name, package, handler in (
                ("get_model_properties", "gazebo_msgs", self.get_scoped_properties),
                ("set_joint_properties", "gazebo_msgs_ros2", self.set_joint_properties),
                ("set_light_properties", "gazebo_msgs_ros2", self.set_light),
            )
        ]
        without = {"get_world_properties", *(offer.name for offer in own)}
        return [*own, *(offer for offer in self.offers() if offer.name not in without)]

    def get_scoped_properties(self, request: Any) -> Answer:
        """The ROS 2 response, in which link names include the model's name."""
        answer = self.get_model_properties(request)
        model, reported = request.model_name, answer.fields
        reported["canonical_body_name"] = scoped(model, reported["canonical_body_name"])
        reported["body_names"] = [scoped(model, name) for name in reported["body_names"]]
        return answer

    def get_model_properties(self, request: Any) -> Answer:
        description = self._entities.model(request.model_name)
        links = description.links
        fields = {
            "parent_model_name": "",
            "canonical_body_name": description.canonical_link,
            "body_names": [link.name for link in links],
            "geom_names": [collision.name for link in links for collision in link.collisions],
            "joint_names": [joint.name for joint in description.joints],
            "child_model_names": _nested(description),
            "is_static": description.static,
        }
        return Answer("GetModelProperties: got properties", fields)

    def get_world_properties(self, request: Any) -> Answer:  # noqa: ARG002 - it is empty
        fields = {
            "sim_time": self._simulation.time_ns / 1e9,
            "model_names": list(self._simulation.models),
            "rendering_enabled": True,
        }
        return Answer("GetWorldProperties: got properties", fields)

    # -- links

    def get_link_properties(self, request: Any) -> Answer:
        _, link = self._entities.link(request.link_name)
        fields: dict[str, Any] = {"gravity_mode": link.gravity}
        inertial = link.inertial
        if inertial is None:
            fields["com"] = pose_message(Pose())
            return Answer("GetLinkProperties: got properties", fields, ("the link has no mass",))
        fields |= {name: getattr(inertial, name) for name in ("mass", *MOMENTS)}
        fields["com"] = pose_message(inertial.pose)
        return Answer("GetLinkProperties: got properties", fields)

    def set_link_properties(self, request: Any) -> Answer:
        model, link = self._entities.link(request.link_name)
        values = {
            name: number(getattr(request, name), name, most=_HEAVIEST)
            for name in ("mass", *MOMENTS)
        }
        com = pose(request.com, "com")
        inertial = None
        if link.inertial is not None or any(values.values()):
            if values["mass"] <= 0:
                raise refused(
                    f"the mass must be above 0 (got {values['mass']:g})",
                    "mass",
                    value=values["mass"],
                )
            water = link.inertial.added_mass if link.inertial is not None else ()
            inertial = Inertial(pose=com, added_mass=water, origin=link.origin, **values)
            moments = principal_moments(inertial.diagonal, inertial.products)
            if (reason := impossibility(moments)) is not None:
                raise GraphError(
                    reason[0], code=PROPERTY_INVALID, hint=reason[1], values={"property": "inertia"}
                )
        changed = dataclasses.replace(link, inertial=inertial, gravity=bool(request.gravity_mode))
        description = self._entities.model(model)
        if changed != link:
            links = tuple(changed if each is link else each for each in description.links)
            self._simulation.redescribe(model, dataclasses.replace(description, links=links))
        notes = ("the model is static, so its links do not move",) if description.static else ()
        return Answer("SetLinkProperties: properties set", notes=notes)

    # -- joints

    def get_joint_properties(self, request: Any) -> Answer:
        model, joint = self._entities.joint(request.joint_name)
        positions, rates = self._simulation.engine.joint_state(model, joint.name)
        axes = [joint.axis] if joint.axis2 is None else [joint.axis, joint.axis2]
        fields = {
            "type": _JOINT_TYPES.get(joint.type, _NO_TYPE),
            "damping": np.array([axis.damping for axis in axes] if positions else []),
            "position": np.array(positions),
            "rate": np.array(rates),
        }
        notes: tuple[str, ...] = ()
        if joint.type not in _JOINT_TYPES:
            notes = (
                f"the field type is {_NO_TYPE}: Gazebo defines no number for a {joint.type} joint",
            )
        return Answer("GetJointProperties: got properties", fields, notes)

    def set_joint_properties(self, request: Any) -> Answer:
        model, joint = self._entities.joint(request.joint_name)
        config = request.ode_joint_config
        given = {
            field: [
                number(v, f"ode_joint_config.{name}", most=1e308) for v in getattr(config, name)
            ]
            for field in _JOINT_FIELDS
            for name in (field if hasattr(config, field) else _IN_ROS2[field],)
        }
        changed, notes = _joint_with(joint, given)
        driven = {field: given[field][0] for field in ("fmax", "vel") if given[field]}
        for field, value in driven.items():
            number(value, f"ode_joint_config.{field}", most=STRONGEST)
        if driven.get("fmax", 0.0) < 0:
            raise refused(
                f"fmax must not be negative (got {driven['fmax']:g})", "fmax", value=driven["fmax"]
            )
        if changed != joint:
            description = self._entities.model(model)
            joints = tuple(changed if each is joint else each for each in description.joints)
            self._simulation.redescribe(model, dataclasses.replace(description, joints=joints))
        if driven:
            notes += self._drive(model, joint, driven)
        return Answer("SetJointProperties: properties set", notes=tuple(notes))

    def _drive(self, model: str, joint: Joint, driven: Mapping[str, float]) -> list[str]:
        """ODE's joint motor: at most fmax to reach vel. Returns the parameters without effect."""
        if (model, joint.name) not in self._simulation.scene.joints:
            return [
                "fmax and vel have no effect because the joint does not move or has more than "
                "one axis"
            ]
        try:
            self._simulation.drive(
                model, joint.name, velocity=driven.get("vel"), max_effort=driven.get("fmax")
            )
        except WorldError as error:
            return [f"fmax and vel have no effect: {error.message}"]
        if driven.get("vel") and not self._simulation.driven(model, joint.name):
            return ["vel has no effect because a plugin drives the joint or fmax is 0"]
        return []

    # -- lights

    def get_light_properties(self, request: Any) -> Answer:
        light = self._entities.light(request.light_name)
        constant, linear, quadratic = light.attenuation
        fields = {
            "diffuse": message_class("std_msgs/msg/ColorRGBA")(*light.diffuse),
            "attenuation_constant": constant,
            "attenuation_linear": linear,
            "attenuation_quadratic": quadratic,
        }
        return Answer("GetLightProperties: got properties", fields)

    def set_light_properties(self, request: Any) -> Answer:
        light = self._entities.light(request.light_name)
        direction = vector(request.direction, "direction")
        changed = dataclasses.replace(
            _lit(light, request),
            pose=pose(request.pose, "pose"),
            specular=_colour(request.specular, "specular"),
            direction=direction if any(direction) else light.direction,
            cast_shadows=bool(request.cast_shadows),
        )
        self._relight(light, changed)
        notes = ("shadows are not rendered",) if request.cast_shadows else ()
        return Answer("SetLightProperties: properties set", notes=notes)

    def set_light(self, request: Any) -> Answer:
        """Handles the ROS 2 request, which keeps a light's pose and specular colour."""
        light = self._entities.light(request.light_name)
        self._relight(light, _lit(light, request))
        return Answer("SetLightProperties: properties set")

    def _relight(self, light: Light, changed: Light) -> None:
        if changed != light:
            world = self._simulation.world
            lights = tuple(changed if each is light else each for each in world.lights)
            self._simulation.change_world(dataclasses.replace(world, lights=lights))


def _lit(light: Light, request: Any) -> Light:
    """A light with the values set in a ROS 1 or ROS 2 request."""
    return dataclasses.replace(
        light,
        diffuse=_colour(request.diffuse, "diffuse"),
        attenuation=(
            number(request.attenuation_constant, "attenuation_constant"),
            number(request.attenuation_linear, "attenuation_linear"),
            number(request.attenuation_quadratic, "attenuation_quadratic"),
        ),
    )


def _nested(description: RobotDescription) -> list[str]:
    """Names of nested models, which are part of their links' scoped names."""
    names = (link.name.partition("::") for link in description.links)
    return list(dict.fromkeys(model for model, separator, _ in names if separator))


def _colour(value: Any, name: str) -> tuple[float, float, float, float]:
    r, g, b, a = (number(part, name) for part in (value.r, value.g, value.b, value.a))
    return (r, g, b, a)


def _joint_with(joint: Joint, given: Mapping[str, Sequence[float]]) -> tuple[Joint, list[str]]:
    """A joint with the given properties, and the properties without effect."""
    notes: list[str] = []
    axes = [joint.axis] if joint.axis2 is None else [joint.axis, joint.axis2]
    if joint.type in ("fixed", "ball"):
        return joint, [f"a {joint.type} joint has no axis, so nothing was set"]
    for index, axis in enumerate(axes):
        changes: dict[str, float | None] = {}
        if index < len(given["damping"]):
            damping = given["damping"][index]
            if damping < 0 or damping > _HEAVIEST:
                raise refused(
                    f"damping must be between 0 and {_HEAVIEST:g} (got {damping:g})",
                    "damping",
                    value=damping,
                )
            changes["damping"] = damping
        for field, bound in (("hiStop", "upper"), ("loStop", "lower")):
            if index < len(given[field]):
                value = given[field][index]
                # Gazebo's value for a missing stop is 1e16.
                changes[bound] = value if abs(value) < 1e10 else None
        axes[index] = dataclasses.replace(axis, **changes)  # type: ignore[arg-type]
        lower, upper = axes[index].lower, axes[index].upper
        if lower is not None and upper is not None and lower > upper:
            raise refused(
                f"loStop {lower:g} is above hiStop {upper:g}", "loStop", lower=lower, upper=upper
            )
    if joint.type == "continuous" and (given["hiStop"] or given["loStop"]):
        notes.append("hiStop and loStop have no effect on a continuous joint")
    without = [
        field
        for field in ("erp", "cfm", "stop_erp", "stop_cfm", "fudge_factor")
        if any(given[field])
    ]
    if without:
        notes.append(f"{', '.join(without)} {'have' if len(without) > 1 else 'has'} no effect")
    axis2 = axes[1] if len(axes) > 1 else None
    return dataclasses.replace(joint, axis=axes[0], axis2=axis2), notes
