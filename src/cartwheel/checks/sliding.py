"""How a base moves whose wheels slide on the ground.

The file is long because turning, dragging and braking follow from the same contacts.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from cartwheel.checks.resting import Surfaces, starting_poses
from cartwheel.checks.robot import Robot
from cartwheel.checks.wheels import (
    axle_of,
    lowest,
    wheel_axis,
    wheel_links,
    wheel_place,
    wheel_radius,
    wheel_tread,
)
from cartwheel.description.kinematics import center_of_mass
from cartwheel.description.model import Joint
from cartwheel.description.solids import Floats
from cartwheel.geometry import cross, rotate

_ROUNDS = 200
"""Rounds of reweighting; the turn rate then changes by less than 1 %."""
_SAME = 1e-12
"""Change of a velocity in a round, m/s and rad/s, below which the next rounds change nothing."""
_STILL = 1e-6
"""Sliding speed, m/s, below which a contact counts as not sliding."""
_PARALLEL = 0.95
"""Minimum cosine between parallel axles."""
_AHEAD = 0.02
"""Minimum distance between the axles of a caster and of the driven wheels, or of two axles of
driven wheels, m."""
_NEAR = 0.006
"""Maximum difference in height between parts that touch the ground, m."""
_ALONG = 0.1
"""Smallest component of a direction in which a coefficient limits the friction."""
_LOCKED = 0.02
"""Speed at which the ground must be able to turn a braked wheel, m/s, which slides otherwise."""
_UPRIGHT = 0.9
"""Smallest vertical component of the axis of a swivel."""
_UP = np.array([0.0, 0.0, 1.0])
_GRAVITY = 9.8
"""m/s²."""
_NOTICED = 0.05
"""Smallest effect of slip on the turn rate, relative to the commanded one."""
_Slips = Callable[[float, float], tuple[float, float]]


@dataclass(frozen=True, kw_only=True, slots=True)
class Contact:
    """Where a part of a base touches the ground."""

    x: float
    """m, across the axles."""
    y: float
    """m, along the axles."""
    rim: float = 0.0
    """Speed at which a motor turns the wheel, m/s along x."""
    friction: tuple[float, float] = (1.0, 1.0)
    """Coefficients along and across `direction`; 0 where it rolls freely or swivels."""
    direction: tuple[float, float] = (1.0, 0.0)
    """Unit vector."""
    slip: tuple[float, float] = (0.0, 0.0)
    """Sliding speed along and across `direction` at which the friction is the whole weight, m/s; 0
    for friction by Coulomb's law only."""


def base_motion(contacts: Sequence[Contact], center: tuple[float, float]) -> Floats:
    """Velocity of a base on which only the friction of its contacts acts, by Coulomb's law.

    The friction opposes the sliding velocity of each contact, so its forces and torque balance
    where the power that the contacts dissipate is least. This power is a sum of norms, which is
    minimised by repeatedly weighted least squares. The limit of the friction is an ellipse if its
    coefficients differ. With slip, the friction is at most proportional to the sliding velocity.

    Args:
        contacts: Where the base touches the ground.
        center: Centre of mass: x and y, m.

    Returns:
        Velocity along x and y in m/s, and turn rate in rad/s, shape (3,).
    """
    x, y, rim, c, s = np.array([(e.x, e.y, e.rim, *e.direction) for e in contacts]).T
    loads = _loads(x, y, center)
    # Sliding velocities along, then across the directions, as rows @ motion - driven.
    along, across = np.stack([c, s, s * x - c * y]), np.stack([-s, c, c * x + s * y])
    rows: Floats = np.hstack([along, across]).T
    driven = np.hstack([c * rim, -s * rim])
    grips: Floats = (loads * np.array([each.friction for each in contacts]).T).ravel()
    most = 1.0 / np.maximum(np.array([each.slip for each in contacts]).T.ravel(), _STILL**3)
    least = (_STILL * np.maximum(grips.reshape(2, -1).max(axis=0), _STILL)) ** 2
    squares = grips**2
    equations: Floats = np.column_stack([rows, driven])
    motion: Floats = np.zeros(3)
    for _ in range(_ROUNDS):
        slides: Floats = (grips * (rows @ motion - driven)).reshape(2, -1)
        weights = np.tile(1.0 / np.sqrt((slides**2).sum(axis=0) + least), 2)
        weighted: Floats = rows * np.minimum(squares * weights, most)[:, None]
        sums: Floats = weighted.T @ equations
        before = motion
        motion = np.asarray(np.linalg.lstsq(sums[:, :3], sums[:, 3], rcond=None)[0], np.float64)
        if np.abs(motion - before).max() < _SAME:
            break
    return motion


def _loads(x: Floats, y: Floats, center: tuple[float, float]) -> Floats:
    """Shares of the weight: the plane over all contacts that supports the centre of mass."""
    places = np.stack([np.ones_like(x), x, y], 1)
    plane = np.linalg.lstsq(places.T @ places, np.array([1.0, *center]), rcond=None)[0]
    return np.asarray(np.maximum(places @ plane, 0.0))


def turn_ratio(
    robot: Robot,
    left: Sequence[Joint],
    right: Sequence[Joint],
    axle: Floats,
    rim: float,
    *,
    dragged: bool = False,
    outer: bool = False,
    slips: _Slips | None = None,
) -> float | None:
    """Turn rate of a base whose left and right wheels are driven for a turn of 1 rad/s.

    Args:
        robot: The robot.
        left: Driven joints of the left wheels.
        right: Driven joints of the right wheels.
        axle: Direction of the axles in the model frame, a unit vector.
        rim: Speed of the rims, m/s.
        dragged: Whether other parts of the base slide, although no wheel has to.
        outer: Whether only the driven wheels of the first and last axle carry the base. They slide
            most, so it turns slowest. On uneven ground or bogies, this depends on details.
        slips: Returns the slip along and across the direction of a part, from ``<slip1>`` and
            ``<slip2>``, if its friction directions do not turn with the base. None: no slip.

    Returns:
        None if nothing has to slide in a turn, or if the contacts are unknown.
    """
    center = center_of_mass(robot.description, starting_poses(robot))
    driven = [*left, *right]
    wheels = {name for joint in driven for name in wheel_links(robot, joint)}
    heights = [lowest(robot, *wheel_links(robot, joint)) for joint in driven]
    bottoms = [height for height in heights if height is not None]
    # A wheel without its collision may be one whose mesh is missing.
    if not bottoms or len(bottoms) < len(heights) or not robot.placed.issuperset(wheels):
        return None
    if center is None:
        center = np.mean([wheel_place(robot, joint).position for joint in driven], axis=0)
    contacts = [
        Contact(
            x=_ahead(axle, wheel_place(robot, joint).position),
            y=float(axle @ wheel_tread(robot, joint)),
            rim=rim if joint in left else -rim,
            friction=_friction(robot, joint.child, axle),
            direction=_direction(robot, joint.child, axle),
            slip=_slip(robot, wheel_links(robot, joint), axle, slips),
        )
        for joint in driven
    ]
    if outer:
        ends = min(each.x for each in contacts), max(each.x for each in contacts)
        contacts = [each for each in contacts if min(abs(each.x - x) for x in ends) < _AHEAD]
    others = list(_others(robot, driven, wheels, axle, min(bottoms), slips=slips))
    skids = any(each.friction[0] < each.friction[1] or dragged for each in others)
    spread = {round(each.x, 3) for each in contacts}
    # What another plugin drives is unknown here.
    elsewhere = robot.driven - robot.idle - {joint.name for joint in driven}
    also = {
        name
        for each in elsewhere
        if each in robot.joints
        for name in wheel_links(robot, robot.joints[each])
    }
    if also & _touching(robot, min(bottoms)) or (len(spread) < 2 and not skids):
        return None
    motion = base_motion([*contacts, *others], (_ahead(axle, center), float(axle @ center)))
    return abs(float(motion[2]))


def turn_with_slip(
    robot: Robot,
    left: Sequence[Joint],
    right: Sequence[Joint],
    axle: Floats,
    rim: float,
    *,
    dragged: bool = False,
) -> float | None:
    """The turn rate as by `turn_ratio`, with the ``<slip1>`` and ``<slip2>`` of all collisions.

    Friction directions that do not turn with the base may have any direction; the one is used with
    which slip has the largest effect.

    Returns:
        None without slip, and if its effect is small.
    """
    surfaces = (part.surface for link in robot.description.links for part in link.collisions)
    if not any(each.slip1 or each.slip2 for each in surfaces):
        return None
    plain = turn_ratio(robot, left, right, axle, rim, dragged=dragged)
    if plain is None:
        return None
    orders: tuple[_Slips, ...] = (
        lambda first, second: (first, second),
        lambda first, second: (second, first),
        lambda first, second: (max(first, second),) * 2,
    )
    found = [turn_ratio(robot, left, right, axle, rim, dragged=dragged, slips=o) for o in orders]
    known = [each for each in found if each is not None]
    farthest = max(known, key=lambda each: abs(each - plain), default=plain)
    return farthest if abs(farthest - plain) > _NOTICED else None


@dataclass(frozen=True, kw_only=True, slots=True)
class Dragged:
    """How a base turns that drags parts over the ground, relative to its wheels."""

    turn: float
    """Turn rate."""
    slips: bool
    """Whether it is different with the ``<slip1>`` and ``<slip2>`` of these parts."""


def dragged_turn(robot: Robot) -> Dragged | None:
    """How a base turns that drags parts over the ground; None if it is unknown."""
    for left, right in robot.sides:
        if not left or not right or not {*left, *right} <= robot.joints.keys():
            continue
        axle = axle_of(robot, left, right, beside=True)
        ours, theirs = ([robot.joints[name] for name in side] for side in (left, right))
        if not {each.child for each in (*ours, *theirs)} <= robot.placed:
            continue
        first, second = (
            np.mean([wheel_tread(robot, each) for each in side], axis=0) for side in (ours, theirs)
        )
        track = abs(float((first - second) @ axle))
        if track > 0:
            turn = turn_ratio(robot, ours, theirs, axle, track / 2, dragged=True)
            slip = turn_with_slip(robot, ours, theirs, axle, track / 2, dragged=True)
            return None if turn is None else Dragged(turn=turn, slips=slip is not None)
    return None


@dataclass(frozen=True, kw_only=True, slots=True)
class Braking:
    """How wheels without motors brake a base."""

    joints: tuple[Joint, ...]
    """Those with damping or friction."""
    traction: float
    """Force with which the driven wheels push at most, N."""
    speed: float
    """Speed at which the wheels brake with this force, m/s; 0 if their friction exceeds it."""


def braking(robot: Robot, driven: Sequence[Joint]) -> Braking | None:
    """How the damping and friction of wheels that no motor turns brake a base.

    Args:
        robot: The robot.
        driven: Joints of the driven wheels.

    Returns:
        None if no such wheel has damping or friction, or if the contacts are unknown.
    """
    wheels = {name for joint in driven for name in wheel_links(robot, joint)}
    center = center_of_mass(robot.description, starting_poses(robot))
    bottoms = [lowest(robot, *wheel_links(robot, joint)) for joint in driven]
    known = [each for each in bottoms if each is not None]
    if not driven or len(known) < len(bottoms) or not robot.placed.issuperset(wheels):
        return None
    others = [
        joint
        for name in _touching(robot, min(known)) - wheels
        if (joint := robot.inbound.get(name)) is not None
        and rolls_only_forward(robot, joint, driven)
        and wheel_radius(robot, joint)
    ]
    passive = [each for each in others if each.name not in robot.driven - robot.idle]
    braked = tuple(each for each in passive if each.axis.damping or each.axis.friction)
    if center is None or not braked:
        return None
    axle = wheel_axis(robot, driven[0])
    places = [wheel_tread(robot, joint) for joint in (*driven, *others)]
    x = np.array([_ahead(axle, each) for each in places])
    y = np.array([float(axle @ each) for each in places])
    loads = _loads(x, y, (_ahead(axle, center), float(axle @ center)))[: len(driven)]
    weight = robot.description.mass * _GRAVITY
    grips = [_grip(robot, joint.child, axle) for joint in driven]
    traction = weight * sum(load * mu for load, mu in zip(loads, grips, strict=True))
    radii = [wheel_radius(robot, joint) or 1.0 for joint in braked]
    least = sum(each.axis.friction / r for each, r in zip(braked, radii, strict=True))
    rate = sum(each.axis.damping / r**2 for each, r in zip(braked, radii, strict=True))
    spare = traction - least
    speed = 0.0 if spare <= 0 else float(spare / rate) if rate else float("inf")
    return Braking(
        joints=tuple(sorted(braked, key=lambda each: each.name)),
        traction=float(traction),
        speed=speed,
    )


def locked_swivels(robot: Robot, driven: Sequence[Joint]) -> tuple[Joint, ...]:
    """The joints of wheels on swivels whose damping and friction the ground cannot overcome.

    Such a wheel points in the direction in which the base moves, and slides instead of rolling.

    Args:
        robot: The robot.
        driven: Joints of the driven wheels.
    """
    wheels = {name for joint in driven for name in wheel_links(robot, joint)}
    bottoms = [lowest(robot, *wheel_links(robot, joint)) for joint in driven]
    known = [each for each in bottoms if each is not None]
    center = center_of_mass(robot.description, starting_poses(robot))
    if not known or center is None or not robot.placed.issuperset(wheels):
        return ()
    touching = _touching(robot, min(known)) - wheels
    swivels = [
        joint
        for joint in robot.description.joints
        if joint.child in touching and _is_on_swivel(robot, joint, driven[0])
    ]
    if not any(joint.axis.damping or joint.axis.friction for joint in swivels):
        return ()
    axle = wheel_axis(robot, driven[0])
    places = [wheel_tread(robot, joint) for joint in (*driven, *swivels)]
    x = np.array([_ahead(axle, each) for each in places])
    y = np.array([float(axle @ each) for each in places])
    loads = _loads(x, y, (_ahead(axle, center), float(axle @ center)))[len(driven) :]
    found = []
    for joint, load in zip(swivels, loads, strict=True):
        radius, axis = wheel_radius(robot, joint) or 1.0, joint.axis
        grip = max(_coefficients(robot, joint.child)) * load * robot.description.mass * _GRAVITY
        # The force with which the ground must turn the wheel at this speed.
        if axis.friction / radius + axis.damping * _LOCKED / radius**2 > grip:
            found.append(joint)
    return tuple(found)


def _is_on_swivel(robot: Robot, joint: Joint, driven: Joint) -> bool:
    """Whether a joint without a motor holds a wheel below a swivel of the base without a motor."""
    swivel = robot.inbound.get(robot.rigid_root(joint.parent))
    if swivel is None or not (joint.turns and swivel.turns):
        return False
    return (
        {joint.name, swivel.name}.isdisjoint(robot.driven - robot.idle)
        and robot.rigid_root(swivel.parent) == robot.rigid_root(driven.parent)
        and abs(wheel_axis(robot, swivel)[2]) > _UPRIGHT
        and abs(wheel_axis(robot, joint)[2]) < 1.0 - _UPRIGHT
        and wheel_radius(robot, joint) is not None
    )


def is_held(robot: Robot, driven: Sequence[Joint]) -> bool:
    """Whether the friction of parts that slide exceeds the force of all motors together.

    This is unknown, and false, unless all driven joints have an effort limit.
    """
    wheels = {name for joint in driven for name in wheel_links(robot, joint)}
    if not driven or not robot.placed.issuperset(wheels):
        return False
    force, bottoms = 0.0, []
    for joint in driven:
        limit, radius = joint.axis.effort, wheel_radius(robot, joint)
        bottom = lowest(robot, *wheel_links(robot, joint))
        if not limit or not radius or bottom is None:
            return False
        force += limit / radius
        bottoms.append(bottom)
    center = center_of_mass(robot.description, starting_poses(robot))
    if center is None:
        return False
    axle = wheel_axis(robot, driven[0])
    treads = [wheel_tread(robot, joint) for joint in driven]
    contacts = [Contact(x=_ahead(axle, tread), y=float(axle @ tread)) for tread in treads]
    others = list(_others(robot, driven, wheels, axle, min(bottoms)))
    x, y = np.array([(each.x, each.y) for each in (*contacts, *others)]).T
    loads = _loads(x, y, (_ahead(axle, center), float(axle @ center)))[len(contacts) :]
    # On the coefficient of the ground, which is 1.
    drag = sum(load * each.friction[0] for load, each in zip(loads, others, strict=True))
    return bool(drag * robot.description.mass * _GRAVITY > force)


def _others(
    robot: Robot,
    driven: Sequence[Joint],
    wheels: set[str],
    axle: Floats,
    bottom: float,
    *,
    slips: _Slips | None = None,
) -> Iterator[Contact]:
    """The other parts that touch the ground. `slips` is as for `turn_ratio`."""
    base = robot.rigid_root(driven[0].parent)
    touching = _touching(robot, bottom)
    locked = {joint.child for joint in locked_swivels(robot, driven)}
    for link in robot.description.links:
        if link.name in wheels or link.name not in touching:
            continue
        holder = robot.inbound.get(link.name)
        rolls = holder is not None and rolls_only_forward(robot, holder, driven)
        fixed = robot.rigid_root(link.name) == base or link.name in locked
        place = Surfaces(robot, [link.name]).lowest(_UP)
        if place is None:
            continue
        mu = max(_coefficients(robot, link.name))
        if rolls and holder is not None:
            place = np.array(wheel_place(robot, holder).position)
            if _is_along_axle(robot, link.name, axle):
                # It slides along its axle.
                mu = _coefficients(robot, link.name)[0]
        yield Contact(
            x=_ahead(axle, place),
            y=float(axle @ place),
            friction=(mu if fixed else 0.0, mu if rolls or fixed else 0.0),
            slip=_slip(robot, [link.name], axle, slips),
        )


def _touching(robot: Robot, bottom: float) -> set[str]:
    heights = {link.name: lowest(robot, link.name) for link in robot.description.links}
    return {name for name, z in heights.items() if z is not None and abs(z - bottom) < _NEAR}


def rolls_only_forward(robot: Robot, holder: Joint, driven: Sequence[Joint]) -> bool:
    """Whether a wheel's axle is parallel to the driven ones, but not above them or on a swivel."""
    if not holder.turns:
        return False
    axis = wheel_axis(robot, holder)
    for each in driven:
        same_body = robot.rigid_root(each.parent) == robot.rigid_root(holder.parent)
        axle = wheel_axis(robot, each)
        between = np.subtract(
            wheel_place(robot, holder).position, wheel_place(robot, each).position
        )
        ahead = cross(axle, between)[2]
        if same_body and abs(np.dot(axis, axle)) > _PARALLEL and abs(ahead) > _AHEAD:
            return True
    return False


def _ahead(axle: Floats, place: Sequence[float] | Floats) -> float:
    return float(cross(axle, place)[2])


def _friction(robot: Robot, link: str, axle: Floats) -> tuple[float, float]:
    """Coefficients along and across the direction of a link's first collision, at most 1."""
    first, second = _coefficients(robot, link)
    collisions = robot.links[link].collisions
    turns = collisions and collisions[0].surface.fdir1_frame is None
    if turns and not _is_along_axle(robot, link, axle):
        # The axes turn with the wheel, or are those of the world.
        first = second = max(first, second)
    return first, second


def _slip(
    robot: Robot, links: Iterable[str], axle: Floats, slips: _Slips | None
) -> tuple[float, float]:
    """Slip along and across the direction of the first collision of links; see `Contact.slip`."""
    found = ((name, part.surface) for name in links for part in robot.links[name].collisions)
    link, surface = next(found, ("", None))
    if slips is None or surface is None:
        return 0.0, 0.0
    weight = _GRAVITY * robot.description.mass
    first, second = (max(each or 0.0, 0.0) for each in (surface.slip1, surface.slip2))
    if surface.fdir1_frame is None and not _is_along_axle(robot, link, axle):
        first, second = slips(first, second)
    return first * weight, second * weight


def _is_along_axle(robot: Robot, link: str, axle: Floats) -> bool:
    """Whether the first friction direction of a wheel is that of its axle, which does not turn."""
    for collision in robot.links[link].collisions[:1]:
        fdir = collision.surface.fdir1
        if fdir is not None and collision.surface.fdir1_frame is None:
            pose = robot.links[link].pose @ collision.pose
            along = abs(float(axle @ np.array(rotate(pose.orientation, fdir))))
            return along > _PARALLEL * float(np.linalg.norm(fdir))
    return False


def _coefficients(robot: Robot, link: str) -> tuple[float, float]:
    """Both coefficients of a link's first collision, at most 1."""
    for collision in robot.links[link].collisions[:1]:
        surface = collision.surface
        first = 1.0 if surface.mu1 is None else surface.mu1
        second = first if surface.mu2 is None else surface.mu2
        return min(first, 1.0), min(second, 1.0)
    return 1.0, 1.0


def _grip(robot: Robot, link: str, axle: Floats) -> float:
    """Coefficient in the direction in which a wheel rolls, at most 1."""
    coefficients = _coefficients(robot, link)
    surface = next((each.surface for each in robot.links[link].collisions), None)
    if surface is None or surface.fdir1 is None:
        # The coefficients are those along the axes of the world.
        return min(coefficients)
    parts = _direction(robot, link, axle)
    if surface.fdir1_frame is None:
        # The direction turns with the wheel, and is that of its axle or of its rolling.
        pose = robot.links[link].pose @ robot.links[link].collisions[0].pose
        along = abs(float(axle @ np.array(rotate(pose.orientation, surface.fdir1))))
        parts = (0.0, 1.0) if along > np.linalg.norm(surface.fdir1) / 2 else (1.0, 0.0)
    pairs = zip(coefficients, parts, strict=True)
    return min(1.0, *(mu / abs(part) for mu, part in pairs if abs(part) > _ALONG))


def _direction(robot: Robot, link: str, axle: Floats) -> tuple[float, float]:
    """Direction of a link's first friction coefficient, if it is fixed in the base or the axle."""
    for collision in robot.links[link].collisions[:1]:
        fdir, frame = collision.surface.fdir1, collision.surface.fdir1_frame
        if fdir is not None and frame in robot.placed:
            turned = np.array(rotate(robot.links[frame].pose.orientation, fdir))
            x, y = _ahead(axle, turned), float(axle @ turned)
            length = float(np.hypot(x, y))
            if length > 0:
                return x / length, y / length
    return (0.0, 1.0) if _is_along_axle(robot, link, axle) else (1.0, 0.0)
