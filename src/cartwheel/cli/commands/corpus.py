"""A table of robots: loaded, mass, plugins, standing, driving, speed; or the same as JSON."""

from __future__ import annotations

import contextlib
import json as json_module
import math
from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import asdict, replace
from pathlib import Path
from types import MappingProxyType
from typing import Any, NamedTuple

from cartwheel.cli.console import note, paint, say, table
from cartwheel.codes.command import INTERNAL_FAULT, NO_ROBOTS
from cartwheel.codes.files import ARGUMENT_UNKNOWN
from cartwheel.corpus import Fault, Kind, Survey, Verdict, survey, try_robot
from cartwheel.description.elements.xml import shown_path
from cartwheel.description.launches import LaunchUse, launches_near
from cartwheel.description.loading import open_description
from cartwheel.description.rewritten import original
from cartwheel.errors import CartwheelError, Diagnostic

SCHEMA = 2
_NONE = "-"
"""A column without a value."""
_KINDS: dict[Kind, tuple[str, str]] = {
    "macros": ("with macros only", "with macros only"),
    "part": ("part of a robot", "parts of robots"),
    "world": ("world", "worlds"),
    "scenery": (
        "model without plugins, sensors and movable joints",
        "models without plugins, sensors and movable joints",
    ),
    "old version": ("old version of a model", "old versions of models"),
}
"""The singular and plural of each kind."""
_BARE: dict[Kind, str] = {"world": " without robots"}
"""What follows the kind if the folder contains no robot."""
_NOTHING: Mapping[Kind, str] = {}
_OUTCOMES = {"file": "fault in the robot's files", "unknown": "fault for another reason"}
_SIDEWAYS = "sideways"
"""A column that is only printed if a robot can move sideways."""
_HEAD = (
    "robot", "loaded", "mass", "stands", "drives", "turns", _SIDEWAYS, "reaches", "topics", "speed",
    "plugins",
)  # fmt: skip


class _Robot(NamedTuple):
    """What is tested."""

    file: Path
    model: str
    """The name of the model in a world; otherwise empty."""
    launches: Sequence[LaunchUse] | None
    folder: Path | None
    """The folder that was searched; None for a file."""


def corpus(
    folders: Sequence[Path],
    package_path: Sequence[Path],
    *,
    json: bool,
    standing: float,
    arguments: Mapping[str, str] = MappingProxyType({}),
) -> int:
    """Tests all robots. Returns the exit status: 0 if all pass, else 1.

    Args:
        folders: Folders with robots at any depth, or single files.
        package_path: Folders that are searched first for packages.
        json: Print JSON instead of a table.
        standing: Simulated time without commands before the tests, in s.
        arguments: Xacro arguments of the robots that declare them.

    Raises:
        CartwheelError: No robot was found.
    """
    surveys = [_survey(folder, arguments, package_path) for folder in folders]
    robots = [
        _Robot(file, model, launches, folder if folder.is_dir() else None)
        for folder, (found, launches) in zip(folders, surveys, strict=True)
        for file, model in (*((file, "") for file in found.robots), *found.in_worlds)
    ]
    skipped = [each for found, _ in surveys for each in found.skipped]
    verdicts = []
    undeclared = set(arguments)
    for number, robot in enumerate(robots, start=1):
        name = _with_model(shown_path(robot.file), robot.model)
        note(paint(f"{number} of {len(robots)}: {name}", "dim"))
        given = _declared(robot.file, arguments, package_path)
        undeclared -= given.keys()
        verdicts.append(_tried(robot, given, package_path, standing))
    for name in sorted(undeclared):
        note(str(_unused(name)))
    if json:
        result = {
            "schema": SCHEMA,
            "summary": summary(verdicts),
            "robots": [as_mapping(verdict) for verdict in verdicts],
            "skipped": [{"file": str(file), "kind": kind} for file, kind in skipped],
        }
        say(json_module.dumps(result, indent=2))
    else:
        _show(verdicts, folders, skipped)
    return int(not all(verdict.good for verdict in verdicts))


def as_mapping(verdict: Verdict) -> dict[str, Any]:
    """A verdict in the format that docs/corpus.md documents."""
    stand = verdict.stand
    return {
        "file": str(verdict.file),
        "model": verdict.model or None,
        "name": verdict.name,
        "verdict": verdict.outcome,
        "faults": [_fault(each) for each in verdict.faults],
        "should_move": verdict.should_move,
        "moves": verdict.moves,
        "movers": list(verdict.movers),
        "loaded": verdict.loaded,
        "error": verdict.error,
        "mass": _number(verdict.mass),
        "links": verdict.links,
        "missing_meshes": verdict.missing_meshes,
        "plugins": list(verdict.plugins),
        "missing_plugins": list(verdict.missing),
        "controllers": list(verdict.controllers),
        "controller_files": [str(original(path)) for path in verdict.controller_files],
        "launch": verdict.launch
        and {"file": str(verdict.launch.file), "arguments": _arguments(verdict.launch)},
        "stands": stand and {
            "state": stand.state,
            "sunk": stand.sunk,
            "tilt": stand.tilt,
            "speed": stand.speed,
            "turn": stand.turn,
        },
        "topics": verdict.topics,
        "silent_topics": list(verdict.silent),
        "drives": [asdict(each) for each in verdict.drives],
        "spins": [asdict(each) for each in verdict.spins],
        "flights": [asdict(each) for each in verdict.flights],
        "reaches": [
            {
                "controller": each.controller,
                "joint": each.joint,
                "target": each.target,
                "reached": each.reached,
                "sag": each.sag,
            }
            for each in verdict.reaches
        ],
        "speed": _number(verdict.speed),
        "diagnostics": [str(each) for each in (*verdict.diagnostics, *verdict.unread)],
    }  # fmt: skip


def _arguments(use: LaunchUse) -> dict[str, str]:
    """The arguments of a launch file, with the originals of files whose text it changes."""
    return {
        name: str(original(Path(text))) if text.endswith((".yaml", ".yml")) else text
        for name, text in use.arguments.items()
    }


def _fault(fault: Fault) -> dict[str, Any]:
    reason = fault.reason
    return {
        "test": fault.test,
        "subject": fault.subject,
        "source": fault.source,
        "code": None if fault.code is None else fault.code.number,
        "name": None if fault.code is None else fault.code.name,
        "place": None if reason is None or reason.origin is None else str(reason.origin),
        "message": None if reason is None else reason.message,
    }


def summary(verdicts: Sequence[Verdict]) -> dict[str, int]:
    """Numbers of robots."""
    return {
        "robots": len(verdicts),
        "loaded": sum(verdict.loaded for verdict in verdicts),
        "stand": sum(verdict.stands for verdict in verdicts),
        "should_move": sum(verdict.should_move for verdict in verdicts),
        "move": sum(verdict.should_move and verdict.moves for verdict in verdicts),
        **{
            outcome: sum(verdict.outcome == outcome for verdict in verdicts)
            for outcome in ("good", "file", "unknown")
        },
    }


def _declared(
    file: Path, arguments: Mapping[str, str], package_path: Sequence[Path]
) -> dict[str, str]:
    """Those of the user's arguments that a description declares; all if it cannot be read."""
    unknown: set[str] = set()
    if arguments:
        with contextlib.suppress(CartwheelError):
            said = open_description(file, arguments, package_path).diagnostics
            unknown = {str(each.values["name"]) for each in said if each.code is ARGUMENT_UNKNOWN}
    return {name: value for name, value in arguments.items() if name not in unknown}


def _unused(name: str) -> Diagnostic:
    return ARGUMENT_UNKNOWN.diagnostic(
        f'the argument "{name}" has no effect: no robot declares it',
        values={"name": name, "meant": ""},
    )


def _survey(
    folder: Path, arguments: Mapping[str, str], package_path: Sequence[Path]
) -> tuple[Survey, Sequence[LaunchUse] | None]:
    """The robots in a folder, and its launch files; None for a file, whose package has them."""
    if not folder.exists():
        raise CartwheelError(
            f"{folder} does not exist", code=NO_ROBOTS, values={"folder": str(folder)}
        )
    launches = launches_near(folder, package_path) if folder.is_dir() else None
    found = survey(folder, arguments=arguments, package_path=package_path, launches=launches or ())
    if not (found.robots or found.in_worlds):
        raise _no_robots(folder, found.skipped)
    return found, launches


def _no_robots(folder: Path, skipped: Sequence[tuple[Path, Kind]]) -> CartwheelError:
    """The error for a folder or file without robots, which says what it contains instead."""
    kinds = {kind for _, kind in skipped}
    but = f", but {_counted(skipped, after=_BARE)}" if skipped else ""
    hint = "Pass a folder that contains .xacro, .urdf, .sdf or .world files of robots."
    if kinds & {"macros", "part"}:
        hint = "Pass a folder with files that use them."
    elif "world" in kinds:
        hint = "Pass the folders of the models that the worlds include."
    return CartwheelError(
        f"{folder} contains no robot{but or ' description'}",
        code=NO_ROBOTS,
        hint=hint,
        values={"folder": str(folder), "skipped": len(skipped)},
    )


def _counted(skipped: Sequence[tuple[Path, Kind]], after: Mapping[Kind, str] = _NOTHING) -> str:
    """The number of files of each kind that is no robot; `after` follows the kind."""
    counts = Counter(kind for _, kind in skipped)
    return ", ".join(
        f"{count} {_KINDS[kind][count > 1]}{after.get(kind, '')}"
        for kind, count in sorted(counts.items())
    )


def _tried(
    robot: _Robot, arguments: Mapping[str, str], package_path: Sequence[Path], standing: float
) -> Verdict:
    try:
        return try_robot(
            robot.file,
            arguments=arguments,
            package_path=package_path,
            standing=standing,
            launches=robot.launches,
            model=robot.model,
            folder=robot.folder,
        )
    except Exception as error:  # noqa: BLE001 - the other robots are tested anyway
        message = f"internal error: {error!r}"
        reason = INTERNAL_FAULT.diagnostic(message, values={"cause": type(error).__name__})
        return replace(
            Verdict(file=robot.file, model=robot.model),
            error=message,
            faults=(Fault(test="load", reason=reason),),
        )


def _show(
    verdicts: Sequence[Verdict],
    folders: Sequence[Path],
    skipped: Sequence[tuple[Path, Kind]],
) -> None:
    rows = [
        (_with_model(_name(verdict.file, folders), verdict.model), *_row(verdict))
        for verdict in verdicts
    ]
    hidden = _HEAD.index(_SIDEWAYS)
    if all(row[hidden] == _NONE for row in rows):
        rows = [(*row[:hidden], *row[hidden + 1 :]) for row in rows]
        head = tuple(name for name in _HEAD if name != _SIDEWAYS)
    else:
        head = _HEAD
    title, *lines = table([head, *rows]).splitlines()
    say(paint(title, "dim"))
    for line in lines:
        say(line)
    for verdict in verdicts:
        if verdict.faults:
            _show_faults(verdict)
    missing = sorted({name for verdict in verdicts for name in verdict.missing})
    if missing:
        say()
        for name in missing:
            users = sum(name in verdict.missing for verdict in verdicts)
            say(f"missing plugin {name}: {users} robot{'s' if users != 1 else ''}")
    unread = dict.fromkeys(each for verdict in verdicts for each in verdict.unread)
    if unread:
        say()
        for each in unread:
            say(str(each))
    say(f"\n{_summary(verdicts)}")
    if skipped:
        say(f"skipped: {_counted(skipped)}")


def _show_faults(verdict: Verdict) -> None:
    name = _with_model(shown_path(verdict.file), verdict.model)
    say(f"\n{paint(name, 'bold')}: {_OUTCOMES[verdict.outcome]}")
    if verdict.launch is not None and verdict.launch.arguments:
        given = " ".join(f"{key}:={text}" for key, text in _arguments(verdict.launch).items())
        switched = "".join(f" {name}:={value}" for name, value in verdict.launch.switched)
        place = f"{shown_path(verdict.launch.file)}{switched}"
        say(paint(f"  with the arguments in {place}: {given}", "dim"))
    for fault in verdict.faults:
        subject = f" {fault.subject}" if fault.subject else ""
        say(f"  {fault.test}{subject}: {fault.reason or 'unknown reason'}")


def _summary(verdicts: Sequence[Verdict]) -> str:
    counts = summary(verdicts)
    return (
        f"{counts['good']} of {counts['robots']} robots pass all tests; "
        f"{counts['file']} have faults in their files, {counts['unknown']} fail for other reasons\n"
        f"{counts['loaded']} load, {counts['stand']} stand, and {counts['move']} of the "
        f"{counts['should_move']} robots that should move do so as commanded"
    )


def _name(file: Path, folders: Sequence[Path]) -> str:
    """The file relative to the folder, if there is only one; else as in other messages."""
    if len(folders) == 1 and folders[0] in file.parents:
        return str(file.relative_to(folders[0]))
    return shown_path(file)


def _with_model(file: str, model: str) -> str:
    """A file, or a model in a world."""
    return f"{file}: {model}" if model else file


def _row(verdict: Verdict) -> tuple[str, ...]:
    loaded = "yes" if verdict.loaded else "no"
    if verdict.loaded and verdict.missing_meshes:
        meshes = verdict.missing_meshes
        loaded = f"{meshes} mesh{'es' if meshes > 1 else ''} missing"
    stand = verdict.stand
    state = stand.state if stand is not None else _NONE
    if verdict.loaded and verdict.error and stand is None:
        state = "diverges"
    worst = max(verdict.reaches, key=lambda each: abs(each.error), default=None)
    plugins = f"{len(verdict.plugins)} loaded"
    if verdict.missing:
        plugins += f", missing {', '.join(verdict.missing)}"
    return (
        loaded,
        _NONE if math.isnan(verdict.mass) else f"{verdict.mass:.4g} kg",
        state,
        _listed([f"{each.error:+.1%}" for each in verdict.drives]),
        _listed([f"{each.error_turn:+.1%}" for each in verdict.drives]),
        _listed(
            [f"{each.error_sideways:+.1%}" for each in verdict.drives if each.commanded_sideways]
        ),
        _NONE if worst is None else f"{abs(worst.error):.3f} {'rad' if worst.angular else 'm'}",
        f"{verdict.topics - len(verdict.silent)} of {verdict.topics}",
        _NONE if math.isnan(verdict.speed) else f"{verdict.speed:.3g}x",
        plugins,
    )


def _listed(words: Sequence[str]) -> str:
    return ", ".join(words) or _NONE


def _number(value: float) -> float | None:
    return None if math.isnan(value) else value
