"""URDF's ``<link>``: mass, visuals and collisions."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

from cartwheel.codes import tags
from cartwheel.description.elements.xml import Node
from cartwheel.description.files.other_places import Use
from cartwheel.description.losses import loss
from cartwheel.description.meshes import check_mesh
from cartwheel.description.model import (
    Box,
    Capsule,
    Collision,
    Cylinder,
    Inertial,
    Link,
    Mesh,
    Shape,
    Sphere,
    Visual,
)
from cartwheel.description.urdf.context import UrdfContext, read_origin
from cartwheel.description.urdf.inertia import _listed, read_inertial
from cartwheel.description.urdf.material import read_material
from cartwheel.errors import DescriptionError
from cartwheel.similar_names import meant, suggestion

SHAPES = ("box", "cylinder", "sphere", "capsule", "mesh")


@dataclass(frozen=True, kw_only=True, slots=True)
class ReadLink:
    """A link whose mass has not been checked yet, because this requires the tree."""

    link: Link
    """Without inertial and pose."""
    inertial: Inertial | None


def read_link(node: Node, ctx: UrdfContext) -> ReadLink:
    """A link, with its parts named as in Gazebo.

    Raises:
        DescriptionError: A size is impossible, or a value is not a number.
    """
    name = node.require("name").strip()
    visuals: list[Visual] = []
    nameless: Node | None = None
    for part in node.all("visual"):
        material = part.child("material")
        if nameless is None and material is not None and material.get("name") is None:
            nameless = material
        visual = _visual(part, _numbered(f"{name}_visual", len(visuals)), ctx)
        if visual is not None and nameless is None:
            visuals.append(visual)
    collisions: list[Collision] = []
    for part in node.all("collision"):
        stated = (part.get("name") or "").strip()
        default = _numbered(f"{name}_collision", len(collisions))
        title = f"{stated}_collision" if stated else default
        if any(title == other.name for other in collisions):
            title = _numbered(title, len(collisions))
        shape = read_geometry(part, "collision", name, ctx)
        pose = read_origin(part)
        if shape is None:
            continue
        aliases = tuple(dict.fromkeys(n for n in (default, stated) if n and n != title))
        collisions.append(
            Collision(name=title, aliases=aliases, pose=pose, shape=shape, origin=part.origin)
        )
    if nameless is not None:
        _warn_nameless(nameless, name, collisions, ctx)
        collisions = []
    inertial = node.child("inertial")
    return ReadLink(
        link=Link(
            name=name, visuals=tuple(visuals), collisions=tuple(collisions), origin=node.origin
        ),
        inertial=read_inertial(inertial) if inertial is not None else None,
    )


def _warn_nameless(
    material: Node, link: str, collisions: Sequence[Collision], ctx: UrdfContext
) -> None:
    """Warns about a visual's material without a name, at which urdfdom stops reading the link."""
    lost = "this visual, the visuals after it"
    if collisions:
        lost += " and the collisions"
    ctx.warn(
        tags.ELEMENT_LEFT_OUT,
        f'<material> has no name, so {lost} of link "{link}" are ignored, as in ROS and Gazebo',
        origin=material.origin,
        hint="Add the attribute name to <material>.",
        values={
            "tag": "material",
            "link": link,
            "left_out": "collision" if collisions else "visual",
            "cut": True,
        },
        severity="error" if collisions else "warning",
    )


def _numbered(name: str, index: int) -> str:
    return f"{name}_{index}" if index else name


def _visual(node: Node, default: str, ctx: UrdfContext) -> Visual | None:
    stated = (node.get("name") or "").strip()
    shape = read_geometry(node, "visual", default.removesuffix("_visual"), ctx)
    pose = read_origin(node)
    material = read_material(node.child("material"), ctx)
    if shape is None:
        return None
    if isinstance(shape, Mesh) and material.diffuse is not None:
        material = replace(material, yields_to_mesh=True)
    return Visual(
        name=stated or default,
        pose=pose,
        shape=shape,
        material=material,
        origin=node.origin,
    )


def read_geometry(owner: Node, kind: str, link: str, ctx: UrdfContext) -> Shape | None:
    """The shape of a visual or collision; None if it is skipped. `cut_links` reports a missing
    shape.
    """
    geometry = owner.child("geometry")
    shapes = [] if geometry is None else geometry.all(*SHAPES)
    for other in shapes[1:]:
        other.mark()
        ctx.report(
            tags.TAG_REPEATED.diagnostic(
                f"only the first shape of a <geometry> is used, so <{other.tag}> after "
                f"<{shapes[0].tag}> is ignored",
                origin=other.origin,
                values={"tag": other.tag, "parent": "geometry", "link": link},
            )
        )
    if shapes:
        read = _mesh if shapes[0].tag == "mesh" else _primitive
        return read(shapes[0], kind, link, ctx)
    if geometry is not None and geometry.children:
        wrong = geometry.children[0]
        raise wrong.fail(
            f'the geometry <{wrong.tag}> of link "{link}" is unknown',
            suggestion(wrong.tag, SHAPES),
            code=tags.TYPE_UNKNOWN,
            values={"name": wrong.tag, "meant": meant(wrong.tag, SHAPES), "link": link},
        )
    return None


def _primitive(node: Node, kind: str, link: str, ctx: UrdfContext) -> Shape | None:
    shape: Shape
    if node.tag == "box":
        size = node.vec3_of("size")
        if min(size) < 0:
            # Gazebo Classic draws it inside out, with the absolute size.
            ctx.warn(
                tags.VALUE_IGNORED,
                f'a box of link "{link}" has the negative size {_listed(size)}, so the sign is '
                "ignored",
                origin=node.origin,
                values={"link": link, "stated": size},
            )
            size = (abs(size[0]), abs(size[1]), abs(size[2]))
        sizes: tuple[float, ...] = size
        shape = Box(size=size)
    elif node.tag == "sphere":
        sizes = (node.number_of("radius"),)
        shape = Sphere(radius=sizes[0])
    else:
        radius, length = node.number_of("radius"), node.number_of("length")
        sizes = (radius, length)
        if node.tag == "capsule":
            shape = Capsule(radius=radius, length=length)
        else:
            shape = Cylinder(radius=radius, length=length)
    if min(sizes) < 0:
        raise node.fail(
            f'a {node.tag} of link "{link}" has the negative size {_listed(sizes)}',
            "Sizes are in metres and must be above 0.",
        )
    if min(sizes) == 0:
        ctx.warn(
            tags.VALUE_IGNORED,
            f'a {node.tag} of link "{link}" has the size {_listed(sizes)}, so the {kind} is '
            "ignored",
            origin=node.origin,
            # All zeros are the old way to write a link that is only a frame.
            severity="warning" if any(sizes) else "info",
            values={"link": link, "stated": sizes, "left_out": kind},
        )
        return None
    return shape


def _mesh(node: Node, kind: str, link: str, ctx: UrdfContext) -> Mesh | None:
    uri = node.require("filename").strip()
    scale = node.vec3_of("scale", (1.0, 1.0, 1.0))
    try:
        if 0.0 in scale:
            raise node.fail(
                f'the scale of a mesh of link "{link}" has a component of 0 (got {_listed(scale)})'
            )
        use: Use = "collision" if kind == "collision" else ""
        path = ctx.packages.resolve(uri, node.origin, what="mesh", use=use)
        mesh = Mesh(uri=uri, path=path, scale=scale)
        check_mesh(mesh, origin=node.origin)
    except DescriptionError as error:
        # As in Gazebo, and as in a world, this only affects the one shape.
        ctx.report(
            loss(
                error,
                f'a {kind} of link "{link}" is ignored',
                of=kind,
                origin=node.origin,
                values={"link": link},
            )
        )
        return None
    return mesh
