"""Explains why a robot does not stand, by diagnostics."""

from __future__ import annotations

import re
from collections.abc import Sequence, Set

from cartwheel.checks.robot import Robot
from cartwheel.checks.wheels import lowest, wheel_axis, wheel_links
from cartwheel.codes import devices, files, robot, tags
from cartwheel.corpus.faults import coded, is_lost_model, most_severe
from cartwheel.corpus.movers import LEFT_OUT, may_move
from cartwheel.corpus.verdict import Stand, Verdict
from cartwheel.description.kinematics import carried
from cartwheel.description.model import Joint, RobotDescription
from cartwheel.errors import Diagnostic

_STANDING = frozenset(
    {
        files.FILE_MISSING,
        files.MESH_UNREADABLE,
        robot.BASE_WITHOUT_COLLISION,
        robot.WHEEL_WITHOUT_COLLISION,
        robot.WHEELS_OFF_GROUND,
        robot.INERTIA_MISSING,
        robot.JOINT_LINK_UNKNOWN,
        robot.UNBALANCED,
        robot.OVERLAPPING_COLLISIONS,
        robot.JOINTS_UNDRIVEN,
    }
)
_ABSENT = frozenset(
    {
        files.FILE_MISSING,
        files.FILE_ON_NETWORK,
        files.MESH_UNREADABLE,
        tags.VALUE_INVALID,
    }
)
"""Reasons why a shape is missing."""
_LACKING = frozenset(
    {
        robot.WHEEL_WITHOUT_COLLISION,
        robot.WHEELS_OFF_GROUND,
        robot.INERTIA_MISSING,
        robot.JOINT_LINK_UNKNOWN,
        robot.UNBALANCED,
        robot.JOINTS_UNDRIVEN,
    }
)
"""Reasons that a missing part may explain: it may carry, balance or hold the robot."""
_LIGHT = re.compile(
    r"camera|kinect|realsense|_[dl]4[0-9]5|depth|lidar|laser|scan|velodyne|hokuyo|ouster|sonar|ultraso"
    r"|sensor|material|colou?r|(?<![a-z])(?:zed|imu|gps|sick|astra)(?![a-z])"
)
"""Names of parts that carry no robot: sensors and materials."""
_UPRIGHT = 0.7
"""Smallest vertical component of the axis of what is no wheel."""
_SLID, _TURNED = 0.02, 0.2
"""Way by which limits push a joint that may make a robot fall, m and rad."""
_LOW = 0.03
"""Maximum height of a part on the ground above the lowest point, relative to the robot's size."""
_PART = 0.5
"""Part of the angle by which a robot tilted that explains the angle."""
_FALLEN = 1.0
"""m, or robot sizes if it is longer than 1 m, by which only a robot sinks that falls through the
ground."""
_ROOT = re.compile(
    r"(?>\s+|<!--.*?-->|<\?.*?\?>|<!DOCTYPE(?:[^<>\[]|\[[^\]]*\])*+>)*+<([\w:]+)", re.DOTALL
)
"""The first element of an XML text. Possessive: otherwise there would be two ways to separate
consecutive comments.
"""


def cause_of_fall(
    stand: Stand,
    description: RobotDescription,
    found: Sequence[Diagnostic],
    idle: Diagnostic | None,
    wheel: Diagnostic | None = None,
) -> Diagnostic | None:
    """Why a robot does not stand.

    Args:
        stand: How it stood.
        description: The robot.
        found: Diagnostics of the run and of `cartwheel check`.
        idle: The reason why no controller holds the joints, apart from those that only publish;
            None if one does or none is needed.
        wheel: See `lost_wheel`.
    """
    if stand.floats:
        return coded(found, frozenset({robot.SINKS_IN_WATER}))
    lost = next(
        (
            each
            for each in found
            if is_body_lost(each, description) or (is_lost_model(each) and not _is_light(each))
        ),
        None,
    )
    if lost is not None or wheel is not None:
        return lost or wheel
    limp = _limp(found, description)
    reasons = [each for each in found if _explains_fall(each) and not _is_carried(each, limp)]
    if idle is not None:
        left_out = {robot.JOINTS_UNDRIVEN}
        if any(_bends(joint) for joint in description.joints):
            # Limbs that nothing holds give way; links without an inertia have a mass here.
            left_out.add(robot.INERTIA_MISSING)
        reasons = [each for each in reasons if each.code not in left_out]
    reasons = _without_lacking(reasons, found, description)
    if falls_through(stand):
        bottomless = coded(reasons, frozenset({robot.BASE_WITHOUT_COLLISION}))
        if bottomless is not None:
            return bottomless
    if any(each.code is robot.UNBALANCED for each in reasons):
        # It is reported only if no missing collision can carry the robot, and is computed with the
        # masses of all links.
        reasons = [each for each in reasons if each.code not in _ABSENT | {robot.INERTIA_MISSING}]
    if any(_tips_rigid(each, stand) for each in reasons):
        # Even if its joints were held.
        reasons = [each for each in reasons if each.code is not robot.JOINTS_UNDRIVEN]
    reason = most_severe(reasons) or idle or _pushed(found, description)
    if reason is not None and reason.code is robot.JOINTS_UNDRIVEN:
        return _unsupported(found, description) or reason
    return reason or _badly_held(found, stand)


def _unsupported(found: Sequence[Diagnostic], description: RobotDescription) -> Diagnostic | None:
    """The finding that a plugin is not supported that may hold the joints."""
    names = {tag.filename for tag in description.plugins if may_move(tag.filename)}
    return next(
        (
            each
            for each in found
            if each.code is devices.PLUGIN_UNKNOWN
            and not names.isdisjoint({each.values.get("name"), each.values.get("plugin")})
            and not each.values.get("meant")
        ),
        None,
    )


def _badly_held(found: Sequence[Diagnostic], stand: Stand) -> Diagnostic | None:
    """Why controllers do not hold a robot still or up: their gains, or their joints' limits."""
    if stand.state == "moves":
        return coded(found, frozenset({devices.DERIVATIVE_GAIN_TOO_HIGH}))
    return next((each for each in found if "sagged" in each.values), None)


def _tips_rigid(each: Diagnostic, stand: Stand) -> bool:
    """Whether a finding says that the robot tips over although no joint moves."""
    if each.code is not robot.UNBALANCED:
        return False
    outside, tilt = each.values.get("outside"), each.values.get("tilt")
    if isinstance(tilt, float):
        return tilt >= _PART * stand.tilt
    return bool(each.values.get("falls")) or (isinstance(outside, float) and outside > 0)


def _pushed(found: Sequence[Diagnostic], description: RobotDescription) -> Diagnostic | None:
    """A joint above a part on the ground that its limits push out of its place at the start."""
    body = Robot(description, None)
    lows = {name: low for name in body.placed if (low := lowest(body, name)) is not None}
    ground = min(lows.values(), default=0.0)
    above = body.carrying(name for name, low in lows.items() if low < ground + _LOW * body.size)
    for each in found:
        joint = body.joints.get(str(each.values.get("joint", "")))
        if each.code is not robot.START_OUTSIDE_LIMITS or joint is None or joint.name not in above:
            continue
        start, lower, upper = (each.values[name] for name in ("start", "lower", "upper"))
        assert isinstance(start, float) and isinstance(lower, float) and isinstance(upper, float)
        way = max(lower - start, start - upper)
        if way > (_SLID if joint.type == "prismatic" else _TURNED):
            return each
    return None


def lost_wheel(
    found: Sequence[Diagnostic], description: RobotDescription, driven: Set[str]
) -> Diagnostic | None:
    """Why a driven wheel has no collision although the description contains one, such as a missing
    mesh. None if all driven wheels have one, or none is written.

    Args:
        found: Diagnostics of the run.
        description: The robot.
        driven: The joints that plugins and controllers drive.
    """
    body = Robot(description, None)
    lost: dict[str, None] = {}
    for joint in description.joints:
        if joint.name not in driven or not joint.turns or joint.child not in body.placed:
            continue
        links = wheel_links(body, joint)
        # A propeller turns about the vertical.
        if abs(wheel_axis(body, joint)[2]) < _UPRIGHT and not any(map(body.collisions.get, links)):
            lost |= dict.fromkeys(links)
    return most_severe(
        each
        for each in found
        if each.values.get("left_out") == "collision" and _link_of(each, description) in lost
    )


def _link_of(each: Diagnostic, description: RobotDescription) -> str:
    """The link of a shape that is left out; in SDF, the one that begins above it."""
    if "link" in each.values or each.origin is None:
        return str(each.values.get("link", ""))
    file, line = each.origin.file, each.origin.line
    above = [
        link for link in description.links if link.origin.file == file and link.origin.line <= line
    ]
    return max(above, key=lambda link: link.origin.line).name if above else ""


def falls_through(stand: Stand) -> bool:
    """Whether a robot sank so far that it fell through the ground."""
    return stand.sunk > _FALLEN * max(1.0, stand.size)


def _without_lacking(
    reasons: Sequence[Diagnostic], found: Sequence[Diagnostic], description: RobotDescription
) -> list[Diagnostic]:
    """The reasons, with that why a part is missing in the place of what the part may contain."""
    absent = [each for each in found if each.code in LEFT_OUT]
    heavy = [] if _only_hold(found, description) else [e for e in absent if not _is_light(e)]
    for codes, parts in ((frozenset({robot.BASE_WITHOUT_COLLISION}), absent), (_LACKING, heavy)):
        lost = most_severe(parts)
        if lost is not None and any(each.code in codes for each in reasons):
            return [lost, *(each for each in reasons if each.code not in codes)]
    return [*reasons]


def _only_hold(found: Sequence[Diagnostic], description: RobotDescription) -> bool:
    """Whether the links that missing parts would define only connect other links."""
    lost = {
        each.values.get("link")
        for each in found
        if each.code is files.LINK_RECONNECTED and not each.values.get("parent")
    }
    parents = {joint.parent for joint in description.joints}
    return bool(lost) and lost <= parents & {joint.child for joint in description.joints}


def _is_light(absent: Diagnostic) -> bool:
    """Whether a missing part is a sensor or materials, by its name."""
    file = str(absent.values.get("file", ""))
    # A package that exists is the robot's own, which may be named after a sensor.
    names = [file.rpartition("/")[2]]
    if not file or absent.values.get("kind") == "package":
        names.append(str(absent.values.get("name", "")))
    return any(_LIGHT.search(name.lower()) for name in names)


def _limp(found: Sequence[Diagnostic], description: RobotDescription) -> set[str]:
    """The links of limbs that were seen to give way, without the wheels that they carry."""
    moved = {
        name
        for each in found
        if each.code is robot.JOINTS_UNDRIVEN and "moved" in each.values
        for name in _listed(each, "joints")
    }
    links = {joint.child for joint in description.joints if joint.name in moved}
    return carried((joint for joint in description.joints if not joint.turns), links)


def _listed(each: Diagnostic, key: str) -> tuple[object, ...]:
    values = each.values.get(key, ())
    return values if isinstance(values, tuple) else ()


def _is_carried(each: Diagnostic, limp: Set[str]) -> bool:
    """Whether a missing shape belongs to a limb that gave way, with the shape or without it."""
    return each.code in _ABSENT and each.values.get("link") in limp


def _bends(joint: Joint) -> bool:
    """Whether it is the joint of a limb rather than of a wheel."""
    return joint.type in ("revolute", "prismatic") and joint.axis.lower is not None


def _explains_fall(each: Diagnostic) -> bool:
    if each.code in _ABSENT:
        return each.values.get("left_out") == "collision"
    return each.code in _STANDING


def is_body_lost(each: Diagnostic, description: RobotDescription) -> bool:
    """Whether the root link is empty because the included file that defines it is absent."""
    held = {joint.child for joint in description.joints}
    return (
        each.code is files.LINK_RECONNECTED
        and not each.values.get("parent")
        and each.values.get("link") not in held
    )


def has_devices(description: RobotDescription) -> bool:
    """Whether a description contains plugins or sensors for Gazebo.

    Sensors that only Cartwheel's stand-in for a package adds do not count.
    """
    sensors = {sensor.name for link in description.links for sensor in link.sensors}
    for each in description.diagnostics:
        added = each.values.get("added_sensors", ())
        if each.code is files.STAND_IN_USED and isinstance(added, tuple):
            sensors.difference_update(added)
    return bool(description.plugins or sensors)


def need_not_stand(verdict: Verdict, description: RobotDescription) -> bool:
    """Whether a description is for other programs, such as RViz or MuJoCo: a URDF without plugins
    and sensors that no launch file starts in Gazebo.
    """
    if verdict.movers or verdict.drives or has_devices(description):
        return False
    if coded(description.diagnostics, LEFT_OUT) is not None:
        # The missing part may contain some.
        return False
    started = verdict.launch is not None and verdict.launch.simulated
    root = _ROOT.match(description.text)
    return root is not None and root[1] == "robot" and not started
