"""URDF's ``<link>``: mass, what is seen of it and what it touches with."""

from __future__ import annotations

from dataclasses import dataclass, field, replace

from cartwheel.description import numbers
from cartwheel.description.inertia import HEAVIEST, impossibility, made_possible, principal_moments
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
from cartwheel.description.packages import Packages
from cartwheel.description.xml import Node
from cartwheel.errors import DescriptionError, Diagnostic, Origin, Severity, suggestion
from cartwheel.geometry import Pose

SHAPES = ("box", "cylinder", "sphere", "capsule", "mesh")


@dataclass(kw_only=True, slots=True)
class UrdfContext:
    """What the readers of one URDF share."""

    packages: Packages
    materials: dict[str, Material] = field(default_factory=dict)
    """Those defined for the whole robot."""
    diagnostics: list[Diagnostic] = field(default_factory=list)

    def tell(self, severity: Severity, message: str, origin: Origin) -> None:
        """Adds a diagnostic."""
        self.diagnostics.append(Diagnostic(severity=severity, message=message, origin=origin))


@dataclass(frozen=True, kw_only=True, slots=True)
class ReadLink:
    """A link whose mass is not judged yet: that takes the tree."""

    link: Link
    """Without inertial, and without pose."""
    inertial: Inertial | None
    inertial_origin: Origin | None


def read_origin(node: Node) -> Pose:
    """The ``<origin xyz rpy>`` of an element, identity where there is none."""
    origin = node.child("origin")
    if origin is None:
        return Pose()
    xyz = numbers.position(origin.vec3_of("xyz", (0.0, 0.0, 0.0)), "origin xyz", origin.origin)
    return Pose.from_xyz_rpy(xyz, origin.vec3_of("rpy", (0.0, 0.0, 0.0)))


def read_materials(robot: Node, ctx: UrdfContext) -> None:
    """The materials that the whole robot may name, wherever they are defined."""
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
        ctx.tell(
            "warning",
            f'the material "{name}" is defined twice, differently: the first counts',
            node.origin,
        )


def read_link(node: Node, ctx: UrdfContext) -> ReadLink:
    """A link, its parts named as Gazebo names them.

    Raises:
        DescriptionError: an impossible size, a number that is none.
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
        ctx.tell(
            "warning",
            f'the material "{name}" is not defined. {suggestion(name, sorted(ctx.materials))}',
            node.origin,
        )
    return Material(name=name)


def _stated(node: Node, name: str, ctx: UrdfContext) -> Material | None:
    """What a ``<material>`` says itself; None where it is but a name."""
    colour, texture = node.child("color"), node.child("texture")
    if colour is None and texture is None:
        return None
    rgba = _colour(colour, ctx) if colour is not None else None
    path = None
    if texture is not None:
        try:
            path = ctx.packages.resolve(texture.require("filename"), texture.origin, what="texture")
        except DescriptionError as error:
            hint = f". {error.hint}" if error.hint else ""
            ctx.tell("warning", f"{error.message}{hint}", texture.origin)
    return Material(name=name, diffuse=rgba, texture=path)


def _colour(node: Node, ctx: UrdfContext) -> Rgba | None:
    """Of a material; None where it is none, which leaves a robot without it. Source: urdfdom."""
    text = node.require("rgba")
    values = text.split()
    try:
        if len(values) == 3:
            ctx.tell(
                "warning", f'the colour "{text}" has no opacity: it is taken for 1', node.origin
            )
            values = [*values, "1"]
        r, g, b, a = numbers.vector(" ".join(values), 4, "color rgba", node.origin)
    except DescriptionError as error:
        ctx.tell("warning", f"{error.message}: the colour is left out", node.origin)
        return None
    rgba = (_share(r), _share(g), _share(b), _share(a))
    if rgba != (r, g, b, a):
        ctx.tell("warning", f'the colour "{text}" is not within 0 and 1', node.origin)
    return rgba


def _share(value: float) -> float:
    return min(1.0, max(0.0, value))


def read_geometry(owner: Node, kind: str, link: str, ctx: UrdfContext) -> Shape | None:
    """The shape of a visual or collision; None where it has none that can be had."""
    geometry = owner.child("geometry")
    if geometry is None:
        raise owner.fail(f'a {kind} of link "{link}" has no <geometry>')
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
            f'the geometry <{wrong.tag}> of link "{link}" is not known',
            suggestion(wrong.tag, SHAPES),
        )
    raise geometry.fail(
        f'the <geometry> of a {kind} of link "{link}" is empty',
        f"It holds one of: {', '.join(SHAPES)}.",
    )


def _primitive(node: Node, kind: str, link: str, ctx: UrdfContext) -> Shape | None:
    shape: Shape
    if node.tag == "box":
        size = node.vec3_of("size")
        if min(size) < 0:
            # Gazebo Classic draws it, inside out, as large as it is without the sign.
            ctx.tell(
                "warning",
                f'a box of link "{link}" has the negative size {_listed(size)}: '
                "it counts without the sign",
                node.origin,
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
            "Sizes are metres, above 0.",
        )
    if min(sizes) == 0:
        ctx.tell(
            # The old way to write a link that is but a frame.
            "warning" if any(sizes) else "info",
            f'a {node.tag} of link "{link}" has the size {_listed(sizes)}: the {kind} is left out',
            node.origin,
        )
        return None
    return shape


def _mesh(node: Node, kind: str, link: str, ctx: UrdfContext) -> Mesh | None:
    uri = node.require("filename").strip()
    scale = node.vec3_of("scale", (1.0, 1.0, 1.0))
    if 0.0 in scale:
        raise node.fail(f'the scale of a mesh of link "{link}" is {_listed(scale)}: it is flat')
    try:
        path = ctx.packages.resolve(uri, node.origin, what="mesh")
        mesh = Mesh(uri=uri, path=path, scale=scale)
        load_mesh(mesh, origin=node.origin)
    except DescriptionError as error:
        # As in Gazebo, and as in a world: it costs the one shape.
        hint = f" {error.hint}" if error.hint else ""
        loss = " and touches nothing" if kind == "collision" else ""
        ctx.tell(
            "error",
            f'{error.message}; a {kind} of link "{link}" is left out{loss}.{hint}',
            node.origin,
        )
        return None
    return mesh


def _inertial(node: Node) -> Inertial:
    mass = node.require_child("mass").number_of("value")
    if mass > HEAVIEST:
        raise node.fail(f"a mass must be at most {HEAVIEST:g} kg, but is {mass:g}")
    tensor = node.child("inertia")
    values = {
        key: tensor.number_of(key, 0.0) if tensor is not None else 0.0
        for key in ("ixx", "iyy", "izz", "ixy", "ixz", "iyz")
    }
    return Inertial(mass=mass, pose=read_origin(node), origin=node.origin, **values)


def judged_inertia(inertial: Inertial, link: str, *, rigid: bool, ctx: UrdfContext) -> Inertial:
    """A link's inertia, or the nearest to it that a body can have.

    Many a published arm has a link with one, and Gazebo computes with whatever is written; an
    engine that conserves energy cannot.

    Args:
        inertial: With a mass above 0.
        link: Its link's name.
        rigid: Whether the link is fixed to another: then its inertia is but a part of a sum.
        ctx: Takes the diagnostics.

    Raises:
        DescriptionError: No principal moment is above 0.
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
            ctx.tell("info", f'link "{link}" is a point mass: its inertia is 0', i.origin)
        return inertial  # a part that turns without any inertia is given one as a whole
    if moments[2] <= 0:
        raise DescriptionError(f'link "{link}": {message}', origin=i.origin, hint=hint)
    (ixx, iyy, izz), (ixy, ixz, iyz) = made_possible(diagonal, products)
    made = replace(i, ixx=ixx, iyy=iyy, izz=izz, ixy=ixy, ixz=ixz, iyz=iyz)
    smaller = principal_moments(made.diagonal, made.products)
    ctx.tell(
        "info" if rigid else "warning",
        f'link "{link}": {message}; here the smaller are {smaller[0]:.4g} and {smaller[1]:.4g}. '
        f"{hint}",
        i.origin,
    )
    return made


def _listed(values: tuple[float, ...]) -> str:
    return " ".join(f"{value:g}" for value in values)
