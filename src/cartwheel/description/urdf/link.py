"""URDF's ``<link>``: mass, visuals and collisions."""

from __future__ import annotations

from dataclasses import dataclass, field, replace

from cartwheel.codes import robot, tags
from cartwheel.description.elements import numbers
from cartwheel.description.elements.xml import Node
from cartwheel.description.files.packages import Packages
from cartwheel.description.inertia import HEAVIEST, impossibility, made_possible, principal_moments
from cartwheel.description.losses import loss
from cartwheel.description.meshes import load_mesh
from cartwheel.description.model import (
    Box,
    Capsule,
    Collision,
    Cylinder,
    Inertial,
    Link,
    Material,
    Mesh,
    Rgba,
    Shape,
    Sphere,
    Visual,
)
from cartwheel.errors import DescriptionError, Diagnostic, Origin, meant, suggestion
from cartwheel.geometry import Pose

SHAPES = ("box", "cylinder", "sphere", "capsule", "mesh")


@dataclass(kw_only=True, slots=True)
class UrdfContext:
    """Shared state of the readers of one URDF."""

    packages: Packages
    materials: dict[str, Material] = field(default_factory=dict)
    """Materials defined for the whole robot."""
    diagnostics: list[Diagnostic] = field(default_factory=list)

    def report(self, diagnostic: Diagnostic) -> None:
        """Adds a diagnostic."""
        self.diagnostics.append(diagnostic)


@dataclass(frozen=True, kw_only=True, slots=True)
class ReadLink:
    """A link whose mass has not been checked yet, because this requires the tree."""

    link: Link
    """Without inertial and pose."""
    inertial: Inertial | None
    inertial_origin: Origin | None


def read_origin(node: Node) -> Pose:
    """The ``<origin xyz rpy>`` of an element; identity if missing."""
    origin = node.child("origin")
    if origin is None:
        return Pose()
    xyz = numbers.position(origin.vec3_of("xyz", (0.0, 0.0, 0.0)), "origin xyz", origin.origin)
    return Pose.from_xyz_rpy(xyz, origin.vec3_of("rpy", (0.0, 0.0, 0.0)))


def read_materials(robot: Node, ctx: UrdfContext) -> None:
    """Reads the materials available to the whole robot, wherever they are defined."""
    for node in robot.all("material"):
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
        ctx.report(
            tags.MATERIAL_DIFFERS.diagnostic(
                f'the material "{name}" has two different definitions; the first one is used',
                origin=node.origin,
                values={"name": name},
            )
        )


def read_link(node: Node, ctx: UrdfContext) -> ReadLink:
    """A link, with its parts named as in Gazebo.

    Raises:
        DescriptionError: A size is impossible, or a value is not a number.
    """
    name = node.require("name").strip()
    visuals: list[Visual] = []
    for part in node.all("visual"):
        visual = _visual(part, _numbered(f"{name}_visual", len(visuals)), ctx)
        if visual is not None:
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
    inertial = node.child("inertial")
    return ReadLink(
        link=Link(
            name=name, visuals=tuple(visuals), collisions=tuple(collisions), origin=node.origin
        ),
        inertial=_inertial(inertial) if inertial is not None else None,
        inertial_origin=inertial.origin if inertial is not None else None,
    )


def _numbered(name: str, index: int) -> str:
    return f"{name}_{index}" if index else name


def _visual(node: Node, default: str, ctx: UrdfContext) -> Visual | None:
    stated = (node.get("name") or "").strip()
    shape = read_geometry(node, "visual", default.removesuffix("_visual"), ctx)
    pose = read_origin(node)
    material = _material(node.child("material"), ctx)
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


def _material(node: Node | None, ctx: UrdfContext) -> Material:
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
        ctx.report(
            tags.MATERIAL_UNDEFINED.diagnostic(
                f'the material "{name}" is not defined',
                origin=node.origin,
                hint=suggestion(name, known) if known else "",
                values={"name": name, "meant": meant(name, known)},
            )
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
    text = node.require("rgba")
    values = text.split()
    try:
        if len(values) == 3:
            ctx.report(
                tags.VALUE_IGNORED.diagnostic(
                    f'the colour "{text}" has no alpha value, so 1 is used',
                    origin=node.origin,
                    values={"stated": text},
                )
            )
            values = [*values, "1"]
        r, g, b, a = numbers.vector(" ".join(values), 4, "color rgba", node.origin)
    except DescriptionError as error:
        ctx.report(
            loss(error, "the colour is ignored", severity="warning", code=tags.VALUE_IGNORED)
        )
        return None
    rgba = (_share(r), _share(g), _share(b), _share(a))
    if rgba != (r, g, b, a):
        ctx.report(
            tags.VALUE_IGNORED.diagnostic(
                f'the colour "{text}" has values outside 0 to 1, which are clipped',
                origin=node.origin,
                values={"stated": text},
            )
        )
    return rgba


def _share(value: float) -> float:
    return min(1.0, max(0.0, value))


def read_geometry(owner: Node, kind: str, link: str, ctx: UrdfContext) -> Shape | None:
    """The shape of a visual or collision; None if it is skipped."""
    geometry = owner.child("geometry")
    if geometry is None:
        raise owner.fail(
            f'a {kind} of link "{link}" has no <geometry>',
            code=tags.TAG_MISSING,
            values={"missing": "geometry", "link": link},
        )
    for tag in SHAPES:
        node = geometry.child(tag)
        if node is None:
            continue
        if tag == "mesh":
            return _mesh(node, kind, link, ctx)
        return _primitive(node, kind, link, ctx)
    if geometry.children:
        wrong = geometry.children[0]
        raise wrong.fail(
            f'the geometry <{wrong.tag}> of link "{link}" is unknown',
            suggestion(wrong.tag, SHAPES),
            code=tags.TYPE_UNKNOWN,
            values={"name": wrong.tag, "meant": meant(wrong.tag, SHAPES), "link": link},
        )
    raise geometry.fail(
        f'the <geometry> of a {kind} of link "{link}" is empty',
        f"Add one of: {', '.join(SHAPES)}.",
        code=tags.TAG_MISSING,
        values={"link": link},
    )


def _primitive(node: Node, kind: str, link: str, ctx: UrdfContext) -> Shape | None:
    shape: Shape
    if node.tag == "box":
        size = node.vec3_of("size")
        if min(size) < 0:
            # Gazebo Classic draws it inside out, with the absolute size.
            ctx.report(
                tags.VALUE_IGNORED.diagnostic(
                    f'a box of link "{link}" has the negative size {_listed(size)}, so the sign is '
                    "ignored",
                    origin=node.origin,
                    values={"link": link, "stated": size},
                )
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
        ctx.report(
            tags.VALUE_IGNORED.diagnostic(
                f'a {node.tag} of link "{link}" has the size {_listed(sizes)}, so the {kind} is '
                "ignored",
                origin=node.origin,
                # All zeros are the old way to write a link that is only a frame.
                severity="warning" if any(sizes) else "info",
                values={"link": link, "stated": sizes, "left_out": kind},
            )
        )
        return None
    return shape


def _mesh(node: Node, kind: str, link: str, ctx: UrdfContext) -> Mesh | None:
    uri = node.require("filename").strip()
    scale = node.vec3_of("scale", (1.0, 1.0, 1.0))
    if 0.0 in scale:
        raise node.fail(
            f'the scale of a mesh of link "{link}" has a component of 0 (got {_listed(scale)})'
        )
    try:
        path = ctx.packages.resolve(uri, node.origin, what="mesh")
        mesh = Mesh(uri=uri, path=path, scale=scale)
        load_mesh(mesh, origin=node.origin)
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


def _inertial(node: Node) -> Inertial:
    mass = node.require_child("mass").number_of("value")
    if mass > HEAVIEST:
        raise node.fail(f"a mass must be at most {HEAVIEST:g} kg (got {mass:g})")
    tensor = node.child("inertia")
    values = {
        key: tensor.number_of(key, 0.0) if tensor is not None else 0.0
        for key in ("ixx", "iyy", "izz", "ixy", "ixz", "iyz")
    }
    return Inertial(mass=mass, pose=read_origin(node), origin=node.origin, **values)


def judged_inertia(inertial: Inertial, link: str, *, rigid: bool, ctx: UrdfContext) -> Inertial:
    """A link's inertia, or the nearest physically possible one.

    Many published arms contain a link with an impossible inertia. Gazebo uses whatever is stated;
    an energy-conserving engine cannot.

    Args:
        inertial: Inertial with a positive mass.
        link: Link name.
        rigid: Whether the link is fixed to another link, so that its inertia is only part of a sum.
        ctx: Receives the diagnostics.

    Raises:
        DescriptionError: No principal moment is positive.
    """
    i = inertial
    diagonal, products = i.diagonal, i.products
    moments = principal_moments(diagonal, products)
    found = impossibility(moments)
    if found is None:
        return inertial
    message, hint = found
    if not any((*diagonal, *products)):
        if rigid:
            ctx.report(
                robot.INERTIA_IMPOSSIBLE.diagnostic(
                    f'link "{link}" is a point mass: its inertia is 0',
                    origin=i.origin,
                    severity="info",
                    values={"link": link},
                )
            )
        return inertial  # a rotating part without any inertia gets one as a whole
    if moments[2] <= 0:
        raise DescriptionError(
            f'link "{link}": {message}',
            code=robot.INERTIA_IMPOSSIBLE,
            origin=i.origin,
            hint=hint,
            values={"link": link, "moments": moments},
        )
    (ixx, iyy, izz), (ixy, ixz, iyz) = made_possible(diagonal, products)
    made = replace(i, ixx=ixx, iyy=iyy, izz=izz, ixy=ixy, ixz=ixz, iyz=iyz)
    smaller = principal_moments(made.diagonal, made.products)
    ctx.report(
        robot.INERTIA_IMPOSSIBLE.diagnostic(
            f'link "{link}": {message}; Cartwheel increases the smaller moments to '
            f"{smaller[0]:.4g} and {smaller[1]:.4g}",
            origin=i.origin,
            hint=hint,
            severity="info" if rigid else "warning",
            values={"link": link, "moments": moments, "used": smaller},
        )
    )
    return made


def _listed(values: tuple[float, ...]) -> str:
    return " ".join(f"{value:g}" for value in values)
