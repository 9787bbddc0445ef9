"""URDF's ``<material>``: colours and textures, stated in a link or in the robot."""

from __future__ import annotations

from cartwheel.codes import tags
from cartwheel.description.elements import numbers
from cartwheel.description.elements.xml import Node
from cartwheel.description.losses import loss
from cartwheel.description.model import Material, Rgba
from cartwheel.description.urdf.context import UrdfContext
from cartwheel.errors import DescriptionError, Origin
from cartwheel.similar_names import meant, suggestion


def read_materials(robot: Node, ctx: UrdfContext) -> None:
    """Reads the materials available to the whole robot, wherever they are defined.

    urdfdom refuses a robot that defines one outside its links twice.
    """
    seen: dict[str, Origin] = {}
    for node in robot.all("material"):
        name = node.get("name")
        if name is not None and name in seen:
            ctx.report(
                tags.NAME_TAKEN.diagnostic(
                    f'the material "{name}" is defined twice, so ROS and Gazebo do not load the '
                    "robot",
                    origin=node.origin,
                    hint=f"Remove one. The first definition is at {seen[name]}.",
                    values={"tag": "material", "name": name},
                )
            )
            _stated(node, name, ctx)
            continue
        if name is not None:
            seen[name] = node.origin
        _define(node, ctx)
    for link in robot.children:
        if link.tag == "link":
            for visual in link.children:
                for node in visual.children:
                    if visual.tag == "visual" and node.tag == "material" and node.children:
                        _define(node, ctx)


def _define(node: Node, ctx: UrdfContext) -> None:
    name = (node.get("name") or "").strip()
    material = _stated(node, name, ctx)
    if material is None or not name:
        return
    known = ctx.materials.setdefault(name, material)
    if known != material:
        ctx.warn(
            tags.MATERIAL_DIFFERS,
            f'the material "{name}" has two different definitions; the first one is used',
            origin=node.origin,
            values={"name": name},
        )


def read_material(node: Node | None, ctx: UrdfContext) -> Material:
    if node is None:
        return Material()
    name = (node.get("name") or "").strip()
    stated = _stated(node, name, ctx)
    if stated is not None:
        return stated
    if name in ctx.materials:
        return ctx.materials[name]
    if name:
        known = sorted(ctx.materials)
        ctx.warn(
            tags.MATERIAL_UNDEFINED,
            f'the material "{name}" is not defined',
            origin=node.origin,
            hint=suggestion(name, known) if known else "",
            values={"name": name, "meant": meant(name, known)},
        )
    return Material(name=name)


def _stated(node: Node, name: str, ctx: UrdfContext) -> Material | None:
    """The properties in a ``<material>``; None if it contains only a name."""
    colour, texture = node.child("color"), node.child("texture")
    if colour is None and texture is None:
        return None
    rgba = _colour(colour, ctx) if colour is not None else None
    path = None
    if texture is not None:
        try:
            path = ctx.packages.resolve(texture.require("filename"), texture.origin, what="texture")
        except DescriptionError as error:
            ctx.report(error.diagnostic("warning"))
    return Material(name=name, diffuse=rgba, texture=path)


def _colour(node: Node, ctx: UrdfContext) -> Rgba | None:
    """A material's colour; None if it is invalid and therefore ignored. Source: urdfdom."""
    try:
        text = node.require("rgba")
        values = text.split()
        if len(values) == 3:
            ctx.warn(
                tags.VALUE_IGNORED,
                f'the colour "{text}" has no alpha value, so 1 is used',
                origin=node.origin,
                values={"stated": text},
            )
            values = [*values, "1"]
        r, g, b, a = numbers.vector(" ".join(values), 4, "color rgba", node.origin)
    except DescriptionError as error:
        code = error.code if error.code is tags.TAG_MISSING else tags.VALUE_IGNORED
        ctx.report(loss(error, "the colour is ignored", severity="warning", code=code))
        return None
    rgba = (_share(r), _share(g), _share(b), _share(a))
    if rgba != (r, g, b, a):
        ctx.warn(
            tags.VALUE_IGNORED,
            f'the colour "{text}" has values outside 0 to 1, which are clipped',
            origin=node.origin,
            values={"stated": text},
        )
    return rgba


def _share(value: float) -> float:
    return min(1.0, max(0.0, value))
