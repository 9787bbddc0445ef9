"""Reports settings in a description that have no effect on the physics."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator

from cartwheel.codes.world import PHYSICS_SETTING_IGNORED
from cartwheel.description.model import (
    NO_BOUNCE,
    Collision,
    Joint,
    Link,
    Mesh,
    RobotDescription,
    Surface,
)
from cartwheel.errors import Diagnostic, Origin

VELOCITY_LIMIT = "a joint's velocity limit"
"""The value ``setting`` for the speed at which a joint may move."""
_STIFFNESS = "a joint's stop_cfm or stop_erp"
OF_SOLVER = frozenset({"min_depth", "max_vel", "max_contacts", _STIFFNESS})
"""The values ``setting`` for the parameters of ODE's solver, which do not describe the robot."""

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
_Note = Callable[[str, Origin, str], None]
"""Receives a setting, its place, and why it has no effect."""


def idle_settings(descriptions: Iterable[RobotDescription]) -> Iterator[Diagnostic]:
    """A note for each kind of setting without effect, at its first occurrence.

    Args:
        descriptions: The models of a world, or one robot.
    """
    found: dict[str, tuple[Origin, int, str]] = {}

    def note(what: str, origin: Origin, why: str) -> None:
        first, count, reason = found.get(what, (origin, 0, why))
        found[what] = (first, count + 1, reason)

    for description in descriptions:
        for link in description.links:
            _of_link(link, description, note)
        _of_joints(description, note)
    for what, (origin, count, why) in found.items():
        yield without_effect(what, origin, count, why)


def without_effect(what: str, origin: Origin, count: int, why: str) -> Diagnostic:
    """The note for a setting that occurs `count` times, for the first time at `origin`."""
    times = f" ({count} times)" if count > 1 else ""
    return PHYSICS_SETTING_IGNORED.diagnostic(
        f"{what} has no effect{times}: {why}",
        origin=origin,
        values={"setting": what, "count": count},
    )


def _of_link(link: Link, description: RobotDescription, note: _Note) -> None:
    for collision in link.collisions:
        shape = collision.shape
        if isinstance(shape, Mesh) and shape.convex_decomposition and not description.static:
            why = "meshes that move collide as their convex hull"
            note("the convex decomposition of a mesh", collision.origin, why)
        _of_surface(collision, note)
    if link.linear_damping or link.angular_damping:
        note("velocity decay", link.origin, "air drag is not simulated")


def _of_surface(collision: Collision, note: _Note) -> None:
    surface = collision.surface
    for field, why in _SURFACE.items():
        # Gazebo writes 0 for "not set".
        if getattr(surface, field):
            note(field, collision.origin, why)
    if surface.restitution and _never_bounces(surface):
        why = "no impact reaches its <threshold>, which is 100000 m/s by default, unless "
        why += "the other surface states a lower one"
        note("restitution", collision.origin, why)
    if (surface.restitution or 0.0) > 1:
        note("a restitution above 1", collision.origin, "an impact cannot add energy")


def _never_bounces(surface: Surface) -> bool:
    return surface.bounce_threshold is None or surface.bounce_threshold >= NO_BOUNCE


def _of_joints(description: RobotDescription, note: _Note) -> None:
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
            note(VELOCITY_LIMIT, joint.origin, "only controllers and gz-sim use it")
        if joint.stop_cfm is not None or joint.stop_erp is not None:
            note(_STIFFNESS, joint.origin, "the stiffness of joint limits is fixed")


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
