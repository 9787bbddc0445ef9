"""Reads a launch file with arguments."""

from __future__ import annotations

import re
from collections.abc import Collection, Mapping
from pathlib import Path

from cartwheel.description.files.package_folders import package_above
from cartwheel.description.files.packages import Packages
from cartwheel.description.launches.effort import UNKNOWN, Effort
from cartwheel.description.launches.launch_use import LaunchUse, only_loaded
from cartwheel.description.launches.python.reading import read_python
from cartwheel.description.launches.python_variables import Place
from cartwheel.description.launches.use import ABSENT, Facts
from cartwheel.description.launches.xml_launch import read_xml

INCLUDES = 60
"""Maximum number of files that a launch file may include, also indirectly."""


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
    facts.note_kept()
    return facts


def uses_of(path: Path, facts: Facts, words: Collection[str] = ()) -> list[LaunchUse]:
    """What a launch file starts; `words` are the values of arguments without their defaults."""
    described: list[tuple[Path | None, dict[str, str]]] = [*facts.descriptions]
    if not described and (facts.yamls or facts.spawned or facts.loaded or facts.unsure):
        described.append((None, {}))
    found = []
    spawned = tuple(dict.fromkeys(name for _, name in facts.spawned))
    shown = _only_shown(facts)
    models = {(each.source, each.file, each.model) for each in facts.spawns}
    several = max(len(models), len({file for file, _ in described})) > 1
    alone = bool(facts.descriptions) and facts.spawning and not (facts.partial or several)
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
                several=several,
                places=tuple(dict.fromkeys(facts.places)),
                incomplete=facts.incomplete,
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


def _read(path: Path, arguments: Mapping[str, str], facts: Facts, depth: int) -> None:
    facts.count += 1
    if facts.count > INCLUDES:
        return
    reader = read_python if path.suffix == ".py" else read_xml
    reader(path, arguments, facts, depth)
