"""Adds a model's links and joints as MuJoCo bodies."""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import dataclass, replace
from typing import Any, Literal

import mujoco

from cartwheel.codes import world as world_codes
from cartwheel.description.model import (
    Collision,
    Ellipsoid,
    Inertial,
    Joint,
    Link,
    Plane,
    Shape,
)
from cartwheel.errors import Origin, WorldError
from cartwheel.geometry import Pose, Vec3, rotate
from cartwheel.world import contact, joints
from cartwheel.world.actuation import add_requested
from cartwheel.world.additions import Added, Addition
from cartwheel.world.balance import stands_on_width
from cartwheel.world.entry import SHIFT, TURN, TYRE, ModelEntry, part_name, scoped
from cartwheel.world.inertials import set_inertial
from cartwheel.world.lights import add_light
from cartwheel.world.self_collisions import exclude_links
from cartwheel.world.shapes import Assets, pose_arguments, solids
from cartwheel.world.tyres import Axle, Steering, axle_of, is_upright, lowest, tread_of, tyre
from cartwheel.world.visuals import add_visual

Shapes = Literal["all", "collisions", "visuals"]
"""The shapes of a spec."""
COLLISION_GROUP = 4
TYRE_MASS = 1e-6
"""Mass of a tyre that slips on its wheel, kg: small enough to have no effect."""
_TYRE_SHARE = 0.02
"""Inertia of a slipping tyre as a fraction of the model's mass."""


@dataclass(frozen=True, slots=True)
class _Branch:
    """A link that will be added as a body."""

    link: Link
    parent: Any
    """The parent body."""
    pose: Pose
    """Pose in the parent body."""
    moves: bool
    """Whether the parent body can move."""
    trunk: bool
    """Whether it is connected to a free root only by fixed joints."""
    axle: Axle | None = None
    """The parent body's axle, if the parent is a wheel."""
    steered: Steering = "not"
    """Whether the joints above it rotate about the vertical."""
    pivot: Vec3 | None = None
    """A point on the last of these joints' axes in the model, m; None if it has no single axis."""
    driven: bool = False
    """Whether a motor turns the axle."""
    carried: bool = False
    """Whether it is mounted on a wheel."""


class BodyBuilder:
    """Adds one model to a spec.

    Args:
        spec: The spec.
        assets: Its meshes and textures.
        step: Time step, s.
        without: Additions to the description that are omitted.
        shapes: The shapes to add.
    """

    def __init__(
        self,
        spec: mujoco.MjSpec,
        assets: Assets,
        step: float,
        without: Collection[Addition] = (),
        shapes: Shapes = "all",
    ) -> None:
        self._spec = spec
        self._assets = assets
        self._step = step
        self._without = without
        self._visuals = shapes != "collisions"
        self._collisions = shapes != "visuals"
        self.added: list[Added] = []
        """What was added to the descriptions."""
        self.surfaces: list[contact.BuiltSurface] = []
        """All collision geoms with their contact properties."""
        self._wide = False
        """Whether the model stands by the width of its tyres, so that they are not rounded."""
        self.geoms: dict[str, Any] = {}
        """These geoms in the spec, by name."""

    def add(self, entry: ModelEntry) -> None:
        """Adds the entry's bodies, joints, geoms, motors and cameras.

        Raises:
            WorldError: The description cannot be built; the error has the element's origin.
        """
        description = entry.description
        inbound: dict[str, Joint] = {}
        loops: list[Joint] = []
        for joint in description.joints:
            if joint.child in inbound:
                loops.append(joint)
            else:
                inbound[joint.child] = joint
        children: dict[str, list[Joint]] = {}
        for joint in inbound.values():
            children.setdefault(joint.parent, []).append(joint)
        bodies: dict[str, Any] = {}
        links = {link.name: link for link in description.links}
        senses = bool(description.plugins) or any(link.sensors for link in description.links)
        self._wide = self._collisions and stands_on_width(description)

        for link in description.links:
            if link.name in inbound and inbound[link.name].parent != "world":
                continue
            anchor = inbound.get(link.name)
            free = anchor is None and not description.static and not link.kinematic
            there = entry.pose @ link.pose
            # Iterative, because chains may exceed Python's recursion limit.
            waiting = [_Branch(link, self._spec.worldbody, there, moves=free, trunk=free)]
            while waiting:
                branch = waiting.pop()
                grown = self._grow(entry, branch, inbound.get(branch.link.name), senses=senses)
                bodies[branch.link.name] = grown.parent
                waiting += [
                    replace(
                        grown,
                        link=(child := links[joint.child]),
                        pose=branch.link.pose.inverse() @ child.pose,
                    )
                    for joint in reversed(children.get(branch.link.name, ()))
                ]
            if free:
                bodies[link.name].add_freejoint(name=scoped(entry.name, link.name))
        lost = [link for link in description.links if link.name not in bodies]
        if lost:
            raise WorldError(
                f'link "{lost[0].name}" is part of a loop of joints, and no joint connects this '
                "loop to the root of the model",
                code=world_codes.LOOP_WITHOUT_ROOT,
                origin=lost[0].origin,
                values={"link": lost[0].name},
            )
        for joint in loops:
            joints.close_loop(self._spec, entry, joint)
        apart = "apart-hulls" not in self._without
        self.added += exclude_links(self._spec, entry, description, apart=apart)
        add_requested(self._spec, entry, bodies)

    def _grow(
        self, entry: ModelEntry, branch: _Branch, joint: Joint | None, *, senses: bool
    ) -> _Branch:
        """Adds a link's body; returns the parent values for its child links."""
        link, moves, axle = branch.link, branch.moves, branch.axle
        trunk = branch.trunk and (joint is None or joint.type == "fixed")
        body = branch.parent.add_body(
            name=scoped(entry.name, link.name), **pose_arguments(branch.pose)
        )
        roots = moves and joint is None
        if joint is not None and not entry.description.static:
            joints.add_joint(self._spec, entry, body, joint)
            roots = not moves and joint.type != "fixed"
            moves = moves or roots
        if roots and senses:
            # A sleeping body has no accelerations or contacts to read.
            body.sleep = mujoco.mjtSleepPolicy.mjSLEEP_NEVER
        # A tyre may be fixed to a hub.
        held = joint is not None and joint.type == "fixed" and axle is not None
        axle = axle.seen_from(branch.pose) if held and axle is not None else axle_of(joint)
        driven = branch.driven if held else joint is not None and joint.name in entry.motors
        self._fill(entry, body, replace(branch, driven=driven), axle, moves=moves, trunk=trunk)
        rolling = axle is not None and not _is_upright(link, axle)
        steered, pivot = branch.steered, branch.pivot
        if joint is not None and _steers(link, joint):
            turns = joint.type in ("revolute", "continuous")
            pivot = (link.pose @ joint.pose).position if turns else None
        if joint is not None and _steers(link, joint) and steered != "by motors":
            steered = "by motors" if joint.name in entry.motors else "freely"
        return replace(
            branch,
            parent=body,
            moves=moves,
            axle=axle,
            trunk=trunk,
            steered=steered,
            pivot=pivot,
            driven=driven,
            carried=branch.carried or rolling,
        )

    def _fill(
        self, entry: ModelEntry, body: Any, branch: _Branch, axle: Axle | None, *, moves: bool,
        trunk: bool,
    ) -> None:  # fmt: skip
        link = branch.link
        # A turntable is no wheel; but the axles of rollers on a wheel point upward now and then.
        turntable = axle is not None and not branch.carried and _is_upright(link, axle)
        if link.inertial is not None:
            self._set_inertial(entry, body, link.name, link.inertial, moves=moves)
        if not link.gravity:
            body.gravcomp = 1.0
        for visual in link.visuals if self._visuals else ():
            add_visual(body, visual, self._assets, moves=moves)
        for light in link.lights:
            add_light(body, scoped(entry.name, link.name, light.name), light)
        if axle is not None and link.name in entry.slips:
            body = _add_tyre(entry, body, link, axle)
        for described in link.collisions if self._collisions else ():
            collision = described
            if (grip := entry.grips.get(link.name)) is not None:
                collision = replace(described, surface=grip.given_to(described.surface))
            name = scoped(entry.name, link.name, collision.name)
            shape, place = self._rounded(entry, link, collision, None if turntable else axle)
            there = link.pose @ place
            tread = None
            if axle is not None:
                along = axle.seen_from(link.pose.inverse())
                tread = tread_of(
                    *self._tread(link, collision, axle, (shape, there)),
                    along,
                    steered=branch.steered,
                    pivot=branch.pivot,
                    driven=branch.driven,
                    carried=branch.carried,
                )
            bottom = lowest(shape, there) if trunk else None
            # A ball caster on a joint about the vertical does not roll.
            spins = axle is not None and tread is None and not branch.driven and not branch.carried
            low = lowest(shape, there) if spins else None
            if isinstance(shape, Plane) and moves:
                raise WorldError(
                    f'collision "{collision.name}" is an infinite plane, but its link can move',
                    code=world_codes.PLANE_NOT_STATIC,
                    origin=collision.origin,
                    values={"collision": collision.name},
                    hint="Use a flat box instead, <static>true</static>, or a fixed joint to the "
                    "world.",
                )
            # The base of an arm uses its convex hull, like the other links; nothing is placed
            # inside it.
            whole = moves or not entry.description.static
            parts = solids(shape, place, collision.origin, self._assets, moves=whole)
            friction = contact.friction(collision.surface)
            reference = contact.reference(collision.surface, entry.description.mass, self._step)
            category, collide = contact.masks(collision.surface)
            for number, (arguments, pose) in enumerate(parts):
                geom = body.add_geom(
                    name=part_name(name, number),
                    group=COLLISION_GROUP,
                    density=0,
                    condim=3,
                    contype=category,
                    conaffinity=collide,
                    friction=list(friction),
                    solref=list(reference),
                    solimp=list(contact.IMPEDANCE),
                    userdata=[collision.laser_retro or 0.0],
                    **arguments,
                    **pose_arguments(pose),
                )
                self.geoms[geom.name] = geom
                self.surfaces.append(
                    contact.BuiltSurface(
                        name=part_name(name, number),
                        body=body.name,
                        model=entry.name,
                        moves=moves,
                        rolls=axle is not None,
                        tread=tread,
                        bottom=bottom,
                        low=low,
                        floor_area=contact.floor_area(geom.type, geom.size),
                        friction=friction,
                        reference=reference,
                        surface=collision.surface,
                        origin=collision.origin,
                        direction=_direction(entry, link, collision),
                        slips=link.name in entry.slips,
                        travels=link.name in entry.tracks,
                    )
                )

    def _rounded(
        self, entry: ModelEntry, link: Link, collision: Collision, axle: Axle | None
    ) -> tuple[Shape, Pose]:
        """The shape and pose of a collision: a wheel is an ellipsoid."""
        if self._wide or "round-tyres" in self._without:
            return collision.shape, collision.pose
        shape, place = tyre(collision, axle)
        if isinstance(shape, Ellipsoid) and shape is not collision.shape:
            name = scoped(link.name, collision.name)
            self._note("round-tyres", entry, name, 2 * min(shape.radii), collision.origin)
        return shape, place

    def _tread(
        self, link: Link, collision: Collision, axle: Axle, built: tuple[Shape, Pose]
    ) -> tuple[Shape, Pose]:
        """The shape and pose in the model from which the tread is taken: as if it were round."""
        if not self._wide:
            return built
        shape, place = tyre(collision, axle)
        return shape, link.pose @ place

    def _set_inertial(
        self, entry: ModelEntry, body: Any, link: str, inertial: Inertial, *, moves: bool
    ) -> None:
        # The inertia of a body that does not move has no effect, but the engine checks it as well.
        raises = not moves or "minimum-inertia" not in self._without
        raised = set_inertial(body, inertial, raises=raises)
        if raised is not None and moves:
            self._note("minimum-inertia", entry, link, raised, inertial.origin)

    def _note(
        self, addition: Addition, entry: ModelEntry, element: str, value: float, origin: Origin
    ) -> None:
        self.added.append(
            Added(addition=addition, model=entry.name, element=element, value=value, origin=origin)
        )


def _is_upright(link: Link, axle: Axle) -> bool:
    return is_upright(rotate(link.pose.orientation, axle.axis))


def _add_tyre(entry: ModelEntry, wheel: Any, link: Link, axle: Axle) -> Any:
    """Adds the tyre that touches the ground in place of a wheel, and rotates and shifts with
    damping.

    The tyre has almost no mass; the inertia of both motions keeps the solver stable.
    """
    name = scoped(entry.name, link.name, TYRE)
    tyre = wheel.add_body(name=name)
    tyre.explicitinertial = True
    tyre.mass = TYRE_MASS
    tyre.ipos = list(axle.point)
    tyre.inertia = [TYRE_MASS] * 3
    inertia = _TYRE_SHARE * entry.description.mass
    radius = entry.slips[link.name]
    for what, kind, weight in (
        (TURN, mujoco.mjtJoint.mjJNT_HINGE, inertia * radius**2),
        (SHIFT, mujoco.mjtJoint.mjJNT_SLIDE, inertia),
    ):
        made = tyre.add_joint(
            name=scoped(name, what), type=kind, axis=list(axle.axis), pos=list(axle.point)
        )
        made.armature = weight
        # Set at run time; the engine requires a nonzero value here.
        made.damping = [1.0, 0, 0]
    return tyre


def _steers(link: Link, joint: Joint) -> bool:
    """Whether a joint turns what is below its child link about the vertical."""
    if joint.type not in ("revolute", "continuous"):
        return joint.type in ("ball", "universal", "planar", "floating")
    return is_upright(rotate((link.pose @ joint.pose).orientation, joint.axis.xyz))


def _direction(entry: ModelEntry, link: Link, collision: Collision) -> tuple[str, Vec3] | None:
    """The direction in which mu1 applies, with the body that defines its axes."""
    surface = collision.surface
    if surface.fdir1 is None:
        return None
    carrier = entry.description.link(surface.fdir1_frame or "")
    if carrier is not None:
        return scoped(entry.name, carrier.name), surface.fdir1
    return scoped(entry.name, link.name), rotate(collision.pose.orientation, surface.fdir1)
