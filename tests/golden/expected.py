"""What each robot of this repository does in one second: numbers that hold on every processor."""

from __future__ import annotations

import json
from collections import Counter
from typing import Any

from .adapter import CartwheelError, World, controller_files, load_robot, run_with
from .commanding import PERIOD, Commands
from .subjects import HERE, Subject, repository_subjects
from .trial import Ears, state

FILE = HERE / "expected.json"
SECONDS = 1.0
_PORT_TAKEN = "CW840"
"""Another program, such as another test, may have the port of a flight controller."""
_QUICKER = 5.0
"""The commands of five seconds are given within one."""
_DIGITS = 5
_LARGE = ("willowgarage", "rubble", "shapes")
"""Worlds that take seconds to build, which the tests of worlds load as well."""


def subjects() -> list[Subject]:
    """The robots and worlds that the test looks at."""
    return [
        each
        for each in repository_subjects()
        if not any(name in each.key for name in _LARGE)
        and not each.key.endswith(("with the cart", "-switched.urdf", "-switched.world"))
    ]


def brief(subject: Subject) -> dict[str, Any]:
    """Poses, joint positions, message counts, and diagnostics by code."""
    with World(subject.world or "empty", lenient=True) as world:
        if subject.robot is not None:
            robot = load_robot(subject.robot)
            taken = robot.name in world.models
            world.spawn(
                robot,
                name=f"{robot.name}_tried" if taken else None,
                z=0.2,
                controllers=controller_files(robot),
            )
        ears, commands = Ears(world, images=1, summed=False), Commands(world)
        error = ""
        try:
            times = [step * PERIOD for step in range(round(SECONDS / PERIOD))]
            run_with(world, times, lambda time: commands.give(time * _QUICKER), ears.listen)
        except CartwheelError as failed:
            error = failed.code.number
        now = state(world)
        codes = Counter(each.code.number for each in world.diagnostics)
        codes.pop(_PORT_TAKEN, None)
        return {
            "error": error,
            "models": {name: _rounded(pose) for name, pose in now["models"].items()},
            "joints": {name: _rounded(each["position"]) for name, each in now["joints"].items()},
            "counts": {name: each.get("count", -1) for name, each in ears.heard().items()},
            "services": sorted(each.name for each in world.graph.services()),
            "actions": sorted(each.name for each in world.graph.actions()),
            "diagnostics": dict(sorted(codes.items())),
            "refused": sorted(each["code"] for each in commands.refused),
            "faults": [each.message for each in world.diagnostics if each.details],
        }


def write() -> None:
    """Writes the file that the test compares with."""
    lines = [f" {json.dumps(each.key)}: {json.dumps(brief(each))}" for each in subjects()]
    FILE.write_text("{\n" + ",\n".join(lines) + "\n}\n")


def _rounded(values: dict[str, list[Any]]) -> list[float]:
    return [round(value, _DIGITS) + 0.0 for value in values["decimal"]]
