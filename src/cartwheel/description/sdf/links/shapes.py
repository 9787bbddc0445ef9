"""SDF's ``<geometry>``."""

from __future__ import annotations

from cartwheel.codes import files, tags
from cartwheel.description.elements.xml import Node
from cartwheel.description.files.other_places import Use
from cartwheel.description.losses import loss
from cartwheel.description.meshes import MeshError, check_mesh
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
from cartwheel.description.sdf.context import Context, not_simulated, positive
from cartwheel.description.shapes.outline import OutlineError, convex_pieces
from cartwheel.description.shapes.terrain import ELEVATION_MODELS, TerrainError, heights_of
from cartwheel.errors import DescriptionError
from cartwheel.geometry import Vec3
from cartwheel.similar_names import meant, suggestion

SHAPES = (
    "box", "sphere", "cylinder", "capsule", "cone", "ellipsoid", "plane", "mesh", "heightmap",
    "polyline", "image", "empty",
)  # fmt: skip

_FLAT = 1e-3
"""m, in place of 0."""


def read_shape(owner: Node, ctx: Context) -> Shape | None:
    """The shape of a visual or collision; None if it is empty or its file cannot be used.

    An unusable file only affects this shape, not the whole world. It is reported as an error, so
    that strict callers can stop.
    """
    geometry = owner.child("geometry")
    if geometry is None:
        ctx.warn(
            tags.VALUE_IGNORED,
            f"{_label(owner)} has no <geometry> and is ignored",
            origin=owner.origin,
            values={"left_out": owner.tag, "missing": "geometry", **owner.named},
        )
        return None
    for tag in SHAPES:
        node = geometry.child(tag)
        if node is not None:
            break
    else:
        if geometry.children:
            wrong = geometry.children[0].mark()
            raise wrong.fail(
                f"the geometry <{wrong.tag}> is unknown",
                suggestion(wrong.tag, SHAPES),
                code=tags.TYPE_UNKNOWN,
                values={"name": wrong.tag, "meant": meant(wrong.tag, SHAPES)},
            )
        ctx.warn(
            tags.TAG_EMPTY,
            f"the <geometry> of {_label(owner)} is empty",
            origin=owner.origin,
            values={"tag": "geometry", "left_out": owner.tag, **owner.named},
        )
        return None
    if tag == "empty":
        return None
    if tag == "image":
        node.mark()
        ctx.report(not_simulated("the shape <image> is not simulated", node))
        return None
    if tag in ("mesh", "heightmap"):
        try:
            return _mesh(node, owner, ctx) if tag == "mesh" else _heightmap(node, ctx)
        except _UnusableFileError as missing:
            node.mark()
            ctx.report(
                loss(
                    missing,
                    f"{_label(owner)} is ignored",
                    of=owner.tag,
                    origin=node.origin,
                    values=owner.named,
                )
            )
            return None
    if tag == "polyline":
        return _polyline(geometry.all("polyline"), ctx)
    return _primitive(tag, node, ctx)


class _UnusableFileError(DescriptionError):
    """A shape's file that is missing or cannot be read."""


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
        _warn_default(shape, tag, ctx)
        return 1.0
    if node.number() == 0:
        # Gazebo shows nothing, or a disc.
        ctx.warn(
            tags.VALUE_IGNORED,
            f"the {tag} of the {shape.tag} is 0, so {_FLAT * 1e3:g} mm is used",
            origin=node.origin,
            values={"stated": node.text},
        )
        return _FLAT
    return positive(node, f"a {tag}")


def _sizes(shape: Node, tag: str, ctx: Context) -> Vec3:
    node = shape.child(tag)
    if node is None:
        _warn_default(shape, tag, ctx)
        return (1.0, 1.0, 1.0)
    x, y, z = node.vec3()
    if shape.tag == "box" and min(x, y, z) == 0:
        # Gazebo's building editor writes this for the wall above a door that reaches the ceiling.
        # Others write 0 0 0 for a link that is only a frame.
        ctx.warn(
            tags.VALUE_IGNORED,
            f"a side of the box has length 0 (size {node.text}), so {_FLAT * 1e3:g} mm is used",
            origin=node.origin,
            values={"stated": node.text},
        )
        x, y, z = (max(side, _FLAT) for side in (x, y, z))
    if min(x, y, z) <= 0:
        raise node.fail(f"each component of <{tag}> must be above 0 (got {node.text})")
    return (x, y, z)


def _warn_default(shape: Node, tag: str, ctx: Context) -> None:
    ctx.warn(
        tags.DEFAULT_USED,
        f"<{shape.tag}> has no <{tag}>, so the default in SDF, 1 m, is used",
        origin=shape.origin,
        values={"shape": shape.tag, "missing": tag},
    )


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
    """One outline, or several with holes inside the outer ones."""
    outlines = []
    for node in nodes:
        points = [point.vector(2) for point in node.all("point")]
        if len(points) < 3:
            raise node.fail(f"a polyline requires at least three points (got {len(points)})")
        outlines.append(tuple((x, y) for x, y in points))
    heights = [positive(node.require_child("height"), "a height") for node in nodes]
    if any(height != heights[0] for height in heights):
        ctx.warn(
            tags.VALUE_IGNORED,
            f"the polylines of one geometry have different heights: {heights[0]:g} m is used",
            origin=nodes[0].origin,
            values={"stated": tuple(heights)},
        )
    shape = Polyline(points=outlines[0], height=heights[0], holes=tuple(outlines[1:]))
    try:
        pieces = convex_pieces(shape)
    except OutlineError as error:
        raise nodes[0].fail(
            str(error), "Use a mesh instead.", values={"kind": error.kind, "most": error.most}
        ) from None
    if not pieces:
        raise nodes[0].fail("all points of the polyline are on one line")
    return shape


def _mesh(node: Node, owner: Node, ctx: Context) -> Mesh:
    uri = node.child("uri") or node.child("filename")
    if uri is None or not uri.text.strip():
        raise node.fail(
            "the mesh has no <uri>",
            "For example: <uri>model://my_robot/meshes/part.dae</uri>",
            code=tags.TAG_MISSING,
            values={"missing": "uri"},
        )
    scale = node.child("scale")
    values: Vec3 = (1.0, 1.0, 1.0)
    if scale is not None and len(scale.text.split()) == 1:
        values = (scale.number(),) * 3
        ctx.warn(
            tags.VALUE_IGNORED,
            f"the scale {scale.text} is used for all three axes",
            origin=scale.origin,
            values={"stated": scale.text},
        )
    elif scale is not None:
        values = scale.vec3()
    if scale is not None and 0.0 in values:
        raise _UnusableFileError(
            f"a component of the mesh's scale is 0 (got {scale.text})",
            code=files.MESH_UNREADABLE,
            origin=scale.origin,
            values={"kind": "mesh", "stated": scale.text},
        )
    submesh = node.child("submesh")
    optimization = node.get("optimization") or ""
    try:
        use: Use = "collision" if owner.tag == "collision" else ""
        path = ctx.packages.resolve(uri.text, uri.origin, what="mesh", use=use)
    except DescriptionError as error:
        raise _UnusableFileError.of(error, uri.origin) from error
    shape = Mesh(
        uri=uri.text,
        path=path,
        scale=values,
        submesh=submesh.text_at("name") or None if submesh is not None else None,
        center_submesh=submesh.boolean_at("center", False) if submesh is not None else False,
        convex_decomposition=optimization == "convex_decomposition",
    )
    try:
        check_mesh(shape, origin=uri.origin)
    except MeshError as error:
        raise _UnusableFileError.of(error, uri.origin) from error
    return shape


def _heightmap(node: Node, ctx: Context) -> Heightmap:
    uri = node.require_child("uri")
    size = node.vec3_at("size", (1.0, 1.0, 1.0))
    position = node.vec3_at("pos", (0.0, 0.0, 0.0))
    try:
        path = ctx.packages.resolve(uri.text, uri.origin, what="heightmap")
    except DescriptionError as error:
        raise _UnusableFileError.of(error, uri.origin) from error
    texture = None
    for each in node.all("texture"):
        diffuse = each.find("diffuse")
        if diffuse is not None and texture is None:
            try:
                texture = ctx.packages.resolve(diffuse.text, diffuse.origin, what="texture")
            except DescriptionError as error:
                ctx.report(error.diagnostic("warning"))
    if path.suffix.lower() in ELEVATION_MODELS:
        raise _UnusableFileError(
            f'the heightmap "{path.name}" is geographic elevation data, which is not supported',
            code=files.PICTURE_UNREADABLE,
            origin=uri.origin,
            values={"kind": "heightmap", "name": uri.text},
            hint="Save the heights as a greyscale PNG with the highest point in white.",
        )
    if size[2] == 0:
        # Gazebo shows level ground.
        ctx.warn(
            tags.VALUE_IGNORED,
            f"the height of the heightmap is 0, so {_FLAT * 1e3:g} mm is used",
            origin=node.origin,
            values={"stated": node.text_at("size")},
        )
        size = (*size[:2], _FLAT)
    if min(size[:2]) <= 0:
        raise node.fail(f"each component of a heightmap's <size> must be above 0 (got {size})")
    shape = Heightmap(path=path, size=size, position=position, texture=texture)
    try:
        heights_of(shape, origin=uri.origin)
    except TerrainError as error:
        raise _UnusableFileError.of(error, uri.origin) from error
    return shape


def _label(owner: Node) -> str:
    return f'{owner.tag} "{owner.attributes.get("name", "")}"'
