"""What should move a robot: its drive plugins and controllers, supported or not.

Some would move joints that do not exist in Gazebo.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Set
from pathlib import Path

from cartwheel.codes import robot as robot_codes
from cartwheel.codes.files import INCLUDE_ABSENT, MACRO_ABSENT
from cartwheel.codes.tags import TAG_IGNORED
from cartwheel.corpus.faults import coded
from cartwheel.corpus.verdict import Verdict
from cartwheel.description.files.library_sources import library_sources
from cartwheel.description.files.repositories import repository_of, root_of
from cartwheel.description.kinematics import carried
from cartwheel.description.model import Element, PluginTag, RobotDescription
from cartwheel.dialects.catalogue import OF_FETCH, plugin_named, short_name
from cartwheel.dialects.world_plugins import BUILT_IN, WITHOUT_EFFECT, refused
from cartwheel.errors import Diagnostic

_MOVES = re.compile(
    r"drive|steer|drone|copter|planar_move|force_based_move|motor|mecanum|tricycle|kobuki|multi_wheel|thruster"
    r"|propeller|rotor(?!s_gazebo)|velocity-control|joint-.*controller|ackerman|trajectory|(?<!_ros)_control",
    re.IGNORECASE,
)
"""Names of plugins that move something. Those of controller managers are not among them."""
_RECORDS = re.compile(r"(?:^|_)bag_plugin|record", re.IGNORECASE)
"""Names of plugins that only record what moves."""
_REPORTS = re.compile(r"status|state|monitor|publisher|sensor|encoder|odom|wind", re.IGNORECASE)
"""Names of unsupported plugins without commands, although their tags contain joints or forces."""
_TRAVELS = re.compile(
    r"follow|vehicle|navigat|patrol|waypoint|locomot|walk|driver|servo|actuat"
    r"|dynamics|buoyan|hydro(?!phone)|thruster|propuls"
    r"|(?<!re)mov(?:e(?!it)|ing)|(?<!e)motion(?!_?(?:capture|detect))",
    re.IGNORECASE,
)
"""Names of unsupported plugins that move something."""
_MANAGER = re.compile(rf"ros2?_control|^{OF_FETCH}$")
_COMMANDS = re.compile(
    r"gain|force|torque|thrust|motor|rotor|cmd_?vel|(?:^|_)traj(?:_|$|ector)|way_?point"
    r"|^(?:linear|angular)_?velocity$",
    re.IGNORECASE,
)
"""Names of the tags of unsupported plugins that move something."""
_ROUTE = re.compile(r"^(?:path|route)(?:_?points)?$", re.IGNORECASE)
"""Names of tags that contain the points of a route; those of a file contain its name."""
_ACTS = re.compile(
    r"(?:->|\.)\s*(?:Set(?:Link|Joint)?(?:Relative|World)?(?:Pose|Twist)(?:Cmd)?"
    r"|(?:Set|Add)(?:Link|World|Relative)?(?:Force|Torque|Wrench)"
    r"(?:At(?:World|Relative)Position|InInertialFrame)?"
    r"|Set(?:Linear|Angular)?(?:Vel|Velocity|Accel)(?:Target|Cmd)?"
    r"|Set(?:Joint)?Positions?Target|SetJointPositions?|ResetPosition|ResetVelocity)\s*\("
    r"|(?:->|\.)\s*SetPosition\s*\(\s*\d"
    r"|\b(?:Joint(?:Velocity|Force)Cmd|(?:Linear|Angular)VelocityCmd|WorldPoseCmd"
    r"|ExternalWorldWrenchCmd|Joint(?:Position|Velocity)Reset)\b"
)
"""Calls of Gazebo Classic's and gz-sim's C++ interfaces, and components, that move something."""
_CPP_COMMENT = re.compile(r"//[^\n]*")
STEERED = re.compile(r"ackerman|(?<!skid)(?<!skid[-_])steer|tricycle|bicycle", re.IGNORECASE)
"""Names of plugins and types of controllers for bases that cannot turn in place."""
LEFT_OUT = frozenset({INCLUDE_ABSENT, MACRO_ABSENT})
"""Reasons why a part of the robot is missing."""


def movers(verdict: Verdict, robot: RobotDescription) -> list[str]:
    """Names of the plugins and controllers, or topics, that should move a robot or its joints."""
    names = [short_name(tag.filename) for tag in (*moving_plugins(robot), *managers(robot))]
    names += [drive.topic for drive in verdict.drives]
    names += [spin.topic for spin in verdict.spins]
    names += [flight.topic for flight in verdict.flights]
    names += [each.controller for each in verdict.reaches]
    return list(dict.fromkeys(names))


def moving_plugins(robot: RobotDescription) -> list[PluginTag]:
    """Plugins that should move the robot or its joints, without controller managers: those of
    `named_movers`, and unsupported ones whose source `applies` forces or velocities.
    """
    named = named_movers(robot)
    return [tag for tag in robot.plugins if tag in named or applies(tag)]


def named_movers(robot: RobotDescription) -> list[PluginTag]:
    """Plugins that should move the robot or its joints by their names and tags.

    An unsupported plugin also counts if its tags contain the name of a movable joint, if a tag is
    named after gains, forces, motors, velocity commands or trajectories, if its own name contains a
    word such as "move" or "servo", or if nothing else moves a robot with wheels or with joints for
    controllers, unless its own name says that it only measures. In such a robot, a plugin that
    Gazebo refuses to load in a model counts if its name says that it moves something, such as
    ``gazebo_ros_control``.
    """
    joints = {joint.name for joint in robot.joints if joint.type != "fixed"}
    waits = _waits(robot)
    return [
        tag
        for tag in robot.plugins
        if not _MANAGER.search(name := short_name(tag.filename))
        and not _RECORDS.search(name)
        and (
            _MOVES.search(name)
            or (waits and is_mover(tag.name) and refused(tag) is not None)
            or (
                may_move(tag.filename)
                and (waits or _TRAVELS.search(name) or _acts(tag.element, joints))
            )
        )
    ]


def applies(tag: PluginTag) -> bool:
    """Whether the source of an unsupported plugin, in the repository of the file with its tag,
    applies forces, velocities or poses.
    """
    name = short_name(tag.filename)
    if is_known(tag) or name in WITHOUT_EFFECT or _MANAGER.search(name) or _RECORDS.search(name):
        return False
    file = Path(tag.origin.file)
    folder = repository_of(file) or root_of(file)
    return folder is not None and any(
        _ACTS.search(_CPP_COMMENT.sub("", text)) for text in library_sources(name, folder)
    )


def is_mover(filename: str) -> bool:
    """Whether a plugin moves a robot or its joints, or runs controllers, by its name alone."""
    name = short_name(filename)
    return bool(_MANAGER.search(name) or (_MOVES.search(name) and not _RECORDS.search(name)))


def may_drive(filename: str, words: Set[str], joints: Set[str]) -> bool:
    """Whether a plugin is not supported, and the `words` in its tags name some of the `joints`."""
    return may_move(filename) and not joints.isdisjoint(words)


def ignored_movers(robot: RobotDescription) -> list[tuple[str, Diagnostic]]:
    """Plugins that should move a robot, but are in an element that is ignored.

    A plugin counts if its name or the tags in it say that it moves something, or if it is not
    supported, perhaps because its name is misspelt, and nothing else moves a robot with wheels or
    with joints for controllers. It does not if the robot has the same plugin in a place where it is
    loaded.

    Returns:
        The short names of the plugins, each with the diagnostic of the ignored element.
    """
    loaded = {short_name(tag.filename) for tag in robot.plugins}
    waits = _waits(robot)
    found: dict[str, Diagnostic] = {}
    for each in robot.diagnostics:
        names, tags = each.values.get("plugins", ()), each.values.get("parameters", ())
        if each.code is not TAG_IGNORED or not isinstance(names, tuple):
            continue
        acts = isinstance(tags, tuple) and any(_COMMANDS.search(str(tag)) for tag in tags)
        for filename in map(str, names):
            name = short_name(filename)
            moves = is_mover(filename) or ((acts or waits) and may_move(filename))
            if moves and name not in loaded:
                found.setdefault(name, each)
    return list(found.items())


def managers(robot: RobotDescription, *, jointless: bool = False) -> list[PluginTag]:
    """Controller managers of a robot with movable joints, or of any robot if `jointless`."""
    if not jointless and all(joint.type == "fixed" for joint in robot.joints):
        return []
    return [tag for tag in robot.plugins if _MANAGER.search(short_name(tag.filename))]


def is_known(tag: PluginTag) -> bool:
    """Whether Cartwheel supports a plugin."""
    return bool(plugin_named(tag.filename)) or short_name(tag.filename) in BUILT_IN


def is_own_mover(tag: PluginTag) -> bool:
    """Whether an unsupported plugin moves a model in its own way, such as by forces of water, also
    if other plugins drive all joints.
    """
    return bool(_TRAVELS.search(short_name(tag.filename)))


def may_move(filename: str) -> bool:
    """Whether a plugin is not supported, and its name does not say that it only measures."""
    name = short_name(filename)
    known = plugin_named(filename) or name in BUILT_IN or name in WITHOUT_EFFECT
    return not known and not reports(name) and not _RECORDS.search(name)


def _waits(robot: RobotDescription) -> bool:
    """Whether nothing that is supported moves a robot that something should move."""
    moved = any(is_known(tag) and is_mover(tag.filename) for tag in robot.plugins)
    return _should_move(robot) and not moved


def _should_move(robot: RobotDescription) -> bool:
    """Whether joints turn without limits, or the description lists joints to command.

    A single joint counts if the robot has a single plugin: otherwise it may be that of a caster.
    """
    listed = any(True for each in robot.transmissions for _ in each.find_all("joint"))
    turning = sum(joint.turns for joint in robot.joints)
    return (
        listed
        or bool(robot.ros2_control)
        or turning > 1
        or (turning == 1 and len(robot.plugins) == 1)
    )


def reports(name: str) -> bool:
    """Whether a plugin of this short name only measures or publishes."""
    return bool(_REPORTS.search(name))


def _acts(element: Element, joints: set[str]) -> bool:
    """Whether the tags of an unsupported plugin contain a joint's name, or name a command."""
    parts = list(element.walk())
    words = {word for each in parts for word in each.text.split()}
    return not joints.isdisjoint(words) or any(
        _COMMANDS.search(each.tag) or (_ROUTE.search(each.tag) and not _names_file(each))
        for each in parts[1:]
    )


def _names_file(tag: Element) -> bool:
    """Whether the text of a tag is the name of a file or a topic, rather than numbers."""
    return any(character.isalpha() for character in tag.text)


def dropped_joints(
    verdict: Verdict, description: RobotDescription
) -> Iterator[tuple[str, Diagnostic]]:
    """A joint that is driven, or that a plugin that is not supported would drive, but that does not
    exist in Gazebo, because the link that it moves, or one that carries it, has no mass.
    """
    named = {name for tag in moving_plugins(description) for name in _joints(tag, description)}
    for joint, reason in _lost(description).items():
        if joint in verdict.driven or joint in named:
            yield joint, reason
            return


def moves_nothing(reason: Diagnostic | None, description: RobotDescription) -> bool:
    """Whether the joints in the tags of a plugin do not exist in Gazebo, so that it is no loss.

    Args:
        reason: The diagnostic that the plugin is not supported.
        description: The robot.
    """
    name = "" if reason is None else reason.values.get("name", "")
    lost = _lost(description).keys()
    joints = [
        joint
        for tag in description.plugins
        if tag.filename == name
        for joint in _joints(tag, description)
    ]
    return bool(joints) and lost >= set(joints)


def _joints(tag: PluginTag, description: RobotDescription) -> Iterator[str]:
    """The joints that are named in the tags of a plugin."""
    names = {joint.name for joint in description.joints if joint.type != "fixed"}
    for element in tag.element.walk():
        yield from (word for word in element.text.split() if word in names)


def _lost(description: RobotDescription) -> dict[str, Diagnostic]:
    """The movable joints that do not exist in Gazebo, with the reasons."""
    if coded(description.diagnostics, LEFT_OUT) is not None:
        # The missing part may contain the mass.
        return {}
    held = {joint.child for joint in description.joints}
    found: dict[str, Diagnostic] = {}
    for each in description.diagnostics:
        links = each.values.get("links", ())
        if each.code is not robot_codes.INERTIA_MISSING or not isinstance(links, tuple):
            continue
        lost = carried(description.joints, {str(name) for name in links} & held)
        for joint in description.joints:
            if joint.child in lost:
                found.setdefault(joint.name, each)
    return found
