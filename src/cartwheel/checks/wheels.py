"""Places and sizes of driven wheels."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence

import numpy as np

from cartwheel.checks import plugin_tags
from cartwheel.checks.robot import Drive, Robot
from cartwheel.checks.subject import Subject
from cartwheel.description.model import Joint
from cartwheel.description.solids import Floats, Solid, bounds
from cartwheel.dialects.catalogue import plugin_named
from cartwheel.dialects.gz.ackermann import GzAckermannDrive
from cartwheel.dialects.gz.diff_drive import GzDiffDrive
from cartwheel.dialects.gz.mecanum import GzMecanumDrive
from cartwheel.dialects.tag_roles import WHEEL_ROLES
from cartwheel.geometry import Pose, cross, rotate

_DIRECTIONS = 32
_LEVEL = np.array([1.0, 1.0, 0.0])
_ALONG = 0.9
"""Minimum cosine between two directions that count as parallel."""
_TURNED = 0.1
"""Maximum ratio of y to x between two wheels that are beside each other along x."""
_BESIDE = 0.1
"""Maximum distance of a wheel from the axle through another one, relative to the track."""
ROUND = 0.7
"""Minimum ratio of the smallest to the largest width of a round wheel."""
_WORN = 0.002
"""Part of a wheel's radius by which points of its tread may differ."""
_FURTHER = 0.75
"""Part of a wheel's offset from its axis by which it reaches further from the axis than a wheel
without the offset, at least: shapes have corners."""
_SAME = 1e-6
"""Distance between two joints at the same place, m."""
CAMBER = 0.5
"""Minimum cosine between a wheel axis and the axle."""
_LOOKS = 0.5
"""Minimum component along x, or along -x, of the direction of a camera that shows the front."""
_GZ_DRIVES = (GzDiffDrive, GzMecanumDrive, GzAckermannDrive)
"""Plugins whose wheels respect the velocity limits of their joints."""


def wheel_radius(robot: Robot, joint: Joint) -> float | None:
    """Half the width of a wheel's collision perpendicular to its axis, m; else of its visual.

    Links fixed to the wheel are included: the tyre and the hub may be separate links.
    """
    if joint.child not in robot.links:
        return None
    for kind in (robot.collisions, robot.visuals):
        widths = wheel_widths(robot, joint, kind)
        if widths is not None:
            return float(widths.max()) / 2
    return None


def wheel_middle(robot: Robot, joint: Joint) -> tuple[float, float, float]:
    """Centre of a wheel's width in the model frame, m, which may be offset from the joint."""
    place, axis = wheel_place(robot, joint), np.array(joint.axis.xyz)
    for kind in (robot.collisions, robot.visuals):
        cloud = _cloud(robot, joint, kind)
        if cloud is not None:
            along = cloud @ axis
            x, y, z = (axis * (along.min() + along.max()) / 2 / (axis @ axis or 1.0)).tolist()
            return (place @ Pose((x, y, z))).position
    return place.position


def wheel_tread(robot: Robot, joint: Joint) -> tuple[float, float, float]:
    """Middle of the part of a wheel that touches the ground, on its axis, in the model frame, m.

    A tapered wheel rolls on its widest part. Without a collision, or if the wheel is so large that
    its radius cannot be computed, it is the middle of the wheel.
    """
    cloud = _cloud(robot, joint, robot.collisions)
    if cloud is None:
        return wheel_middle(robot, joint)
    axis = np.array(joint.axis.xyz) / (np.linalg.norm(joint.axis.xyz) or 1.0)
    along = cloud @ axis
    with np.errstate(over="ignore", invalid="ignore"):
        radii = np.linalg.norm(cloud - np.outer(along, axis), axis=1)
    if not np.isfinite(radii).all():
        return wheel_middle(robot, joint)
    tread = along[radii >= radii.max() - _WORN * radii.max()]
    x, y, z = (axis * (tread.min() + tread.max()) / 2).tolist()
    return (wheel_place(robot, joint) @ Pose((x, y, z))).position


def wheel_widths(robot: Robot, joint: Joint, kind: Mapping[str, list[Solid]]) -> Floats | None:
    """Widths of a wheel in directions around its axis, m; None without geometry of this kind."""

    def compute() -> Floats | None:
        cloud = _cloud(robot, joint, kind)
        if cloud is None:
            return None
        # Half the width, not the radius: the wheel may be a millimetre off its axis.
        sideways = _across(np.array(joint.axis.xyz))
        return np.asarray(np.ptp(cloud @ sideways.T, axis=0))

    return robot.once(f"widths of {_name(robot, kind)}", joint, compute)


def wheel_offset(robot: Robot, joint: Joint) -> float:
    """Distance of the middle of a round wheel's collisions from its axis, m; 0 without any.

    It is 0 if the wheel does not reach further from its axis than from its middle, such as a ring
    of five rollers around the axis.
    """

    def compute() -> float:
        cloud = _cloud(robot, joint, robot.collisions)
        if cloud is None:
            return 0.0
        along = cloud @ _across(np.array(joint.axis.xyz)).T
        offset = float(np.abs(along.max(axis=0) + along.min(axis=0)).max()) / 2
        radius = float(np.ptp(along, axis=0).max()) / 2
        reach = float(np.abs(along).max())
        return offset if reach > radius + _FURTHER * offset else 0.0

    return robot.once("offset of collisions", joint, compute)


def _cloud(robot: Robot, joint: Joint, kind: Mapping[str, list[Solid]]) -> Floats | None:
    """Wheel vertices in the joint frame, shape (n, 3), m; None without geometry of this kind."""

    def compute() -> Floats | None:
        here = wheel_place(robot, joint).inverse()
        clouds = [
            solid.placed(here @ robot.links[name].pose)
            for name in wheel_links(robot, joint)
            for solid in kind[name]
        ]
        return np.concatenate(clouds) if clouds else None

    return robot.once(f"points of {_name(robot, kind)}", joint, compute)


def _name(robot: Robot, kind: Mapping[str, list[Solid]]) -> str:
    return "collisions" if kind is robot.collisions else "visuals"


def _across(axis: Floats) -> Floats:
    """Unit vectors perpendicular to an axis, shape (n, 3)."""
    first = cross(axis, np.eye(3)[np.argmin(np.abs(axis))])
    first /= np.linalg.norm(first)
    angles = np.linspace(0.0, np.pi, _DIRECTIONS, endpoint=False)[:, None]
    return np.asarray(np.cos(angles) * first + np.sin(angles) * cross(axis, first))


def is_across(robot: Robot, joint: Joint) -> bool:
    """Whether a wheel's axis points sideways: along y, or toward another wheel."""
    axis = wheel_axis(robot, joint)
    if abs(axis[1]) >= CAMBER:
        return True
    here = np.array(wheel_place(robot, joint).position)
    gaps = [
        np.array(wheel_place(robot, each).position) - here
        for each in _rolling(robot)
        if each is not joint
    ]
    return any(abs(gap @ axis) > _ALONG * np.linalg.norm(gap) > 0 for gap in gaps)


def _rolling(robot: Robot) -> list[Joint]:
    """All joints that turn without limits."""
    joints = robot.joints.values()
    return [each for each in joints if each.turns and each.child in robot.placed]


def passive_axle(robot: Robot, steering: Sequence[str]) -> tuple[str, ...]:
    """Joints of the wheels beside each other that a tricycle does not steer.

    They are mounted on the body. Empty if there are none, or if several axles are possible.
    """
    found = unsteered_wheels(robot, steering)
    places = np.array([wheel_place(robot, joint).position for joint in found])
    names = tuple(joint.name for joint in found)
    if len(names) < 2:
        return ()
    axle = wheel_axis(robot, found[0])
    gaps = places - places[0]
    off = np.linalg.norm(gaps - np.outer(gaps @ axle, axle), axis=1)
    return names if float(off.max()) <= _BESIDE * float(np.ptp(gaps @ axle)) else ()


def unsteered_wheels(robot: Robot, steering: Sequence[str]) -> list[Joint]:
    """Joints of the wheels on the body, apart from those of steering joints."""
    return [
        joint
        for joint in _rolling(robot)
        if joint.name not in steering
        and robot.rigid_root(joint.parent) == robot.rigid_root(robot.description.canonical_link)
        and is_across(robot, joint)
        and wheel_radius(robot, joint) is not None
    ]


def wheel_axis(robot: Robot, joint: Joint) -> Floats:
    """Axis of a wheel in the model frame, a unit vector of shape (3,)."""
    axis = np.array(rotate(wheel_place(robot, joint).orientation, joint.axis.xyz))
    return np.asarray(axis / (np.linalg.norm(axis) or 1.0))


def axle_of(robot: Robot, first: Sequence[str], second: Sequence[str], *, beside: bool) -> Floats:
    """Direction of a vehicle's axles in the model frame, a unit vector of shape (3,).

    A vehicle that faces along x has axles along y. For other vehicles, this is the mean direction
    of the wheels' axes, provided that the wheels are placed accordingly.

    Args:
        robot: The vehicle.
        first: Joints of the wheels on one side, or at the front.
        second: Joints of the wheels on the other side, or at the back.
        beside: Whether the two groups are beside each other, not one behind the other.
    """
    usual = np.array([0.0, 1.0, 0.0])
    groups = [
        [each for name in names if (each := robot.joints[name]).child in robot.placed]
        for names in (first, second)
    ]
    axes: list[Floats] = []
    # The axes of steering joints are vertical, so those of the wheels are used.
    for joints in ([*groups[0], *groups[1]], _rolling(robot)):
        level = [wheel_axis(robot, joint) * _LEVEL for joint in joints]
        axes = axes or [axis for axis in level if np.linalg.norm(axis) >= CAMBER]
    if not axes or not all(groups):
        return usual
    mean = np.sum([axis if axis @ axes[0] >= 0 else -axis for axis in axes], axis=0)
    mean /= np.linalg.norm(mean)
    centres = [
        np.mean([wheel_place(robot, each).position for each in group], axis=0) for group in groups
    ]
    gap = (centres[0] - centres[1]) * _LEVEL
    along = float(abs(gap @ mean) / (np.linalg.norm(gap) or 1.0))
    fits = along > _ALONG if beside else along < 1 - _ALONG
    return mean if fits and abs(mean @ usual) < _ALONG else usual


def axle_toward_left(robot: Robot, left: Joint, right: Joint) -> Floats | None:
    """Direction of an axle toward the robot's left, a unit vector of shape (3,).

    In a robot that faces along x, left is toward positive y. In a robot that faces along y, it is
    toward the left wheel. None if the wheels are not beside each other.
    """
    gap = gap_between(robot, left, right)
    wide = float(np.linalg.norm(gap))
    if wide < 1e-6 or abs(gap[2]) > 0.2 * wide:
        return None
    sign = 1 if gap[1] >= 0 or faces_sideways(gap) else -1
    return np.asarray(gap / wide * sign)


def gap_between(robot: Robot, left: Joint, right: Joint) -> Floats:
    """Vector from the right wheel to the left wheel in the model frame, shape (3,), m."""
    places = [np.array(wheel_place(robot, joint).position) for joint in (left, right)]
    gap = np.asarray(places[0] - places[1])
    middles = [np.array(wheel_middle(robot, joint)) for joint in (left, right)]
    between = np.asarray(middles[0] - middles[1])
    # The wheels' shapes may be offset from their joints, even to the other side.
    return between if np.linalg.norm(gap) < _SAME or gap @ between < 0 else gap


def is_legacy(drive: Drive) -> bool:
    """Whether ``<legacyMode>`` reverses the turning direction of a drive."""
    stated = drive.tag.element.find("legacyMode")
    return stated is not None and stated.text.strip().lower() in ("true", "1")


def faces_sideways(gap: Floats) -> bool:
    """Whether a robot faces along y, from the vector between its left and right wheel."""
    return bool(abs(gap[1]) < _TURNED * abs(gap[0]))


def axis_senses(robot: Robot, left: Joint, right: Joint) -> list[float]:
    """Component of each wheel's axis toward the robot's left along the axle, from -1 to 1.

    Empty if the sides cannot be determined.
    """
    unit = axle_toward_left(robot, left, right)
    if unit is None:
        return []
    return [float(wheel_axis(robot, joint) @ unit) for joint in (left, right)]


def faces_backwards(robot: Robot, left: Joint, right: Joint) -> bool:
    """Whether reversed axes only mean that a robot faces backwards, or along negative y.

    The left wheel is then on the right of a robot that faces forward, and a camera or steered
    wheels show that its front is at -x. If the wheels are beside each other along x, the names of
    the wheels may be swapped instead.
    """
    gap = gap_between(robot, left, right)
    return faces_sideways(gap) or bool(gap[1] < 0 and (_is_steered(robot) or looks_back(robot)))


def looks_back(robot: Robot) -> bool:
    """Whether the robot has cameras that look along -x of its root link, and none along x."""
    ahead = [
        rotate((robot.links[link.name].pose @ sensor.pose).orientation, (1.0, 0.0, 0.0))[0]
        for link in robot.description.links
        if link.name in robot.placed
        for sensor in link.sensors
        if sensor.cameras
    ]
    return bool(ahead) and min(ahead) < -_LOOKS and max(ahead) < _LOOKS


def _is_steered(robot: Robot) -> bool:
    """Whether a plugin or controller steers the robot's wheels, which are at its front or back."""
    return bool(robot.steered) or any(
        role.role == "steering" and role.joints(tag.element)
        for tag in robot.description.plugins
        for role in plugin_tags.roles(tag.filename)
    )


def wheel_links(robot: Robot, joint: Joint) -> list[str]:
    """The joint's child link and all links fixed to it."""
    root = robot.rigid_root(joint.child)
    return robot.rigid_groups[root] if root == joint.child else [joint.child]


def wheel_joints(robot: Robot) -> list[Joint]:
    """The wheel joints of all plugins and controllers that drive the base."""
    names = dict.fromkeys(name for sides in robot.sides for side in sides for name in side)
    found = [robot.joints[name] for name in names if name in robot.joints]
    return [joint for joint in found if joint.child in robot.links]


def gz_wheels(robot: Robot) -> list[str]:
    """Names of the wheel joints of gz-sim's drives, whose velocity limits apply.

    Cars and robots with mecanum wheels are not among the `Robot.drives`.
    """
    return [
        name
        for tag in robot.description.plugins
        if plugin_named(tag.filename) in _GZ_DRIVES
        for role in plugin_tags.roles(tag.filename)
        if role.role in (*WHEEL_ROLES, "joint")
        for name in role.joints(tag.element)
    ]


def lowest(robot: Robot, *links: str) -> float | None:
    """Lowest point of the collisions of some links in the model frame, m."""

    def compute() -> float | None:
        found = [(link, solid) for link in links for solid in robot.collisions[link]]
        box = bounds([solid.placed(robot.links[link].pose) for link, solid in found])
        return None if box is None else float(box[0][2])

    return robot.once("lowest", links, compute)


def wheel_place(robot: Robot, joint: Joint) -> Pose:
    """Pose of a wheel joint in the model frame; in SDF, the child link's frame may be elsewhere."""
    return robot.links[joint.child].pose @ joint.pose


def drives_in(subject: Subject) -> Iterator[tuple[Robot, Drive]]:
    """The drives of all robots, each with its robot."""
    for robot in subject.robots:
        for drive in robot.drives:
            yield robot, drive


def placed_pair(robot: Robot, first: str, second: str) -> tuple[Joint, Joint] | None:
    """Two different joints by their names; None if the place of one of them is unknown."""
    left, right = robot.joints.get(first), robot.joints.get(second)
    if left is None or right is None or left is right:
        return None
    return (left, right) if {left.child, right.child} <= robot.placed else None


def wheel_pairs(subject: Subject) -> Iterator[tuple[Robot, Drive, Joint, Joint]]:
    """The first wheel pair of each drive, or every pair of a differential drive with several."""
    for robot, drive in drives_in(subject):
        if len(drive.left) != len(drive.right):
            continue
        for names in zip(drive.left, drive.right, strict=True):
            pair = placed_pair(robot, *names)
            if pair is None:
                continue
            yield robot, drive, *pair
            if len(drive.left) > 1:
                break
