"""Friction of wheels and casters."""

from __future__ import annotations

from collections.abc import Iterator

from cartwheel.checks import nodes
from cartwheel.checks.robot import Robot
from cartwheel.checks.rule import rule
from cartwheel.checks.sliding import (
    Dragged,
    dragged_turn,
    is_held,
    locked_swivels,
    rolls_only_forward,
)
from cartwheel.checks.subject import Subject
from cartwheel.checks.wheels import (
    ROUND,
    lowest,
    wheel_axis,
    wheel_joints,
    wheel_links,
    wheel_widths,
)
from cartwheel.codes import robot as robot_codes
from cartwheel.description.elements.node import Node
from cartwheel.description.model import Collision, Joint, Link, Sphere
from cartwheel.description.solids import solid_of
from cartwheel.dialects.catalogue import plugin_named
from cartwheel.dialects.classic.drives.planar_move import PlanarMove
from cartwheel.dialects.makers.force_based_move import ForceBasedMove
from cartwheel.dialects.makers.planar_force_move import PlanarForceMove
from cartwheel.errors import Diagnostic, Value

SLIPPERY = 0.01
_LEVEL = 0.006
"""m; maximum difference of the heights of parts that touch the same ground."""
_PLANAR = (PlanarMove, PlanarForceMove, ForceBasedMove)
"""Plugins that move a robot over the ground without wheels."""
_IN_SDF = "Set <mu> and <mu2> in <surface><friction><ode> of this collision to 0."
_STUCK = ", which is more than the motors can overcome"
_UPRIGHT = 0.95
"""Minimum vertical component of the axis of a part that turns about the vertical."""
_LOW = 0.3
"""Friction coefficient of a caster that hardly brakes a robot."""


@rule(robot_codes.WHEEL_FRICTIONLESS)
def wheel_frictionless(subject: Subject) -> Iterator[Diagnostic]:
    for robot in subject.robots:
        for joint in wheel_joints(robot):
            link = robot.links[joint.child]
            for collision in link.collisions[:1]:
                mu = [m for m in (collision.surface.mu1, collision.surface.mu2) if m is not None]
                if not mu or max(mu) >= SLIPPERY:
                    continue
                node = _surface_node(robot, link.name, "mu1")
                yield robot_codes.WHEEL_FRICTIONLESS.diagnostic(
                    message=f'the friction coefficient of the driven wheel "{link.name}" is '
                    f"{max(mu):g}, so the wheel slips",
                    values={"link": link.name, "friction": max(mu)},
                    origin=node.origin if node is not None else collision.origin,
                    instead="<mu1>1.0</mu1>" if node is not None else "",
                    place="element" if node is not None else "",
                    hint="Use the same value for <mu2>.",
                )


@rule(robot_codes.CASTER_FRICTION)
def caster_friction(subject: Subject) -> Iterator[Diagnostic]:
    for robot in subject.robots:
        driven = wheel_joints(robot)
        wheels = {name for joint in driven for name in wheel_links(robot, joint)}
        if not wheels or _names_nothing(subject):
            continue
        weak, turn = is_held(robot, driven), dragged_turn(robot)
        for link in robot.description.links:
            holder = robot.inbound.get(link.name)
            if "caster" not in link.name.lower() or holder is None:
                continue
            rolls = rolls_only_forward(robot, holder, driven)
            pivots = holder.turns and abs(wheel_axis(robot, holder)[2]) > _UPRIGHT
            if holder.type != "fixed" and not rolls and not pivots:
                continue
            if not _touches_ground(robot, link, wheels):
                continue
            lacks = "swivel, so it slides when the robot turns" if rolls else "roll"
            if pivots:
                lacks += ", because it turns only about the vertical"
            yield from _braking(
                subject,
                link,
                link.collisions[0],
                f'the caster "{link.name}" cannot {lacks}',
                turn=turn,
                holds=weak and not rolls,
                instead=f'<gazebo reference="{link.name}"><mu1>0.0</mu1><mu2>0.0</mu2></gazebo>',
                hint="Add these tags to the robot, or change the existing values.",
            )
        for joint in locked_swivels(robot, driven):
            mu = robot.links[joint.child].collisions[0].surface.mu1
            brakes = " and ".join(
                f"{name} of {value:g}"
                for name, value in (
                    ("damping", joint.axis.damping),
                    ("friction", joint.axis.friction),
                )
                if value
            )
            yield robot_codes.CASTER_FRICTION.diagnostic(
                message=f'the wheel "{joint.child}" on a swivel cannot roll, because the ground '
                f'cannot overcome the {brakes} of joint "{joint.name}", so it slides with the '
                f"friction coefficient {_shown(mu)}",
                severity="warning",
                values={
                    "link": joint.child,
                    "friction": mu,
                    "holds": False,
                    **_turn_values(turn),
                },
                origin=joint.origin,
                hint="Decrease the damping and friction of this joint.",
            )
        for link, collision in _fixed_balls(robot, wheels):
            alone = link.name != robot.rigid_root(link.name) and len(link.collisions) == 1
            own = (
                "Set"
                if alone
                else "Move the sphere to a link of its own, on a fixed joint, and set"
            )
            yield from _braking(
                subject,
                link,
                collision,
                f'the sphere of link "{link.name}" is a caster that cannot roll',
                turn=turn,
                holds=weak,
                hint=f"{own} <mu1> and <mu2> of this link to 0.",
            )


def _braking(
    subject: Subject,
    link: Link,
    collision: Collision,
    problem: str,
    *,
    turn: Dragged | None,
    holds: bool,
    instead: str = "",
    hint: str,
) -> Iterator[Diagnostic]:
    """The diagnostic for a part that brakes the robot.

    `turn` is how the robot turns with all such parts. `instead` and `hint` are those for URDF.
    """
    mu = collision.surface.mu1
    if not _brakes(mu):
        return
    in_sdf = subject.in_sdf(collision.origin)
    yield robot_codes.CASTER_FRICTION.diagnostic(
        message=f"{problem}, and its friction coefficient is {_shown(mu)}{_STUCK if holds else ''}",
        severity="warning" if holds else None,
        values={"link": link.name, "friction": mu, "holds": holds, **_turn_values(turn)},
        origin=collision.origin,
        instead="" if in_sdf else instead,
        hint=_IN_SDF if in_sdf else hint,
    )


def _turn_values(turn: Dragged | None) -> dict[str, Value]:
    """How a base turns that drags parts, as values of a diagnostic."""
    values: dict[str, Value] = {"ratio": None if turn is None else turn.turn}
    return values | ({"slip": True} if turn is not None and turn.slips else {})


@rule(robot_codes.PLANAR_FRICTION)
def planar_friction(subject: Subject) -> Iterator[Diagnostic]:
    for robot in subject.robots:
        movers = [tag for tag in robot.description.plugins if plugin_named(tag.filename) in _PLANAR]
        heights = {
            link.name: height
            for link in robot.description.links
            if link.collisions and (height := lowest(robot, link.name)) is not None
        }
        if not movers or not heights or not subject.is_urdf or _names_nothing(subject):
            continue
        ground = min(heights.values())
        for name, height in heights.items():
            holder = robot.inbound.get(robot.rigid_root(name))
            if height - ground > _LEVEL or (holder is not None and _rolls(robot, holder)):
                continue
            mu = robot.links[name].collisions[0].surface.mu1
            if not _brakes(mu):
                continue
            yield robot_codes.PLANAR_FRICTION.diagnostic(
                message=f'link "{name}" slides on the ground when "{movers[0].filename}" moves the '
                f"robot, and its friction coefficient is {_shown(mu)}",
                values={"link": name, "friction": mu},
                origin=robot.links[name].collisions[0].origin,
                instead=f'<gazebo reference="{name}"><mu1>0.0</mu1><mu2>0.0</mu2></gazebo>',
                hint="Add these tags to the robot, or change the existing values.",
            )


def _fixed_balls(robot: Robot, wheels: set[str]) -> Iterator[tuple[Link, Collision]]:
    """Spheres of links that are not casters by name, on which a robot stands beside its wheels."""
    ground = _ground(robot, wheels)
    trunks = {robot.rigid_root(robot.joints[joint.name].parent) for joint in wheel_joints(robot)}
    for link in robot.description.links:
        if "caster" in link.name.lower() or robot.rigid_root(link.name) not in trunks:
            continue
        for collision in link.collisions:
            solid = solid_of(collision, link.name) if isinstance(collision.shape, Sphere) else None
            if solid is None or ground is None or link.name not in robot.placed:
                continue
            height = float(solid.placed(robot.links[link.name].pose)[:, 2].min())
            if abs(height - ground) < _LEVEL:
                yield link, collision


def _names_nothing(subject: Subject) -> bool:
    """Whether a <gazebo> with friction has no reference, so that its link is unknown."""
    known = {nodes.name_of(node) for node in subject.root.children if node.tag in ("link", "joint")}
    return any(
        nodes.child(node, "mu1") is not None and nodes.text_of(node, "reference") not in known
        for node in nodes.children(subject.root, "gazebo")
        if nodes.text_of(node, "reference")
    )


def _surface_node(robot: Robot, link: str, tag: str) -> Node | None:
    found = None
    for node in nodes.children(robot.root, "gazebo"):
        if nodes.text_of(node, "reference") == link:
            found = nodes.child(node, tag) or found
    return found


def _touches_ground(robot: Robot, link: Link, wheels: set[str]) -> bool:
    height, ground = lowest(robot, link.name), _ground(robot, wheels)
    return height is not None and ground is not None and abs(height - ground) < _LEVEL


def _ground(robot: Robot, wheels: set[str]) -> float | None:
    """The height of the ground below the wheels, m; None if no wheel has a shape."""
    bottoms = (lowest(robot, name) for name in wheels)
    return min((each for each in bottoms if each is not None), default=None)


def _rolls(robot: Robot, holder: Joint) -> bool:
    """Whether a joint holds a round wheel."""
    if not holder.turns:
        return False
    widths = wheel_widths(robot, holder, robot.collisions)
    return widths is None or bool(widths.min() >= ROUND * widths.max())


def _brakes(mu: float | None) -> bool:
    """Whether a part with this friction coefficient brakes a robot that it slides under."""
    return mu is None or mu > _LOW


def _shown(mu: float | None) -> str:
    return "1, the default" if mu is None else f"{mu:g}"
