"""Other values of its arguments with which a launch file starts other robots, or Gazebo."""

from __future__ import annotations

import itertools
import re
from collections.abc import Collection, Iterator, Mapping, Sequence
from dataclasses import replace
from functools import partial
from pathlib import Path

from cartwheel.codes.files import LAUNCH_VALUE_UNKNOWN
from cartwheel.description.elements.xml import shown_path
from cartwheel.description.files.packages import Packages
from cartwheel.description.files.regular_files import text_if_regular
from cartwheel.description.launches.effort import UNKNOWN, Effort
from cartwheel.description.launches.launch_use import LaunchUse
from cartwheel.description.launches.mistakes.absence import Absence
from cartwheel.description.launches.reading import INCLUDES, facts_of, uses_of
from cartwheel.description.launches.use import Facts
from cartwheel.description.launches.variants import beside
from cartwheel.errors import Origin

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
_SIMULATOR = re.compile(r"gazebo|gz|ign|classic|sim|control", re.IGNORECASE)
_DEFAULT = re.compile(r"""<xacro:arg\s+name\s*=\s*["']([^"'<>]*)["']\s+default\s*=""")
"""The name of an argument of a xacro with a default."""


def uses_with_others(path: Path, packages: Packages, effort: Effort) -> Iterator[LaunchUse]:
    """What a launch file starts, also with other values of its arguments."""
    facts = facts_of(path, packages, {}, effort)
    needed = partial(_needed, path, packages, effort)
    unnamed = [*_unnamed(path, packages, facts, effort)]
    if not unnamed:
        # Otherwise, its controllers are those of one of the descriptions, not of any robot.
        yield from needed(uses_of(path, facts), {})
    if facts.count > INCLUDES:
        yield left_out(path, f"the launch file includes more than {INCLUDES} files", "not all are")
    switch = _switch(path, packages, facts, {}, effort)
    if switch:
        other = facts_of(path, packages, switch, effort)
        yield from needed([*_switched(path, other, switch)], switch)
    known = {description for description, _ in facts.descriptions}
    sought = bool(switch or known)
    for given in _others(facts) or unnamed:
        other = facts_of(path, packages, given, effort)
        new = {description for description, _ in other.descriptions} - known
        known |= new
        if not new:
            continue
        if not sought:
            # The same one is for all robots.
            switch, sought = _switch(path, packages, other, given, effort), True
        found = [each for each in uses_of(path, other, given.values()) if each.description in new]
        # What depends on these values is not certain, because nobody states them.
        guessed = dict.fromkeys(given, UNKNOWN)
        for use in needed(found, guessed):
            yield _without_defaults(use, facts.defaults) if use.guessed else use
        if switch:
            both = facts_of(path, packages, {**given, **switch}, effort)
            uses = _switched(path, both, switch, given.values())
            yield from needed(
                [each for each in uses if each.description in new], {**guessed, **switch}
            )


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
    included = [file for file, _ in facts.includes]
    stopped = tuple(Absence(path, included, facts.folders, effort).certain(facts.missing))
    return [replace(each, stopped=stopped) for each in uses]


def _switched(
    path: Path, facts: Facts, switch: Mapping[str, str], words: Collection[str] = ()
) -> Iterator[LaunchUse]:
    """What a launch file starts with another value of an argument; see `_switch`."""
    for use in uses_of(path, facts, words):
        yield replace(use, switched=tuple(switch.items()))


def _without_defaults(use: LaunchUse, defaults: Mapping[str, str]) -> LaunchUse:
    """A launch file that may start any description, without the defaults of its arguments for which
    the description states defaults, too.

    These values are for another robot, such as ``dof:=7``. Those that are true or false are kept.

    Args:
        use: What the launch file says about the description.
        defaults: The defaults of its own arguments, whose names may differ from those of the xacro.
    """
    if use.description is None:
        return use
    text = text_if_regular(use.description)
    stated, other = frozenset(_DEFAULT.findall(text)), frozenset(defaults.values())
    return replace(
        use,
        arguments={
            name: value
            for name, value in use.arguments.items()
            if name not in stated or value not in other or value in _OPPOSITES
        },
    )


def _switch(
    path: Path, packages: Packages, facts: Facts, given: Mapping[str, str], effort: Effort
) -> dict[str, str]:
    """Another value of an argument with which a launch file starts Gazebo, another Gazebo, or
    controllers in Gazebo; empty if there is none.

    Many launch files start the real robot, unless an argument such as ``use_sim`` is true.

    Args:
        path: The launch file.
        packages: Finds packages.
        facts: Its contents.
        given: The arguments with which it was read.
        effort: What reading it may cost.
    """
    if not facts.leaves_out:
        return {}
    switches = (
        {name: other}
        for name, value in facts.defaults.items()
        for other in (*facts.choices.get(name, ()), *_OPPOSITES.get(value, ()))
        if other != value and (not facts.simulated or _SIMULATOR.search(f"{name} {value} {other}"))
    )
    kinds = facts.gazebos.kinds
    for switch in itertools.islice(switches, _SWITCHES):
        other = facts_of(path, packages, {**given, **switch}, effort)
        new = other.simulated
        if facts.simulated:
            controls = other.spawned and not facts.spawned
            new = bool(controls or (kinds and other.gazebos.kinds - kinds))
        if new and other.descriptions:
            return switch
    return {}


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


def _unnamed(
    path: Path, packages: Packages, facts: Facts, effort: Effort
) -> Iterator[dict[str, str]]:
    """Values of an argument with which a launch file starts robots, if its default is empty and a
    part of the name of a description, such as ``$(arg model).urdf.xacro``.
    """
    empty = [name for name, value in facts.defaults.items() if not value]
    if facts.descriptions or not facts.absent:
        return
    for name in empty[:_SWITCHES]:
        words = facts_of(path, packages, {name: UNKNOWN}, effort).words
        yield from ({name: word} for word in itertools.islice(words.values(), _VARIANTS))
        if words:
            return


def left_out(path: Path, why: str, what: str) -> LaunchUse:
    """Stands for what was not read of a launch file, with the reason."""
    said = LAUNCH_VALUE_UNKNOWN.diagnostic(
        f"{why}, so {what} read",
        origin=Origin(file=shown_path(path)),
        values={"what": "launch file"},
    )
    return LaunchUse(file=path, description=None, arguments={}, left_out=said)
