"""SDF's ``<link>``: mass, what is seen of it and what it touches with."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

from cartwheel.description.model import (
    Collision,
    Inertial,
    Light,
    Link,
    Sensor,
    Surface,
    Visual,
)
from cartwheel.description.sdf.context import (
    Context,
    check_unique,
    read_pose,
    reference_of,
    require_name,
)
from cartwheel.description.sdf.frames import Frames
from cartwheel.description.sdf.inertia import WATER, inertial_of
from cartwheel.description.sdf.light import read_light
from cartwheel.description.sdf.material import read_material
from cartwheel.description.sdf.sensors import read_sensor
from cartwheel.description.sdf.shapes import read_shape
from cartwheel.description.xml import Node
from cartwheel.geometry import Pose, Vec3

_WITHOUT_COUNTERPART = (
    "must_be_base_link", "enable_wind", "audio_sink", "audio_source", "projector", "battery",
    "particle_emitter",
)  # fmt: skip


def read_link(node: Node, ctx: Context, frames: Frames) -> Link:
    """A link, with all its parts in its own frame.

    Args:
        node: The element.
        ctx: The document's.
        frames: The model's, complete: a part may be placed relative to any of them.
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
    collisions = [_collision(each, ctx, place) for each in node.all("collision")]
    sensors = [_sensor(each, name, place) for each in node.all("sensor")]
    lights = [_light(each, place) for each in node.all("light")]
    check_unique("visual", [(v.name, v.origin) for v in visuals if v])
    check_unique("collision", [(c.name, c.origin) for c in collisions if c])
    check_unique("sensor", [(s.name, s.origin) for s in sensors])
    for tag in _WITHOUT_COUNTERPART:
        for part in node.all(tag):
            part.mark()
            if part.children or part.text.strip().lower() in ("true", "1"):
                ctx.tell("warning", f"<{tag}> is not simulated", part.origin)
    decay = node.child("velocity_decay")
    return Link(
        name=name,
        pose=pose,
        inertial=_inertial(node, ctx, place, [c for c in collisions if c is not None]),
        visuals=tuple(v for v in visuals if v is not None),
        collisions=tuple(c for c in collisions if c is not None),
        sensors=tuple(sensors),
        lights=tuple(lights),
        gravity=node.boolean_at("gravity", True),
        self_collide=_optional_boolean(node, "self_collide"),
        kinematic=node.boolean_at("kinematic", False),
        linear_damping=decay.number_at("linear", 0.0) if decay is not None else 0.0,
        angular_damping=decay.number_at("angular", 0.0) if decay is not None else 0.0,
        origin=node.origin,
    )


Place = Callable[[Node], Pose]


def _inertial(link: Node, ctx: Context, place: Place, collisions: list[Collision]) -> Inertial:
    """The link's mass; SDF's default of 1 kg and 1 kg m² where it states none."""
    node = link.child("inertial")
    if node is None:
        return Inertial(mass=1.0, ixx=1.0, iyy=1.0, izz=1.0, origin=link.origin)
    if node.boolean_of("auto", False):
        return _auto_inertial(link, node, ctx, collisions)
    for ignored in ("fluid_added_mass", "auto_inertia_params"):
        part = node.child(ignored)
        if part is not None:
            part.mark()
            ctx.tell("warning", f"<{ignored}> is not simulated", part.origin)
    tensor = node.child("inertia")
    if tensor is not None and any("nan" in each.text.lower() for each in tensor.children):
        # What a model editor wrote for a mesh whose volume it could not tell.
        tensor.mark()
        ctx.tell(
            "warning",
            f'the inertia of link "{link.attributes.get("name")}" is not a number: '
            "SDF's default counts, 1 kg m²",
            tensor.origin,
        )
        tensor = None

    def entry(tag: str, default: float) -> float:
        return tensor.number_at(tag, default) if tensor is not None else default

    return Inertial(
        mass=node.number_at("mass", 1.0),
        pose=place(node),
        ixx=entry("ixx", 1.0),
        iyy=entry("iyy", 1.0),
        izz=entry("izz", 1.0),
        ixy=entry("ixy", 0.0),
        ixz=entry("ixz", 0.0),
        iyz=entry("iyz", 0.0),
        origin=node.origin,
    )


def _auto_inertial(link: Node, node: Node, ctx: Context, collisions: list[Collision]) -> Inertial:
    """SDF 1.11: the mass follows from the density, unless it is stated too."""
    default = node.number_at("density", WATER)
    stated = {
        each.attributes.get("name"): each.number_at("density", default)
        for each in link.all("collision")
    }
    node.mark()
    densities = [stated.get(each.name, default) for each in collisions]
    found = inertial_of(collisions, densities, node.origin)
    if found is None:
        ctx.tell(
            "warning",
            f'link "{link.attributes.get("name")}" has no solid collision to take its inertia '
            "from: 1 kg and 1 kg m² are used",
            node.origin,
        )
        return Inertial(mass=1.0, ixx=1.0, iyy=1.0, izz=1.0, origin=node.origin)
    mass = node.number_at("mass", found.mass)
    if mass <= 0:
        raise node.fail(f"the mass must be above 0, but is {mass:g}")
    factor = mass / found.mass
    return replace(
        found,
        mass=mass,
        ixx=found.ixx * factor,
        iyy=found.iyy * factor,
        izz=found.izz * factor,
        ixy=found.ixy * factor,
        ixz=found.ixz * factor,
        iyz=found.iyz * factor,
    )


def _visual(node: Node, ctx: Context, place: Place) -> Visual | None:
    name = require_name(node)
    material = read_material(node.child("material"), ctx)
    transparency = min(1.0, max(0.0, node.number_at("transparency", 0.0)))
    shadows = node.boolean_at("cast_shadows", True)
    retro = node.optional_number_at("laser_retro")
    pose = place(node)
    for tag in ("meta", "visibility_flags", "plugin"):
        for part in node.all(tag):
            part.mark()
            if tag == "plugin":
                ctx.tell("warning", "a plugin of a visual is not run", part.origin)
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


def _collision(node: Node, ctx: Context, place: Place) -> Collision | None:
    name = require_name(node)
    limit = node.child("max_contacts")
    surface = _surface(node.child("surface"), limit.integer() if limit is not None else None, ctx)
    retro = node.optional_number_at("laser_retro")
    pose = place(node)
    for tag in ("density", "auto_inertia_params"):
        for part in node.all(tag):
            part.mark()
    shape = read_shape(node, ctx)
    if shape is None:
        return None
    return Collision(
        name=name, pose=pose, shape=shape, surface=surface, laser_retro=retro, origin=node.origin
    )


def _surface(node: Node | None, max_contacts: int | None, ctx: Context) -> Surface:
    """Friction and contact of ODE; those of other engines count where ODE's are not stated."""
    if node is None:
        return Surface(max_contacts=max_contacts)
    # Stiffness as ODE's solver parameters, which kp and kd say as well.
    for path in ("contact/ode/soft_cfm", "contact/ode/soft_erp", "bounce/threshold",
                 "contact/collide_without_contact_bitmask", "contact/category_bitmask",
                 "contact/poissons_ratio", "contact/elastic_modulus"):  # fmt: skip
        node.find(path)
    for tag in ("friction/bullet", "contact/bullet", "soft_contact"):
        part = node.find(tag)
        if part is not None:
            part.mark()
    direction = node.find("friction/ode/fdir1")
    fdir1: Vec3 | None = direction.vec3() if direction is not None else None
    if fdir1 is not None and not any(fdir1):
        fdir1 = None  # what Gazebo writes where no direction is asked for
    if direction is not None:
        for prefix in ("gz", "ignition"):
            direction.get(f"{prefix}:expressed_in")
    torsional = node.find("friction/torsional")
    coefficient: float | None = None
    if torsional is not None:
        for tag in ("use_patch_radius", "patch_radius", "surface_radius", "ode"):
            part = torsional.child(tag)
            if part is not None:
                part.mark()
        coefficient = torsional.optional_number_at("coefficient")
    mask = node.find("contact/collide_bitmask")
    numbers = {
        key: _not_negative(node, path, ctx)
        for key, path in (
            ("mu1", "friction/ode/mu"),
            ("mu2", "friction/ode/mu2"),
            ("slip1", "friction/ode/slip1"),
            ("slip2", "friction/ode/slip2"),
            ("kp", "contact/ode/kp"),
            ("kd", "contact/ode/kd"),
            ("min_depth", "contact/ode/min_depth"),
            ("restitution", "bounce/restitution_coefficient"),
        )
    }
    return Surface(
        fdir1=fdir1,
        torsional=coefficient,
        max_vel=node.optional_number_at("contact/ode/max_vel", infinite=True),
        max_contacts=max_contacts,
        collide_bitmask=_bitmask(mask),
        collide_without_contact=node.boolean_at("contact/collide_without_contact", False),
        mu1=numbers["mu1"],
        mu2=numbers["mu2"],
        slip1=numbers["slip1"],
        slip2=numbers["slip2"],
        kp=numbers["kp"],
        kd=numbers["kd"],
        min_depth=numbers["min_depth"],
        restitution=numbers["restitution"],
    )


def _not_negative(node: Node, path: str, ctx: Context) -> float | None:
    """A coefficient; -1, which some files write for "the default", is as if not stated."""
    found = node.find(path)
    if found is None:
        return None
    value = found.number(infinite=True)
    if value < 0:
        ctx.tell(
            "warning", f"{found.tag} {found.text} is below 0: the default counts", found.origin
        )
        return None
    return value


def _bitmask(node: Node | None) -> int | None:
    if node is None:
        return None
    try:
        return int(node.text, 0)
    except ValueError:
        raise node.fail(f'collide_bitmask "{node.text}" is no whole number') from None


def _sensor(node: Node, link: str, place: Place) -> Sensor:
    return read_sensor(node, link, place(node))


def _light(node: Node, place: Place) -> Light:
    return read_light(node, place(node))


def _optional_boolean(node: Node, tag: str) -> bool | None:
    found = node.child(tag)
    return found.boolean() if found is not None else None
