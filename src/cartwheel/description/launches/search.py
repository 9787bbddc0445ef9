"""Finds the launch files near a robot, and chooses the one whose settings are used."""

from __future__ import annotations

import itertools
import os
import re
from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence
from dataclasses import replace
from functools import partial
from pathlib import Path

from cartwheel.codes.files import LAUNCH_VALUE_UNKNOWN
from cartwheel.description.elements.xml import shown_path
from cartwheel.description.files.package_folders import package_above
from cartwheel.description.files.package_search import Searched
from cartwheel.description.files.packages import Packages
from cartwheel.description.files.source_folders import source_folders
from cartwheel.description.launches.effort import UNKNOWN, Effort, TooCostlyError
from cartwheel.description.launches.launch_use import LaunchUse, only_loaded
from cartwheel.description.launches.mistakes.absence import Absence
from cartwheel.description.launches.python_launch import read_python
from cartwheel.description.launches.python_variables import Place
from cartwheel.description.launches.use import ABSENT, Facts
from cartwheel.description.launches.variants import beside
from cartwheel.description.launches.xml_launch import read_xml
from cartwheel.errors import Origin

_FOLDER = 100
"""Steps to list a folder."""
_MOST = 500
"""Maximum number of launch files in a folder."""
INCLUDES = 60
"""Maximum number of files that a launch file may include, also indirectly."""
_VARIANTS = 20
"""Maximum number of other values of its arguments with which a launch file is read."""
_TRIED = 100
"""Maximum number of its arguments for which the folder of a description is searched."""
_SWITCHES = 12
"""Maximum number of other values of its arguments with which a launch file is read."""
_GZ = ("ignition", "gz", "ign", "gz_sim")
_OPPOSITES: Mapping[str, Sequence[str]] = {
    "true": ("false",),
    "True": ("False",),
    "1": ("0",),
    "false": ("true",),
    "False": ("True",),
    "0": ("1",),
    "classic": _GZ,
    "gazebo": _GZ,
    "gazebo_classic": _GZ,
    **dict.fromkeys(_GZ, ("classic", "gazebo", "gazebo_classic")),
}
_SIMULATOR = re.compile(r"gazebo|gz|ign|classic|sim", re.IGNORECASE)
_PUBLISHER = re.compile(r"state|broad", re.IGNORECASE)
"""Part of the names of controllers that only publish, such as ``joint_state_controller``."""


def launches_near(folder: Path, package_path: Sequence[Path] = ()) -> tuple[LaunchUse, ...]:
    """The robots that the launch files in a folder and its subfolders start, sorted by path.

    A launch file that starts controllers for a robot of another launch file is one of them, without
    a description. Launch files are parsed, not executed. Texts that cannot be determined without
    executing them are left out. What costs too much to read is left out too, and reported in
    `left_out` of the launch file or folder.
    """
    found: list[LaunchUse] = []
    # Which package is found depends on the folder of the launch file.
    packages: dict[Path, Packages] = {}
    searched: Searched = {}
    effort = Effort()
    last = "none of them is"
    try:
        for number, path in enumerate(launch_files(folder, effort)):
            if number == _MOST:
                found.append(_left_out(folder, f"there are more than {_MOST} launch files", last))
                break
            near = packages.get(path.parent) or Packages(path, package_path, searched=searched)
            packages[path.parent] = near
            found += _read_apart(path, near, effort)
            last = f'only those up to "{path.relative_to(folder)}" are'
    except TooCostlyError:
        found.append(_left_out(folder, "reading all launch files takes too long", last))
    return tuple(found)


def _read_apart(path: Path, packages: Packages, effort: Effort) -> Iterator[LaunchUse]:
    """What a launch file starts, as far as it can be read with a part of the effort."""
    with effort.portion():
        yield from _uses(path, packages, effort)
        return
    yield _left_out(path, "reading the launch file takes too long", "not all of it is")


def _left_out(path: Path, why: str, what: str) -> LaunchUse:
    left_out = LAUNCH_VALUE_UNKNOWN.diagnostic(
        f"{why}, so {what} read",
        origin=Origin(file=shown_path(path)),
        values={"what": "launch file"},
    )
    return LaunchUse(file=path, description=None, arguments={}, left_out=left_out)


def _uses(path: Path, packages: Packages, effort: Effort) -> Iterator[LaunchUse]:
    """What a launch file starts, also with other values of its arguments."""
    facts = facts_of(path, packages, {}, effort)
    needed = partial(_needed, path, packages, effort)
    yield from needed(uses_of(path, facts), {})
    if facts.count > INCLUDES:
        yield _left_out(path, f"the launch file includes more than {INCLUDES} files", "not all are")
    known = {description for description, _ in facts.descriptions}
    for given in _others(facts):
        other = facts_of(path, packages, given, effort)
        new = [
            number
            for number, (description, _) in enumerate(other.descriptions)
            if description not in known
        ]
        known |= {description for description, _ in other.descriptions}
        if new:
            found = uses_of(path, other, given.values())
            yield from needed([found[number] for number in new], given)
    if facts.leaves_out:
        yield from _switched(path, packages, facts, effort)


def _switched(path: Path, packages: Packages, facts: Facts, effort: Effort) -> Iterator[LaunchUse]:
    """What a launch file starts with another value of an argument, with which it starts Gazebo, or
    another Gazebo.

    Many launch files start the real robot, unless an argument such as ``use_sim`` is true.
    """
    switches = (
        {name: other}
        for name, value in facts.defaults.items()
        for other in (*facts.choices.get(name, ()), *_OPPOSITES.get(value, ()))
        if other != value and (not facts.simulated or _SIMULATOR.search(f"{name} {value} {other}"))
    )
    kinds = facts.gazebos.kinds
    for given in itertools.islice(switches, _SWITCHES):
        other = facts_of(path, packages, given, effort)
        new = kinds and other.gazebos.kinds - kinds if facts.simulated else other.simulated
        if new and other.descriptions:
            for use in _needed(path, packages, effort, uses_of(path, other), given):
                yield replace(use, switched=tuple(given.items()))
            return


def _needed(
    path: Path,
    packages: Packages,
    effort: Effort,
    uses: Sequence[LaunchUse],
    arguments: Mapping[str, str],
) -> list[LaunchUse]:
    """What a launch file starts with these arguments, with the missing files that it needs.

    The launch file is read once more, because only what is certain counts.
    """
    if not any(each.simulated and each.description is not None for each in uses):
        return [*uses]
    facts = facts_of(path, packages, arguments, effort, strict=True)
    if not facts.missing or facts.count > INCLUDES:
        return [*uses]
    stopped = tuple(Absence(path, facts.folders, effort).certain(facts.missing))
    return [replace(each, stopped=stopped) for each in uses]


def facts_of(
    path: Path,
    packages: Packages,
    arguments: Mapping[str, str],
    effort: Effort,
    others: Collection[Place] = (),
    *,
    strict: bool = False,
) -> Facts:
    """The contents of a launch file that is started with these arguments.

    Args:
        path: The launch file.
        packages: Finds packages.
        arguments: Its arguments.
        effort: What reading it may cost.
        others: Expressions with an unknown condition that have their other value.
        strict: Whether only what is certain counts; see `Facts.strict`.
    """
    facts = Facts(
        find=packages.found,
        read=_read,
        home=package_above(path.parent),
        effort=effort,
        file=path,
        reversed=others,
        strict=strict,
    )
    _read(path, arguments, facts, 0)
    facts.read_spawned()
    return facts


def _others(facts: Facts) -> list[dict[str, str]]:
    """Arguments with which a launch file may start other robots.

    For example, a launch file starts ``arm_$(arg size).urdf.xacro``, where the default of the
    argument is ``small``, and there is a file ``arm_large.urdf.xacro``. Whether the argument is in
    the name shows when the launch file is read again.
    """
    candidates = (
        (description, name, value)
        for description, _ in facts.descriptions
        for name, value in sorted(facts.defaults.items())
        if value and UNKNOWN not in value and value in description.name
    )
    found = (
        {name: word}
        for description, name, value in itertools.islice(candidates, _TRIED)
        for file, word in beside(description, value).items()
        if file != description
    )
    return list(itertools.islice(found, _VARIANTS))


def uses_of(path: Path, facts: Facts, words: Collection[str] = ()) -> list[LaunchUse]:
    """What a launch file starts; `words` are the values of arguments without their defaults."""
    described: list[tuple[Path | None, dict[str, str]]] = [*facts.descriptions]
    if not described and (facts.yamls or facts.spawned or facts.loaded or facts.unsure):
        described.append((None, {}))
    found = []
    spawned = tuple(dict.fromkeys(name for _, name in facts.spawned))
    shown = _only_shown(facts)
    alone = facts.spawning and not facts.partial and len({file for file, _ in described}) == 1
    worlds = tuple(map(facts.found_world, dict.fromkeys(facts.gazebos.worlds)))
    for number, (description, arguments) in enumerate(described):
        known = {name: text for name, text in arguments.items() if UNKNOWN not in text}
        found.append(
            LaunchUse(
                file=path,
                description=description,
                arguments=known,
                plain=facts.plain.get(number),
                raw=number in facts.raw,
                unknown=len(arguments) - len(known),
                controllers=tuple(dict.fromkeys(path for _, path in facts.yamls)),
                spawned=spawned,
                loaded=only_loaded((name for _, name in facts.loaded), spawned),
                undecided=frozenset(facts.undecided),
                unsure=facts.unsure,
                typed=frozenset(facts.typed),
                node_arguments=tuple(dict.fromkeys(each for _, each in facts.arguments)),
                absent=tuple(facts.lost),
                unfound=tuple(facts.unfound),
                foreign=tuple(facts.foreign),
                sought=tuple(dict.fromkeys(facts.sought)),
                sought_in_ros2=tuple(dict.fromkeys(facts.sought_in_ros2)),
                programs=tuple(facts.programs),
                managers=frozenset(facts.managers),
                sure_managers=frozenset(one for one, sure in facts.managers.items() if sure),
                alone=alone,
                places=tuple(dict.fromkeys(facts.places)),
                lacking=bool(facts.required),
                simulated=facts.simulated and number not in shown,
                guessed=description is not None and _is_whole(description.name, words),
                world=facts.world,
                gazebos=frozenset(facts.gazebos.kinds),
                gz_worlds=worlds,
                models=tuple(dict.fromkeys(each.name for each in facts.spawns if each.name)),
                spaces=frozenset(
                    UNKNOWN if "namespace" in each.unknown else each.namespace
                    for each in facts.spawns
                ),
            )
        )
    return found


def _only_shown(facts: Facts) -> set[int]:
    """The numbers of descriptions that a launch file does not spawn, although it spawns the same
    file with other arguments, such as those for a driver of the real robot.
    """
    spawned = [
        facts.published.get(each.source, ABSENT) if each.described is None else each.described
        for each in facts.spawns
    ]
    if ABSENT in spawned:
        return set()
    files = {facts.descriptions[number][0] for number in spawned}
    return {
        number
        for number, (file, _) in enumerate(facts.descriptions)
        if file in files and number not in spawned
    }


def _is_whole(name: str, words: Collection[str]) -> bool:
    """Whether one of the words is the whole name of a file, without its suffixes."""
    return any(re.fullmatch(re.escape(word) + r"(\.\w+)*", name) for word in words)


def chosen(description: Path, uses: Iterable[LaunchUse]) -> LaunchUse | None:
    """The launch file for a description: one that starts Gazebo and controllers, if there is one.

    One that starts Gazebo with its default arguments, and more than the publisher of joint states,
    comes first, unless a file that it needs is missing. Among equal ones it is the first by the
    number of unknown arguments and by path.
    """
    path = description.resolve()
    own = [
        each for each in uses if each.description is not None and each.description.resolve() == path
    ]
    return min(own, key=_order, default=None)


def controllers_for(
    description: Path, use: LaunchUse | None, uses: Sequence[LaunchUse]
) -> LaunchUse | None:
    """The launch file that starts a description's controllers: its own, or another one without a
    description in the same package, or in a package beside it.
    """
    if use is not None and use.controllers:
        return use
    return next(iter(starters(description, uses)), None)


def starters(
    description: Path, uses: Sequence[LaunchUse], *, described: bool = False
) -> list[LaunchUse]:
    """The launch files without a description that start controllers, nearest first.

    Args:
        description: The description.
        uses: Contents of launch files.
        described: Whether those with this description follow, which load it once more.
    """
    kinds: tuple[Path | None, ...] = (None, description.resolve()) if described else (None,)
    others = [
        (kinds.index(own), each)
        for each in uses
        if (own := each.description and each.description.resolve()) in kinds
        and each.spawned
        and each.controllers
    ]
    home = description.absolute()
    others.sort(key=lambda one: (one[0], -shared_parts(one[1].file, home), str(one[1].file)))
    return [each for _, each in others]


def _order(use: LaunchUse) -> tuple[bool, bool, bool, bool, int, bool, int, int, str]:
    return (
        not use.simulated,
        bool(use.stopped),
        bool(use.switched),
        # Another launch file may include it and state the argument.
        use.lacking,
        # A file may be loaded without a controller in it being started.
        -bool(use.spawned) - bool(use.controllers),
        # Launch files of MoveIt's assistant may only start a controller that moves nothing.
        not any(map(moves, use.spawned)),
        use.unknown,
        len(use.file.parts),
        str(use.file),
    )


def moves(name: str) -> bool:
    """Whether a controller may move joints, by its name: it is no publisher."""
    return _PUBLISHER.search(name) is None


def shared_parts(one: Path, other: Path) -> int:
    """How near two files are: the number of folders that contain both."""
    return len(Path(os.path.commonpath([one.absolute(), other.absolute()])).parts)


def launch_files(folder: Path, effort: Effort) -> Iterator[Path]:
    """The launch files in a folder and its subfolders, sorted by path."""
    for here, names in source_folders(folder):
        effort.spend(_FOLDER + len(names))
        yield from (here / name for name in names if _is_launch(here / name))


def _is_launch(path: Path) -> bool:
    """Whether a file is a launch file by its name, or by its folder, such as ``launch/sim.py``."""
    if path.name.endswith((".launch", ".launch.xml", ".launch.py", "_launch.py")):
        return True
    return path.suffix in (".py", ".xml") and path.parent.name == "launch"


def _read(path: Path, arguments: Mapping[str, str], facts: Facts, depth: int) -> None:
    facts.count += 1
    if facts.count > INCLUDES:
        return
    reader = read_python if path.suffix == ".py" else read_xml
    reader(path, arguments, facts, depth)
