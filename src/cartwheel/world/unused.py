"""Reports elements of a description that have no effect on the physics."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

from cartwheel.codes import tags
from cartwheel.codes import world as world_codes
from cartwheel.description.meshes import known_size, load_mesh, standing_parts
from cartwheel.description.model import NO_BOUNCE, Joint, Mesh, RobotDescription
from cartwheel.description.paint import paint_of
from cartwheel.errors import Diagnostic, Origin
from cartwheel.world import contact
from cartwheel.world.shapes import picture_error
from cartwheel.world.visuals import SMALL, invisible

_SURFACE = {
    "slip1": "friction is Coulomb friction, without slip",
    "slip2": "friction is Coulomb friction, without slip",
    "min_depth": "penetration is corrected at any depth",
    "max_vel": "the separation speed of penetrating bodies is not limited",
    "max_contacts": "all contacts are used",
    "surface_radius": "the contact patch does not grow with depth; patch_radius sets its size",
    "collide_without_contact": "the shape has no contacts, and contact sensors do not detect it",
}
_HELD = ("fixed", "revolute", "continuous", "ball")
"""Joint types that are constrained correctly when they close a loop."""
_CONTROL = ("ros_control", "ros2_control")
"""Parts of the names of plugins that run controllers."""
_GZ_DRIVES = (
    "diff-drive",
    "mecanum-drive",
    "ackermann-steering",
    "joint-controller",
    "position-controller",
)
"""Parts of the names of gz-sim's plugins whose joints respect their velocity limits."""


def unused(description: RobotDescription) -> Iterator[Diagnostic]:
    """A note for each kind of element without effect, at its first occurrence."""
    found: dict[str, tuple[Origin, int, str]] = {}

    def note(what: str, origin: Origin, why: str) -> None:
        first, count, reason = found.get(what, (origin, 0, why))
        found[what] = (first, count + 1, reason)

    for link in description.links:
        for collision in link.collisions:
            shape = collision.shape
            if description.static and isinstance(shape, Mesh) and standing_parts(shape).hulls:
                why = "a connected component has too many facets and collides as its convex hull"
                note("the triangle surface of a mesh", collision.origin, why)
            if isinstance(shape, Mesh) and shape.convex_decomposition and not description.static:
                why = "meshes that move collide as their convex hull"
                note("the convex decomposition of a mesh", collision.origin, why)
            surface = collision.surface
            for field, why in _SURFACE.items():
                # Gazebo writes 0 for "not set".
                if getattr(surface, field):
                    note(field, collision.origin, why)
            bounce = contact.bounce("", surface)
            if bounce is not None and bounce.threshold >= NO_BOUNCE:
                why = "no impact reaches its <threshold>, which is 100000 m/s by default, unless "
                why += "the other surface states a lower one"
                note("restitution", collision.origin, why)
            if (surface.restitution or 0.0) > 1:
                note("a restitution above 1", collision.origin, "an impact cannot add energy")
        if link.linear_damping or link.angular_damping:
            note("velocity decay", link.origin, "air drag is not simulated")
    for joint in _closing(description):
        if joint.type not in _HELD:
            why = f"a {joint.type} joint that closes a loop constrains only one point"
            note("a joint axis", joint.origin, why)
        elif joint.type != "fixed" and joint.resists:
            why = "not simulated for joints that close a loop"
            note("a joint's limits, damping, friction or spring", joint.origin, why)
    heeded = _controlled(description) | _driven_in_gz(description)
    for joint in description.joints:
        if joint.axis.velocity is not None and joint.drivable and joint.name not in heeded:
            note("a joint's velocity limit", joint.origin, "only controllers and gz-sim use it")
        if joint.stop_cfm is not None or joint.stop_erp is not None:
            note(
                "a joint's stop_cfm or stop_erp",
                joint.origin,
                "the stiffness of joint limits is fixed",
            )
    for what, (origin, count, why) in found.items():
        times = f" ({count} times)" if count > 1 else ""
        yield world_codes.PHYSICS_SETTING_IGNORED.diagnostic(
            f"{what} has no effect{times}: {why}",
            origin=origin,
            values={"setting": what, "count": count},
        )


def unreadable(description: RobotDescription) -> Iterator[Diagnostic]:
    """A warning for each visual that cannot be shown, or not with its image.

    Each image is reported at the first visual that uses it.
    """
    seen: set[Path | bytes | None] = {None}
    for visual in (visual for link in description.links for visual in link.visuals):
        images: set[Path | bytes | None] = {visual.material.texture}
        if isinstance(visual.shape, Mesh):
            if (known_size(visual.shape) or 0.0) > SMALL:
                continue
            parts = load_mesh(visual.shape)
            images = {paint_of(visual.material, part).image for part in parts}
            if any(invisible(part) for part in parts):
                yield tags.VALUE_IGNORED.diagnostic(
                    f'a part of the mesh of visual "{visual.name}" has an area below 1 µm², so it '
                    "is ignored",
                    origin=visual.origin,
                    hint="Check the scale of the mesh.",
                    values={"visual": visual.name, "stated": visual.shape.scale},
                )
        for image in images - seen:
            assert image is not None
            seen.add(image)
            error = picture_error(image)
            if error is not None:
                yield error.code.diagnostic(
                    f"{error.message}, so the surface is rendered in its plain colour",
                    severity="warning",
                    origin=visual.origin,
                    hint=error.hint or "",
                    values=error.values,
                )


def _closing(description: RobotDescription) -> Iterator[Joint]:
    """Joints whose child already has a parent joint."""
    held: set[str] = set()
    for joint in () if description.static else description.joints:
        if joint.child in held:
            yield joint
        held.add(joint.child)


def _controlled(description: RobotDescription) -> set[str]:
    """Joints that ros_control or ros2_control controllers can command, which respect limits."""
    if not any(word in each.filename for each in description.plugins for word in _CONTROL):
        return set()
    return {
        joint.attribute("name") or ""
        for element in (*description.transmissions, *description.ros2_control)
        for joint in element.find_all("joint")
    }


def _driven_in_gz(description: RobotDescription) -> set[str]:
    """Joints that gz-sim's plugins drive at velocities: all texts of the tags of these plugins."""
    return {
        part.text.strip()
        for plugin in description.plugins
        if any(f"{word}-system" in plugin.filename for word in _GZ_DRIVES)
        for part in plugin.element.children
    }
