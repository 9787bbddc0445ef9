"""SDF's ``<link>``: mass, visuals and collisions."""

from __future__ import annotations

import itertools
from collections.abc import Callable, Iterable
from dataclasses import replace
from typing import Any, TypeVar

import numpy as np

from cartwheel.codes import robot, tags
from cartwheel.description.elements.xml import Node
from cartwheel.description.losses import loss
from cartwheel.description.model import (
    Collision,
    Inertial,
    Light,
    Link,
    Surface,
    Visual,
)
from cartwheel.description.sdf.context import (
    Context,
    not_simulated,
    read_pose,
    reference_of,
    require_name,
)
from cartwheel.description.sdf.frames import Frames
from cartwheel.description.sdf.light import read_light
from cartwheel.description.sdf.links.inertia import WATER, inertial_of, weighing
from cartwheel.description.sdf.links.material import read_material
from cartwheel.description.sdf.links.shapes import read_shape
from cartwheel.description.sdf.links.surface import read_surface
from cartwheel.description.sdf.sensors import read_sensor, read_sensors, sensor_twice
from cartwheel.errors import DescriptionError
from cartwheel.geometry import Pose, rotate

_WITHOUT_COUNTERPART = (
    "must_be_base_link", "audio_sink", "audio_source", "projector", "battery",
    "particle_emitter",
)  # fmt: skip

P = TypeVar("P", bound=Visual | Collision | Light | None)


def read_link(node: Node, ctx: Context, frames: Frames) -> Link:
    """A link, with all parts in its own frame.

    Args:
        node: The element.
        ctx: Shared state of the document.
        frames: The model's frames, complete: a part may be relative to any of them.
    """
    name = require_name(node)
    pose = frames.pose(name, node.origin)

    def place(part: Node) -> Pose:
        stated = part.child("pose")
        relative_to = reference_of(stated)
        own = read_pose(stated)
        if not relative_to or relative_to == name:
            return own
        return pose.inverse() @ frames.placed(own, relative_to, part.origin)

    visuals = [_visual(each, ctx, place) for each in node.all("visual")]

    def directed(fields: dict[str, Any], part: Node) -> None:
        """Replaces a friction direction's frame by the link that it is attached to."""
        frame = fields.get("fdir1_frame")
        if frame is None or fields.get("fdir1") is None:
            return
        try:
            carrier = frames.link_of(frame, part.origin)
            there = frames.pose(carrier, part.origin).inverse() @ frames.pose(frame, part.origin)
        except DescriptionError as error:
            consequence = "fdir1 is relative to the axes of the collision"
            ctx.report(loss(error, consequence, severity="warning", origin=part.origin))
            del fields["fdir1_frame"]
            return
        fields["fdir1_frame"] = carrier
        fields["fdir1"] = rotate(there.orientation, fields["fdir1"])

    def sensed(sensor: Node) -> Pose:
        """The pose of a sensor, which Gazebo keeps even if its frame does not exist."""
        try:
            return place(sensor)
        except DescriptionError as error:
            if error.code is not tags.NAME_UNKNOWN:
                raise
            consequence = "the pose is relative to the link, as in Gazebo"
            ctx.report(loss(error, consequence, of="sensor", severity="warning"))
            return read_pose(sensor.child("pose"))

    collisions = [_collision(each, ctx, place, directed) for each in node.all("collision")]
    sensors = read_sensors(
        node.all("sensor"), lambda each: read_sensor(each, name, sensed(each)), ctx
    )
    lights = named_apart(
        "light", [read_light(each, place(each)) for each in node.all("light")], ctx
    )
    visuals = named_apart("visual", visuals, ctx)
    collisions = named_apart("collision", collisions, ctx)
    seen: set[str] = set()
    for sensor in sensors:
        if sensor.name in seen:
            ctx.report(sensor_twice(name, sensor))
        seen.add(sensor.name)
    for tag in _WITHOUT_COUNTERPART:
        for part in node.all(tag):
            part.mark()
            if part.children or part.text.strip().lower() in ("true", "1"):
                ctx.report(not_simulated(f"<{tag}> is not simulated", part))
    return Link(
        name=name,
        pose=pose,
        inertial=_inertial(node, ctx, [c for c in collisions if c is not None]),
        visuals=tuple(v for v in visuals if v is not None),
        collisions=tuple(c for c in collisions if c is not None),
        sensors=tuple(sensors),
        lights=tuple(lights),
        gravity=node.boolean_at("gravity", True),
        self_collide=_optional_boolean(node, "self_collide"),
        kinematic=node.boolean_at("kinematic", False),
        wind=node.boolean_at("enable_wind", False),
        linear_damping=node.number_at("velocity_decay/linear", 0.0),
        angular_damping=node.number_at("velocity_decay/angular", 0.0),
        origin=node.origin,
    )


def named_apart(kind: str, parts: Iterable[P], ctx: Context) -> list[P]:
    """Renames lights, visuals or collisions with duplicate names.

    Gazebo Classic accepts duplicate visuals and collisions; the first keeps the name.
    """
    parts = list(parts)
    found: list[P] = []
    taken = {part.name for part in parts if part is not None}
    seen: set[str] = set()
    for part in parts:
        mine = part
        if part is not None and part.name in seen:
            numbered = (f"{part.name}_{number}" for number in itertools.count(1))
            name = next(each for each in numbered if each not in taken)
            ctx.warn(
                tags.NAME_TAKEN,
                f'{kind} "{part.name}" has the same name as another {kind} and is renamed "{name}"',
                origin=part.origin,
                severity="warning",
                values={"name": part.name, "renamed": name},
            )
            mine = replace(part, name=name)
        if mine is not None:
            seen.add(mine.name)
            taken.add(mine.name)
        found.append(mine)
    return found


Place = Callable[[Node], Pose]
_ADDED_MASS = tuple("".join(pair) for pair in itertools.combinations_with_replacement("xyzpqr", 2))
"""Tags of a matrix's upper triangle, row by row."""
_ROUNDING = 1e-9
"""Largest negative eigenvalue relative to the largest one that is a rounding error."""


def _inertial(link: Node, ctx: Context, collisions: list[Collision]) -> Inertial:
    """The link's mass and inertia; SDF's default of 1 kg and 1 kg m² if not stated."""
    node = link.child("inertial")
    if node is None:
        return Inertial(mass=1.0, ixx=1.0, iyy=1.0, izz=1.0, origin=link.origin)
    if node.boolean_of("auto"):
        found = _auto_inertial(link, node, ctx, collisions)
    else:
        found = _stated_inertial(link, node, ctx)
    water = node.child("fluid_added_mass")
    return found if water is None else replace(found, added_mass=_added_mass(water, ctx))


def _added_mass(water: Node, ctx: Context) -> tuple[float, ...]:
    """The added mass, as in `Inertial`; empty, with a report, if it is not that of any fluid."""
    values = tuple(water.number_at(name, 0.0) for name in _ADDED_MASS)
    matrix = np.zeros((6, 6))
    matrix[np.triu_indices(6)] = values
    sizes = np.linalg.eigvalsh(matrix, UPLO="U")
    if sizes[0] < -_ROUNDING * max(sizes[-1], 1.0):
        text = "<fluid_added_mass> is not simulated because its matrix must not be negative"
        ctx.report(not_simulated(text, water))
        return ()
    return values


def _stated_inertial(link: Node, node: Node, ctx: Context) -> Inertial:
    """The mass and the inertia in the tags."""
    tensor = node.child("inertia")
    if tensor is not None and any("nan" in each.text.lower() for each in tensor.children):
        # Written by a model editor for a mesh with unknown volume.
        tensor.mark()
        name = link.attributes.get("name", "")
        ctx.warn(
            tags.DEFAULT_USED,
            f'the inertia of link "{name}" contains NaN, so the default in SDF, 1 kg m², is used',
            origin=tensor.origin,
            values={"link": name, "missing": "inertia"},
        )
        tensor = None

    def entry(tag: str, default: float) -> float:
        return tensor.number_at(tag, default) if tensor is not None else default

    return Inertial(
        mass=node.number_at("mass", 1.0),
        pose=_center(link, node.child("pose"), ctx),
        ixx=entry("ixx", 1.0),
        iyy=entry("iyy", 1.0),
        izz=entry("izz", 1.0),
        ixy=entry("ixy", 0.0),
        ixz=entry("ixz", 0.0),
        iyz=entry("iyz", 0.0),
        origin=node.origin,
    )


def _center(link: Node, pose: Node | None, ctx: Context) -> Pose:
    """The pose of an inertia in its link; as libsdformat, without the frame that it may state."""
    frame = reference_of(pose)
    if pose is not None and frame not in ("", link.attributes.get("name", "").strip()):
        ctx.warn(
            tags.VALUE_IGNORED,
            f'the frame "{frame}" is ignored: as in Gazebo, the <pose> of an <inertial> is always '
            "relative to its link",
            origin=pose.origin,
            mark=frame,
            hint="State the pose in the frame of the link.",
            values={"stated": frame},
        )
    return read_pose(pose)


def _auto_inertial(link: Node, node: Node, ctx: Context, collisions: list[Collision]) -> Inertial:
    """SDF 1.11: the mass is computed from the density, unless it is also stated."""
    default = node.number_at("density", WATER)
    stated = {
        each.attributes.get("name"): each.number_at("density", default)
        for each in link.all("collision")
    }
    densities = [stated.get(each.name, default) for each in collisions]
    found = inertial_of(collisions, densities, node.origin)
    if found is None:
        name = link.attributes.get("name", "")
        ctx.warn(
            tags.DEFAULT_USED,
            f'the inertia of link "{name}" cannot be computed because the link has no '
            "collision shape with a volume, so a mass of 1 kg and moments of inertia of 1 kg "
            "m² are used",
            origin=node.origin,
            values={"link": name, "missing": "collision"},
        )
        return Inertial(mass=1.0, ixx=1.0, iyy=1.0, izz=1.0, origin=node.origin)
    mass = node.number_at("mass", found.mass)
    if mass <= 0:
        raise node.fail(
            f"the mass must be above 0 (got {mass:g})",
            code=robot.MASS_NOT_POSITIVE,
            values={"stated": mass},
        )
    return weighing(found, mass)


def _visual(node: Node, ctx: Context, place: Place) -> Visual | None:
    name = require_name(node)
    material = read_material(node.child("material"), ctx)
    transparency = min(1.0, max(0.0, node.number_at("transparency", 0.0)))
    shadows = node.boolean_at("cast_shadows", True)
    retro = node.optional_number_at("laser_retro")
    pose = place(node)
    for part in node.all("plugin"):
        part.mark()
        ctx.report(not_simulated("visual plugins are not supported", part))
    shape = read_shape(node, ctx)
    if shape is None:
        return None
    return Visual(
        name=name,
        pose=pose,
        shape=shape,
        material=material,
        transparency=transparency,
        cast_shadows=shadows,
        laser_retro=retro,
        origin=node.origin,
    )


def _collision(
    node: Node, ctx: Context, place: Place, directed: Callable[[dict[str, Any], Node], None]
) -> Collision | None:
    name = require_name(node)
    limit = node.child("max_contacts")
    stated = node.child("surface")
    fields = read_surface(stated, ctx) if stated is not None else {}
    directed(fields, node)
    surface = Surface(max_contacts=limit.integer() if limit is not None else None, **fields)
    retro = node.optional_number_at("laser_retro")
    pose = place(node)
    shape = read_shape(node, ctx)
    if shape is None:
        return None
    return Collision(
        name=name, pose=pose, shape=shape, surface=surface, laser_retro=retro, origin=node.origin
    )


def _optional_boolean(node: Node, tag: str) -> bool | None:
    found = node.child(tag)
    return found.boolean() if found is not None else None
