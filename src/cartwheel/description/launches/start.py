"""What a launch file starts: models in a world."""

from __future__ import annotations

import ast
import functools
import itertools
from collections.abc import Callable, Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TypeVar

from cartwheel.codes import files as codes
from cartwheel.description.elements import xml
from cartwheel.description.elements.xml import shown_path
from cartwheel.description.files.package_folders import is_file
from cartwheel.description.files.packages import Packages
from cartwheel.description.files.regular_files import read_regular_text
from cartwheel.description.launches.bridging import RenamedTopic
from cartwheel.description.launches.effort import UNKNOWN, Effort, TooCostlyError
from cartwheel.description.launches.launch_use import LaunchUse, only_loaded
from cartwheel.description.launches.mistakes.unexpanded import not_expanded
from cartwheel.description.launches.python_variables import Place
from cartwheel.description.launches.reading import INCLUDES, facts_of, uses_of
from cartwheel.description.launches.required import about_arguments, stated_by_includers
from cartwheel.description.launches.spawning import Spawn
from cartwheel.description.launches.use import ABSENT, Facts
from cartwheel.errors import DescriptionError, Diagnostic, Origin
from cartwheel.options import PACKAGE_PATH, WORLD
from cartwheel.similar_names import meant, suggestion

T = TypeVar("T")
_WHY = "because launch files are read, but not executed"
_SHOWN = 4
"""Maximum number of missing files and packages in a hint."""
_MOST_TRIED = 16
"""Maximum number of expressions whose other value is tried."""
_ENDS = (".launch", ".launch.xml", ".py")
_PARTS = {
    "place": "a part of the pose",
    "name": "the name",
    "namespace": "the namespace",
    "joints": "the position of a joint",
}
"""What may be unknown of a model."""


@dataclass(frozen=True, kw_only=True, slots=True)
class LaunchedModel:
    """A model that a launch file spawns."""

    description: Path
    use: LaunchUse
    """The arguments of the description, and the controllers that the launch file starts."""
    spawn: Spawn
    """Its name and place."""
    is_shown: bool = False
    """Whether it is only published, and not spawned. The world may contain it."""


@dataclass(frozen=True, kw_only=True, slots=True)
class LaunchStart:
    """What a launch file starts."""

    file: Path
    models: tuple[LaunchedModel, ...]
    """None if it starts only a world. Those that are only published are the last."""
    world: str
    """The world as the launch file states it; empty if it states none or an unknown one."""
    bridges: tuple[Path, ...]
    """Configuration files of ros_gz_bridge."""
    renamed: tuple[RenamedTopic, ...]
    """Topics that the arguments and remappings of ros_gz_bridge rename."""
    diagnostics: tuple[Diagnostic, ...]
    """Arguments without an effect, and what only the execution of the launch file determines."""


def is_launch_file(path: Path) -> bool:
    """Whether an existing file is a launch file in XML or Python."""
    if not is_file(path):
        return False
    if path.name.endswith(_ENDS):
        return True
    root = xml.readable_file(path) if path.suffix == ".xml" else None
    return root is not None and root.tag == "launch"


def read_launch(
    file: Path, arguments: Mapping[str, str], package_path: Sequence[Path] = ()
) -> LaunchStart:
    """Reads what a launch file starts, without executing it.

    Args:
        file: The launch file.
        arguments: Its arguments.
        package_path: Folders to search for packages first.

    Raises:
        DescriptionError: The file does not exist or is no launch file, or its models cannot be
            determined.
    """
    if not is_launch_file(file):
        missing = not is_file(file)
        raise DescriptionError(
            "the file does not exist" if missing else "the file is not a launch file",
            code=codes.FILE_MISSING if missing else codes.NOT_A_DESCRIPTION,
            origin=Origin(file=shown_path(file)),
            values={"kind": "file", "name": str(file), "meant": ""},
            hint="" if missing else "Its name must end in .launch, .launch.xml or .py.",
        )
    effort = Effort()
    packages = Packages(file, package_path)
    read = functools.partial(facts_of, file, packages, arguments, effort)
    try:
        facts = read()
        lacking = [name for path, name in facts.required if path == file]
        stated = stated_by_includers(file, lacking, effort, package_path) if lacking else {}
        if stated:
            arguments = {**stated, **arguments}
            read = functools.partial(facts_of, file, packages, arguments, effort)
            facts = read()
        models, lost = _models(file, facts)
    except TooCostlyError:
        raise _failure(file, "reading the launch file takes too long") from None
    if not models and not _starts_world(facts):
        required = sorted(facts.declared - {*facts.defaults, *arguments})
        named = f"Its arguments: {', '.join(sorted(facts.declared))}. " if facts.declared else ""
        named += f"Without a value: {', '.join(required)}. " if required else ""
        named += _not_found(facts)
        reason = "the launch file names no description that exists"
        origins = [origin for (path, _), origin in facts.required.items() if path == file]
        if required and origins:
            listed = " and ".join(f'"{name}"' for name in required)
            reason += f" without a value for {listed}"
            named = f"Pass {' '.join(f'{name}:=VALUE' for name in required)}. {named}"
        raise _failure(file, reason, named, origins[0] if origins else None)
    world = facts.world
    if not world and file.suffix == ".py":
        # Included launch files inherit the arguments, such as `world` of gazebo.launch.py.
        world = arguments.get("world", facts.defaults.get("world", ""))
    world = facts.found_world(world)
    return LaunchStart(
        file=file,
        models=models,
        world="" if UNKNOWN in world else world,
        bridges=tuple(facts.bridges),
        renamed=tuple(facts.renamed),
        diagnostics=(
            *_unused(file, arguments, facts),
            *about_arguments(file, facts, stated),
            *_unknown(file, world, [each for each in models if not each.is_shown] or models, facts),
            *_undecided(file, facts, models, read),
            *itertools.chain(*(not_expanded(each.use) for each in models)),
            *_not_spawned(file, lost, facts),
            *facts.assumed.values(),
            *(replace(each, origin=Origin(file=shown_path(file))) for each in packages.moves()),
        ),
    )


def _starts_world(facts: Facts) -> bool:
    """Whether a launch file starts Gazebo with a known world and without any other model."""
    known = UNKNOWN not in facts.world if facts.world else not facts.absent
    return facts.simulated and known and not facts.spawns and not facts.published


def _models(file: Path, facts: Facts) -> tuple[tuple[LaunchedModel, ...], list[Spawn]]:
    """The models that a launch file spawns or publishes, and those without a description."""
    uses = [each for each in uses_of(file, facts) if each.description is not None]
    found = list(_described(facts, uses))
    models = tuple(
        LaunchedModel(description=use.description, use=use, spawn=spawn, is_shown=not facts.spawns)
        for spawn, use in found
        if use is not None and use.description is not None
    )
    models += tuple(_shown(facts, uses, models))
    lost = [spawn for spawn, use in found if use is None]
    return _with_own_controllers(models, facts), lost


def _undecided(
    file: Path,
    facts: Facts,
    models: tuple[LaunchedModel, ...],
    read: Callable[[Collection[Place]], Facts],
) -> Iterator[Diagnostic]:
    """The conditional expressions with an unknown condition that decide what is started.

    The launch file is read again with the other value of each, to compare what it starts.

    Args:
        file: The launch file.
        facts: Its contents.
        models: What it starts.
        read: Reads it with the other values of some expressions.
    """
    for place, used in itertools.islice(facts.conditionals.items(), _MOST_TRIED):
        try:
            other = read([place])
            same = (other.world, _models(file, other)[0]) == (facts.world, models)
        except TooCostlyError:
            return
        if not same:
            yield _lost(
                place.file,
                f"which value the conditional expression has is unknown, {_WHY}; that before "
                f'"if" in line {used} is used',
                what="expression",
                line=place.line,
                used=str(used),
            )


def _unknown(
    file: Path, world: str, models: Sequence[LaunchedModel], facts: Facts
) -> Iterator[Diagnostic]:
    """What only the execution of a launch file determines."""
    if UNKNOWN in world:
        yield _lost(
            file,
            f"the world is unknown, {_WHY}",
            f"Pass a world: {WORLD.given('FILE')}.",
            what="world",
        )
    count = max((each.use.unknown for each in models), default=0)
    if count:
        yield _lost(
            file,
            f"the values of {count} xacro argument{'s' * (count > 1)} are unknown, {_WHY}; the "
            "defaults are used",
            what="arguments",
        )
    for what, text in _PARTS.items():
        if any(what in each.spawn.unknown for each in models):
            yield _lost(file, f"{text} of a model is unknown, {_WHY}", what=what)
    for (path, line, name), each in facts.uncertain.items():
        if each.what == "text":
            reason = f'what line {each.used} replaces in the text of "{name}" is kept, {_WHY}'
        else:
            owner = f'the variable "{name}" has'
            if each.what == "return":
                owner = f'the function "{name}" returns'
            reason = f"which value {owner} is unknown, {_WHY}; that in line {each.used} is used"
        yield _lost(
            path,
            reason,
            what=each.what,
            line=line,
            name=name,
            used=str(each.used),
        )
    if facts.count > INCLUDES:
        text = f"the launch file includes more than {INCLUDES} files, so not all are read"
        yield _lost(file, text, what="launch file")
    for name in facts.lost_bridges:
        yield _lost(
            file,
            f'the configuration file "{name}" of ros_gz_bridge was not found, so the topics in it '
            "are not renamed",
            what="bridge",
            name=name,
        )


def _not_spawned(file: Path, lost: Sequence[Spawn], facts: Facts) -> Iterator[Diagnostic]:
    for spawn in lost:
        shown = f'"{spawn.name}"' if spawn.name else "a model"
        yield _lost(
            file,
            f"{shown} is not spawned, because its description is unknown or does not exist",
            _not_found(facts).strip(),
            what="model",
            name=spawn.name,
        )


def _not_found(facts: Facts) -> str:
    """What was not found, as a hint; empty if nothing is missing."""
    if not facts.absent:
        return ""
    shown = "; ".join(itertools.islice(facts.absent, _SHOWN))
    advice = ""
    if any(each.startswith("package") for each in facts.absent):
        advice = f"Pass the folders of packages: {PACKAGE_PATH.given('FOLDER')}. "
    return f"Not found: {shown}. {advice}"


def _lost(file: Path, text: str, hint: str = "", *, line: int = 0, **values: str) -> Diagnostic:
    return codes.LAUNCH_VALUE_UNKNOWN.diagnostic(
        text,
        origin=Origin(file=shown_path(file), line=line),
        hint=hint,
        values=values,
    )


def _described(facts: Facts, uses: Sequence[LaunchUse]) -> Iterator[tuple[Spawn, LaunchUse | None]]:
    """The spawned models with their descriptions; without any, the model that is only shown."""
    own = {each.described for each in facts.spawns}
    others = [number for number in range(len(uses)) if number not in own] or [*range(len(uses))]
    for spawn in facts.spawns or ([Spawn()] if uses else []):
        number = spawn.described
        if number is None and spawn.file is None and not spawn.model and others:
            number = facts.published.get(spawn.source, others[0])
        yield spawn, None if number is None or number == ABSENT else uses[number]


def _shown(
    facts: Facts, uses: Sequence[LaunchUse], models: Sequence[LaunchedModel]
) -> Iterator[LaunchedModel]:
    """The models that are published and that no spawner spawns: the world may contain them."""
    known = [each.use for each in models]
    for source, number in facts.published.items():
        use = None if number == ABSENT else uses[number]
        if use is not None and use.description is not None and use not in known:
            known.append(use)
            yield LaunchedModel(
                description=use.description, use=use, spawn=Spawn(source=source), is_shown=True
            )


def _with_own_controllers(
    models: tuple[LaunchedModel, ...], facts: Facts
) -> tuple[LaunchedModel, ...]:
    """Several models, each with the controllers in its namespace, if there are any there.

    The namespace of a model is that of its spawner or of its description's topic, its name, or an
    argument of its description.
    """
    if len(models) < 2:
        return models
    spaces = [
        {
            each.spawn.namespace,
            each.spawn.source.rpartition("/")[0],
            each.spawn.name,
            *(value.strip("/") for value in each.use.arguments.values()),
        }
        - {""}
        for each in models
    ]
    every = [*itertools.chain(*spaces)]
    made = []
    for each, mine in zip(models, spaces, strict=True):
        spawned = tuple(_own(mine, every, facts.spawned))
        use = replace(
            each.use,
            controllers=tuple(_own(mine, every, facts.yamls)),
            spawned=spawned,
            loaded=only_loaded(_own(mine, every, facts.loaded), spawned),
            node_arguments=tuple(_own(mine, every, facts.arguments)),
        )
        made.append(replace(each, use=use))
    return tuple(made)


def _own(mine: Collection[str], every: Sequence[str], given: Sequence[tuple[str, T]]) -> list[T]:
    """What is in a model's namespaces; otherwise, what is in those of no or of several models."""
    own = dict.fromkeys(
        value for space, value in given if space in mine and every.count(space) == 1
    )
    others = dict.fromkeys(value for space, value in given if every.count(space) != 1)
    return list(own or others or dict.fromkeys(value for _, value in given))


def _unused(file: Path, arguments: Mapping[str, str], facts: Facts) -> list[Diagnostic]:
    return [
        codes.ARGUMENT_UNKNOWN.diagnostic(
            f'the argument "{name}" has no effect: the launch file does not declare it',
            origin=Origin(file=shown_path(file)),
            values={"name": name, "meant": meant(name, facts.declared)},
            hint=suggestion(name, sorted(facts.declared)),
        )
        for name in arguments
        if name not in facts.declared
    ]


def _failure(
    file: Path, reason: str, named: str = "", origin: Origin | None = None
) -> DescriptionError:
    try:
        line = 1 if file.suffix == ".py" else xml.read_file(file).origin.line
    except DescriptionError as error:
        return error
    if file.suffix == ".py":
        try:
            ast.parse(read_regular_text(file).removeprefix("\ufeff"))
        except (OSError, SyntaxError, ValueError, RecursionError, MemoryError) as error:
            line = getattr(error, "lineno", None) or line
            reason = f"the file is not Python: {getattr(error, 'msg', error)}"
    return DescriptionError(
        reason,
        code=codes.NOT_A_DESCRIPTION,
        origin=origin or Origin(file=shown_path(file), line=line),
        hint=f"Launch files are read, but not executed. {named}Pass the description that it loads.",
    )
