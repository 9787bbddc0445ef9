"""SDF's ``<geometry>``."""

from __future__ import annotations

from cartwheel.description.meshes import MeshError, load_mesh
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
from cartwheel.description.outline import OutlineError, convex_pieces
from cartwheel.description.sdf.context import Context, positive
from cartwheel.description.terrain import ELEVATION_MODELS, TerrainError, heights_of
from cartwheel.description.xml import Node
from cartwheel.errors import DescriptionError, suggestion
from cartwheel.geometry import Vec3

SHAPES = (
    "box", "sphere", "cylinder", "capsule", "cone", "ellipsoid", "plane", "mesh", "heightmap",
    "polyline", "image", "empty",
)  # fmt: skip

_FLAT = 1e-3
"""m, in place of 0."""


def read_shape(owner: Node, ctx: Context) -> Shape | None:
    """The shape of a visual or collision; None where it is empty or its file cannot be used.

    Such a file costs the one shape, not the whole world that it stands in: it is told as an
    error that others may stop at.
    """
    geometry = owner.child("geometry")
    if geometry is None:
        ctx.tell("warning", f"{_label(owner)} has no <geometry>: it is left out", owner.origin)
        return None
    for tag in SHAPES:
        node = geometry.child(tag)
        if node is not None:
            break
    else:
        if geometry.children:
            wrong = geometry.children[0].mark()
            raise wrong.fail(f'geometry "{wrong.tag}" is not known', suggestion(wrong.tag, SHAPES))
        ctx.tell(
            "warning", f"{_label(owner)}: <geometry> is empty, so it has no shape", owner.origin
        )
        return None
    if tag == "empty":
        return None
    if tag == "image":
        node.mark()
        ctx.tell("warning", "the shape <image> is not simulated", node.origin)
        return None
    if tag in ("mesh", "heightmap"):
        try:
            return _mesh(node, ctx) if tag == "mesh" else _heightmap(node, ctx)
        except _UnusableFileError as missing:
            node.mark()
            hint = f" {missing.hint}" if missing.hint else ""
            ctx.tell("error", f"{missing.message}; {_label(owner)} is left out.{hint}", node.origin)
            return None
    if tag == "polyline":
        return _polyline(geometry.all("polyline"), ctx)
    return _primitive(tag, node, ctx)


class _UnusableFileError(DescriptionError):
    """A file of a shape that is missing or cannot be read."""


def _primitive(tag: str, node: Node, ctx: Context) -> Shape:
    if tag == "box":
        return Box(size=_sizes(node, "size", ctx))
    if tag == "sphere":
        return Sphere(radius=_measure(node, "radius", ctx))
    if tag == "ellipsoid":
        return Ellipsoid(radii=_sizes(node, "radii", ctx))
    if tag == "plane":
        return _plane(node)
    radius = _measure(node, "radius", ctx)
    length = _measure(node, "length", ctx)
    if tag == "cylinder":
        return Cylinder(radius=radius, length=length)
    if tag == "capsule":
        return Capsule(radius=radius, length=length)
    return Cone(radius=radius, length=length)


def _measure(shape: Node, tag: str, ctx: Context) -> float:
    node = shape.child(tag)
    if node is None:
        _tell_default(shape, tag, ctx)
        return 1.0
    return positive(node, f"a {tag}")


def _sizes(shape: Node, tag: str, ctx: Context) -> Vec3:
    node = shape.child(tag)
    if node is None:
        _tell_default(shape, tag, ctx)
        return (1.0, 1.0, 1.0)
    x, y, z = node.vec3()
    if shape.tag == "box" and min(x, y, z) == 0 < max(x, y, z):
        # As Gazebo's building editor writes the wall above a door that reaches the ceiling.
        ctx.tell("warning", f"a box of {node.text} is made {_FLAT * 1e3:g} mm thick", node.origin)
        x, y, z = (max(side, _FLAT) for side in (x, y, z))
    if min(x, y, z) <= 0:
        raise node.fail(f"every {tag} must be above 0, but they are {node.text}")
    return (x, y, z)


def _tell_default(shape: Node, tag: str, ctx: Context) -> None:
    ctx.tell("warning", f"<{shape.tag}> has no <{tag}>: SDF's default of 1 m counts", shape.origin)


def _plane(node: Node) -> Plane:
    normal = node.vec3_at("normal", (0.0, 0.0, 1.0))
    size = node.child("size")
    if not any(normal):
        raise node.fail("the normal of a plane must not be 0 0 0")
    if size is None:
        return Plane(normal=normal)
    x, y = size.vector(2)
    return Plane(normal=normal, size=(x, y))


def _polyline(nodes: list[Node], ctx: Context) -> Polyline:
    """One outline, or several of which the inner ones are holes."""
    outlines = []
    for node in nodes:
        points = [point.vector(2) for point in node.all("point")]
        if len(points) < 3:
            raise node.fail(f"a polyline needs three points, but has {len(points)}")
        outlines.append(tuple((x, y) for x, y in points))
    heights = [positive(node.require_child("height"), "a height") for node in nodes]
    if any(height != heights[0] for height in heights):
        ctx.tell(
            "warning",
            f"polylines of one geometry have one height: {heights[0]:g} m counts",
            nodes[0].origin,
        )
    shape = Polyline(points=outlines[0], height=heights[0], holes=tuple(outlines[1:]))
    try:
        pieces = convex_pieces(shape)
    except OutlineError as error:
        raise nodes[0].fail(str(error), "A mesh holds a shape as fine as that.") from None
    if not pieces:
        raise nodes[0].fail("the points of the polyline lie on one line")
    return shape


def _mesh(node: Node, ctx: Context) -> Mesh:
    uri = node.child("uri") or node.child("filename")
    if uri is None or not uri.text.strip():
        raise node.fail("a mesh has no <uri>", "Write <uri>model://my_robot/meshes/part.dae</uri>.")
    scale = node.child("scale")
    values: Vec3 = (1.0, 1.0, 1.0)
    if scale is not None and len(scale.text.split()) == 1:
        values = (scale.number(),) * 3
        ctx.tell("warning", f"the scale {scale.text} counts for all three axes", scale.origin)
    elif scale is not None:
        values = scale.vec3()
    if scale is not None and 0.0 in values:
        raise _UnusableFileError(
            f"the scale {scale.text} flattens the mesh", origin=scale.origin, hint=None
        )
    submesh = node.child("submesh")
    optimization = node.get("optimization") or ""
    try:
        path = ctx.packages.resolve(uri.text, uri.origin, what="mesh")
    except DescriptionError as error:
        raise _UnusableFileError(error.message, origin=uri.origin, hint=error.hint) from error
    shape = Mesh(
        uri=uri.text,
        path=path,
        scale=values,
        submesh=submesh.text_at("name") or None if submesh is not None else None,
        center_submesh=submesh.boolean_at("center", False) if submesh is not None else False,
        convex_decomposition=optimization == "convex_decomposition",
    )
    try:
        load_mesh(shape, origin=uri.origin)
    except MeshError as error:
        raise _UnusableFileError(error.message, origin=uri.origin, hint=error.hint) from error
    return shape


def _heightmap(node: Node, ctx: Context) -> Heightmap:
    uri = node.require_child("uri")
    size = node.vec3_at("size", (1.0, 1.0, 1.0))
    position = node.vec3_at("pos", (0.0, 0.0, 0.0))
    try:
        path = ctx.packages.resolve(uri.text, uri.origin, what="heightmap")
    except DescriptionError as error:
        raise _UnusableFileError(error.message, origin=uri.origin, hint=error.hint) from error
    texture = None
    for each in node.all("texture"):
        diffuse = each.find("diffuse")
        if diffuse is not None and texture is None:
            try:
                texture = ctx.packages.resolve(diffuse.text, diffuse.origin, what="texture")
            except DescriptionError as error:
                ctx.tell("warning", error.message, diffuse.origin)
    if path.suffix.lower() in ELEVATION_MODELS:
        raise _UnusableFileError(
            f'the heightmap "{path.name}" is geographic elevation data, which is not read',
            origin=uri.origin,
            hint="Save the heights as a PNG in grey, the highest point white.",
        )
    if min(size[:2]) <= 0 or size[2] == 0:
        raise node.fail(f"every size of a heightmap must be above 0, not {size}")
    shape = Heightmap(path=path, size=size, position=position, texture=texture)
    try:
        heights_of(shape, origin=uri.origin)
    except TerrainError as error:
        raise _UnusableFileError(error.message, origin=uri.origin, hint=error.hint) from error
    return shape


def _label(owner: Node) -> str:
    return f'{owner.tag} "{owner.attributes.get("name", "")}"'
