"""``<gazebo reference="link">``: surface, colour, sensors, gravity, damping."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field, replace
from typing import Any

from cartwheel.codes import tags as codes
from cartwheel.description.appearance.materials import gazebo_material, unknown_material
from cartwheel.description.elements.xml import Node
from cartwheel.description.losses import loss
from cartwheel.description.model import Light, Link, Material, Sensor, Visual
from cartwheel.description.sdf.context import not_simulated, read_pose
from cartwheel.description.sdf.light import read_light
from cartwheel.description.sdf.links.material import read_material
from cartwheel.description.sdf.links.surface import not_negative, read_surface
from cartwheel.description.sdf.sensors import read_sensor, read_sensors, sensor_twice
from cartwheel.description.urdf.context import UrdfContext
from cartwheel.description.urdf.merged_gravity import StatedGravity
from cartwheel.errors import DescriptionError, Diagnostic, Origin

LINK_TAGS = (
    "material", "mu", "mu1", "mu2", "fdir1", "kp", "kd", "maxVel", "minDepth", "maxContacts",
    "laserRetro", "selfCollide", "self_collide", "turnGravityOff", "gravity", "dampingFactor",
    "velocity_decay", "kinematic", "canonicalBody", "visual", "collision", "sensor", "plugin",
    "light", "projector", "enable_wind",
)  # fmt: skip

_IDLE = {
    "canonicalBody": "the canonical link is always the root link",
    "projector": "projectors are not supported",
    "audio_source": "audio is not supported",
    "audio_sink": "audio is not supported",
    "battery": "batteries of links are not supported",
    "particle_emitter": "particle emitters are not supported",
    "must_be_base_link": "the base is always the root link",
}
_IDLE_IN_VISUAL = {"plugin": "visual plugins are not supported"}
_SURFACE = {
    "mu": "mu1",
    "mu1": "mu1",
    "mu2": "mu2",
    "kp": "kp",
    "kd": "kd",
    "maxVel": "max_vel",
    "minDepth": "min_depth",
}


_MOTION = {
    "selfCollide": "self_collide",
    "self_collide": "self_collide",
    "kinematic": "kinematic",
    "enable_wind": "wind",
}
_TOUCHED = (*_SURFACE, "fdir1", "maxContacts", "collision")
_SEEN = ("material", "visual")


@dataclass(slots=True)
class LinkTags:
    """The combined tags of one link; later tags override earlier ones."""

    surface: dict[str, Any] = field(default_factory=dict)
    """The stated fields of `Surface`."""
    link: dict[str, Any] = field(default_factory=dict)
    """The stated fields of `Link`."""
    visual: dict[str, Any] = field(default_factory=dict)
    """The stated fields of `Visual`."""
    material: Material | None = None
    laser_retro: float | None = None
    gravity: list[StatedGravity] = field(default_factory=list)
    """The tags about gravity, which count for all links that are merged with this one."""
    sensors: list[Sensor] = field(default_factory=list)
    lights: list[Light] = field(default_factory=list)
    places: dict[str, Origin] = field(default_factory=dict)
    """The first location of each tag."""

    def apply(self, link: Link) -> Link:
        """The link with all tags applied."""
        collisions = link.collisions
        if self.surface or self.laser_retro is not None:
            collisions = tuple(
                replace(
                    each,
                    surface=replace(each.surface, **self.surface),
                    laser_retro=self.laser_retro,
                )
                for each in collisions
            )
        return replace(
            link,
            collisions=collisions,
            visuals=tuple(self._seen(each) for each in link.visuals),
            sensors=(*link.sensors, *self.sensors),
            lights=(*link.lights, *self.lights),
            **self.link,
        )

    def idle(self, link: Link) -> Iterator[Diagnostic]:
        """Diagnostics for tags that do not apply to any part of the link."""
        for what, parts, acting in (
            ("collision", link.collisions, _TOUCHED),
            ("visual", link.visuals, _SEEN),
        ):
            stated = [tag for tag in acting if tag in self.places]
            if stated and not parts:
                yield codes.TAG_IGNORED.diagnostic(
                    f'<{">, <".join(stated)}> has no effect: link "{link.name}" has no <{what}>',
                    origin=self.places[stated[0]],
                    severity="info",
                    values={"tag": stated[0], "link": link.name, "missing": what},
                )

    def _seen(self, visual: Visual) -> Visual:
        fields = dict(self.visual)
        if self.laser_retro is not None:
            fields.setdefault("laser_retro", self.laser_retro)
        if self.material is not None:
            known = self.material.diffuse is not None or self.material.texture is not None
            fields["material"] = (
                self.material if known else replace(visual.material, name=self.material.name)
            )
        return replace(visual, **fields) if fields else visual


def read_link_tags(node: Node, link: str, tags: LinkTags, ctx: UrdfContext) -> None:
    """Adds the tags of one ``<gazebo>`` element.

    Args:
        node: The element.
        link: The referenced link.
        tags: The combined earlier tags; extended in place.
        ctx: Resolves textures, and receives the diagnostics.
    """
    for child in node.children:
        tags.places.setdefault(child.tag, child.origin)
    for tag, name in _SURFACE.items():
        value = not_negative(node.child(tag), ctx)
        if value is not None:
            tags.surface[name] = value
    contacts = node.child("maxContacts")
    if contacts is not None:
        tags.surface["max_contacts"] = contacts.integer()
    direction = node.child("fdir1")
    if direction is not None:
        values = direction.vec3()
        tags.surface["fdir1"] = values if any(values) else None
    retro = node.optional_number_at("laserRetro")
    if retro is not None:
        tags.laser_retro = retro
    _read_motion(node, tags)
    material = node.child("material")
    if material is not None:
        tags.material = _material(material, ctx)
    # SDF requires names for both, which are ignored: the tags apply to all of the link's parts.
    for visual in node.all("visual"):
        visual.get("name")
        _read_visual(visual, tags, ctx)
        warn_idle(visual, _IDLE_IN_VISUAL, ctx)
    for collision in node.all("collision"):
        collision.get("name")
        _read_collision(collision, tags, ctx)
    seen = {sensor.name for sensor in tags.sensors}
    for read in read_sensors(node.all("sensor"), lambda each: read_sensor(each, link), ctx):
        if read.name in seen:
            ctx.report(sensor_twice(link, read))
        seen.add(read.name)
        tags.sensors.append(read)
    for light in node.all("light"):
        tags.lights.append(read_light(light, read_pose(light.child("pose"))))
    warn_idle(node, _IDLE, ctx)


def _read_motion(node: Node, tags: LinkTags) -> None:
    off = node.child("turnGravityOff")
    if off is not None:
        tags.gravity.append(StatedGravity(off.tag, not off.boolean(), off.origin))
    on = node.child("gravity")
    if on is not None:
        tags.gravity.append(StatedGravity(on.tag, on.boolean(), on.origin))
    tags.link |= node.stated_booleans(_MOTION)
    damping = node.optional_number_at("dampingFactor")
    if damping is not None:
        tags.link["linear_damping"] = tags.link["angular_damping"] = max(0.0, damping)
    for which in ("linear", "angular"):
        decay = node.optional_number_at(f"velocity_decay/{which}")
        if decay is not None:
            tags.link[f"{which}_damping"] = max(0.0, decay)


def _material(node: Node, ctx: UrdfContext) -> Material | None:
    if not node.children:
        return _known(Material(name=node.text), node, ctx)
    try:
        return _known(read_material(node, ctx), node, ctx)
    except DescriptionError as error:
        # Gazebo reads only the name, so mistakes in the rest have no effect.
        node.mark()
        ctx.report(
            loss(
                error,
                "the <material> is ignored",
                severity="warning",
                code=codes.VALUE_IGNORED,
                origin=error.origin or node.origin,
            )
        )
        return None


def _known(material: Material, node: Node, ctx: UrdfContext) -> Material | None:
    """The material with the colour of its name, unless it states a colour."""
    if material.diffuse is not None or material.texture is not None or not material.name:
        return material if material.diffuse or material.texture else None
    found = gazebo_material(material.name)
    if found is None:
        ctx.report(unknown_material(material.name, node.origin))
        return material
    return found


def _read_visual(node: Node, tags: LinkTags, ctx: UrdfContext) -> None:
    material = node.child("material")
    if material is not None:
        read = read_material(material, ctx)
        found = gazebo_material(read.name) if read.diffuse is None else None
        tags.material = found or read
    transparency = node.optional_number_at("transparency")
    if transparency is not None:
        tags.visual["transparency"] = min(1.0, max(0.0, transparency))
    tags.visual |= node.stated_booleans({"cast_shadows": "cast_shadows"})
    tags.visual |= node.stated_numbers({"laser_retro": "laser_retro"})


def _read_collision(node: Node, tags: LinkTags, ctx: UrdfContext) -> None:
    contacts = node.child("max_contacts")
    if contacts is not None:
        tags.surface["max_contacts"] = contacts.integer()
    retro = node.optional_number_at("laser_retro")
    if retro is not None:
        tags.laser_retro = retro
    surface = node.child("surface")
    if surface is None:
        return
    tags.surface.update(read_surface(surface, ctx))


def warn_idle(node: Node, reasons: Mapping[str, str], ctx: UrdfContext) -> None:
    """Warns about elements without effect.

    Args:
        node: The parent element.
        reasons: The reason, by tag.
        ctx: Receives the warnings.
    """
    for tag, reason in reasons.items():
        for child in node.all(tag):
            child.mark()
            ctx.report(not_simulated(f"<{tag}> has no effect: {reason}", child))
