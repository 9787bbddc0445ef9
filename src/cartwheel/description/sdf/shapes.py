"""SDF's ``<geometry>``."""

from __future__ import annotations

from cartwheel.description.model import (
    Box,
    Capsule,
    Cone,
    Cylinder,
    Ellipsoid,
    Heightmap,
    Mesh,
    Plane,
    Polyline,
    Shape,
    Sphere,
)
from cartwheel.description.sdf.context import Context, positive
from cartwheel.description.xml import Node
from cartwheel.errors import DescriptionError, suggestion
from cartwheel.geometry import Vec3

SHAPES = (
    "box", "sphere", "cylinder", "capsule", "cone", "ellipsoid", "plane", "mesh", "heightmap",
    "polyline", "image", "empty",
)  # fmt: skip


def read_shape(owner: Node, ctx: Context) -> Shape | None:
    """The shape of a visual or collision; None where it is empty or its file is missing.

    A missing file costs the one shape, not the whole world that it stands in: it is told as an
    error that others may stop at.
    """
    geometry = owner.require_child("geometry")
    for tag in SHAPES:
        node = geometry.child(tag)
        if node is not None:
            break
    else:
        if geometry.children:
            wrong = geometry.children[0].mark()
            raise wrong.fail(f'geometry "{wrong.tag}" is not known', suggestion(wrong.tag, SHAPES))
        raise geometry.fail("<geometry> is empty", f"It holds one of: {', '.join(SHAPES)}.")
    if tag == "empty":
        return None
    if tag == "image":
        node.mark()
        ctx.tell("warning", "the shape <image> is not simulated", node.origin)
        return None
    if tag in ("mesh", "heightmap"):
        try:
            return _mesh(node, ctx) if tag == "mesh" else _heightmap(node, ctx)
        except _MissingFileError as missing:
            node.mark()
            hint = f" {missing.hint}" if missing.hint else ""
            ctx.tell("error", f"{missing.message}; {_label(owner)} is left out.{hint}", node.origin)
            return None
    return _primitive(tag, node)


class _MissingFileError(DescriptionError):
    """A file of a shape that was not found."""


def _primitive(tag: str, node: Node) -> Shape:
    if tag == "box":
        return Box(size=_sizes(node.require_child("size")))
    if tag == "sphere":
        return Sphere(radius=positive(node.require_child("radius"), "a radius"))
    if tag == "ellipsoid":
        return Ellipsoid(radii=_sizes(node.require_child("radii")))
    if tag == "plane":
        return _plane(node)
    if tag == "polyline":
        return _polyline(node)
    radius = positive(node.require_child("radius"), "a radius")
    length = positive(node.require_child("length"), "a length")
    if tag == "cylinder":
        return Cylinder(radius=radius, length=length)
    if tag == "capsule":
        return Capsule(radius=radius, length=length)
    return Cone(radius=radius, length=length)


def _sizes(node: Node) -> Vec3:
    x, y, z = node.vec3()
    if min(x, y, z) <= 0:
        raise node.fail(f"every {node.tag} must be above 0, but they are {node.text}")
    return (x, y, z)


def _plane(node: Node) -> Plane:
    normal = node.vec3_at("normal", (0.0, 0.0, 1.0))
    size = node.child("size")
    if not any(normal):
        raise node.fail("the normal of a plane must not be 0 0 0")
    if size is None:
        return Plane(normal=normal)
    x, y = size.vector(2)
    return Plane(normal=normal, size=(x, y))


def _polyline(node: Node) -> Polyline:
    points = [point.vector(2) for point in node.all("point")]
    if len(points) < 3:
        raise node.fail(f"a polyline needs three points, but has {len(points)}")
    height = positive(node.require_child("height"), "a height")
    return Polyline(points=tuple((x, y) for x, y in points), height=height)


def _mesh(node: Node, ctx: Context) -> Mesh:
    uri = node.child("uri") or node.child("filename")
    if uri is None or not uri.text.strip():
        raise node.fail("a mesh has no <uri>", "Write <uri>model://my_robot/meshes/part.dae</uri>.")
    scale = node.child("scale")
    values = scale.vec3() if scale is not None else (1.0, 1.0, 1.0)
    if scale is not None and 0.0 in values:
        raise scale.fail(f"the scale {scale.text} flattens the mesh")
    submesh = node.child("submesh")
    optimization = node.get("optimization") or ""
    decompose = node.child("convex_decomposition")
    if decompose is not None:
        decompose.mark()
    try:
        path = ctx.packages.resolve(uri.text, uri.origin, what="mesh")
    except DescriptionError as error:
        raise _MissingFileError(error.message, origin=uri.origin, hint=error.hint) from error
    return Mesh(
        uri=uri.text,
        path=path,
        scale=values,
        submesh=submesh.text_at("name") or None if submesh is not None else None,
        center_submesh=submesh.boolean_at("center", False) if submesh is not None else False,
        convex_decomposition=optimization == "convex_decomposition",
    )


def _heightmap(node: Node, ctx: Context) -> Heightmap:
    uri = node.require_child("uri")
    size = node.vec3_at("size", (1.0, 1.0, 1.0))
    position = node.vec3_at("pos", (0.0, 0.0, 0.0))
    try:
        path = ctx.packages.resolve(uri.text, uri.origin, what="heightmap")
    except DescriptionError as error:
        raise _MissingFileError(error.message, origin=uri.origin, hint=error.hint) from error
    texture = None
    for each in node.all("texture"):
        each.mark()
        diffuse = each.find("diffuse")
        if diffuse is not None and texture is None:
            try:
                texture = ctx.packages.resolve(diffuse.text, diffuse.origin, what="texture")
            except DescriptionError as error:
                ctx.tell("warning", error.message, diffuse.origin)
    for ignored in ("blend", "use_terrain_paging", "sampling"):
        for each in node.all(ignored):
            each.mark()
    return Heightmap(path=path, size=size, position=position, texture=texture)


def _label(owner: Node) -> str:
    return f'{owner.tag} "{owner.attributes.get("name", "")}"'
