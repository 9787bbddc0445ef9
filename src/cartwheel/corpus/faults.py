"""The faults of a robot: failed tests with the diagnostics that explain them."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from typing import Literal

from cartwheel.codes import command, devices, files, running, tags, world
from cartwheel.errors import UNCLASSIFIED, Code, Diagnostic

Test = Literal[
    "load",
    "stand",
    "publish",
    "drive",
    "turn",
    "sideways",
    "reach",
    "spin",
    "fly",
    "plugin",
    "controller",
    "simulate",
]
"""What failed.

- ``load``: the description cannot be loaded, or its launch file does not start; ``simulate``: the
  simulation stopped with an error.
- ``stand``: the robot does not stand; ``publish``: a topic published nothing.
- ``drive``, ``turn``, ``sideways``: a base does not follow its forward, turning or sideways
  commands.
- ``reach``: a joint does not reach its position; ``spin``: it does not follow a velocity or effort.
- ``fly``: an aircraft does not take off.
- ``plugin``: a plugin that should move something is missing; ``controller``: a controller did not
  start, or no controller was found.
"""
MOTION: frozenset[Test] = frozenset(
    {"drive", "turn", "sideways", "reach", "spin", "fly", "plugin", "controller", "simulate"}
)
"""Tests of commanded motion."""
BASES: frozenset[Test] = frozenset({"drive", "turn", "sideways"})
"""Tests of bases, whose errors are relative to the command."""
_OURS = frozenset(
    {
        UNCLASSIFIED,
        command.INTERNAL_FAULT,
        command.SYSTEM_LIMIT,
        devices.PLUGIN_UNKNOWN,
        devices.PLUGIN_PARAMETER_UNSUPPORTED,
        devices.HARDWARE_NOT_SIMULATED,
        devices.CONTROLLER_TYPE_UNKNOWN,
        files.XACRO_NOT_INSTALLED,
        files.EXPANSION_TOO_LARGE,
        files.FILE_ON_NETWORK,
        running.PLUGIN_FAILED,
        tags.NOT_SIMULATED,
        world.SIMULATION_DIVERGED,
        world.MODEL_NOT_BUILT,
        world.PHYSICS_WARNING,
    }
)
"""Codes that do not show that the robot fails in Gazebo as well."""


_DECIDING = frozenset(
    {
        files.FILE_ELSEWHERE,
        devices.CONTROLLER_PARAMETER_TYPE,
        devices.CONTROLLER_UNDEFINED,
        devices.CONTROLLERS_FILE_UNREADABLE,
        devices.HARDWARE_WITHOUT_PLUGIN,
    }
)
"""Codes of mistakes for which controllers do not start, whatever else moves the robot."""


@dataclass(frozen=True, kw_only=True, slots=True)
class Fault:
    """A failed test."""

    test: Test
    subject: str = ""
    """The topic, joint, plugin or controller; empty for the robot."""
    reason: Diagnostic | None = None
    """The diagnostic that explains the failure; None if the cause is unknown."""
    sure: bool = True
    """Whether the reason certainly explains the failure."""

    @property
    def code(self) -> Code | None:
        """The code of the reason."""
        return None if self.reason is None else self.reason.code

    @property
    def source(self) -> Literal["file", "unknown"]:
        """``file`` if the reason is a mistake in the robot's files, and certain."""
        if self.reason is None or not self.sure or self.code in _OURS:
            return "unknown"
        outside = _is_outside(self.reason)
        if outside in ("model", "package") or (outside and self.test == "load"):
            return "unknown"
        if self.reason.values.get("template"):
            # A build makes the file that is missing.
            return "unknown"
        ours = {code.number for code in _OURS}
        return "unknown" if self.reason.values.get("cause") in ours else "file"

    @property
    def decides(self) -> bool:
        """Whether it is a certain mistake in the robot's files, whatever else is unknown.

        What is measured may depend on what is not supported, and so may a plugin or controller that
        Cartwheel does not start.
        """
        if self.source != "file":
            return False
        if self.test == "controller":
            return self.code in _DECIDING
        refused = self.test == "plugin" and self.code is not running.PLUGIN_LEFT_OUT
        return refused or self.test in ("load", "publish")

    @property
    def hides(self) -> bool:
        """Whether it is unknown what else is in the robot's files: a part of them is absent, or
        they could not be read.
        """
        absent = (files.INCLUDE_ABSENT, files.MACRO_ABSENT)
        return self.source == "unknown" and (self.test == "load" or self.code in absent)


def _is_outside(reason: Diagnostic) -> str:
    """What is not among the robot's files, so that it cannot be read, or lacks a part.

    A package with a similar name may be meant, and a file may be missing in a model's folder. A
    package that was not found may also define the unknown name of a property, macro or block.

    Returns:
        ``package``, ``model``, ``argument`` for the value of an argument, or an empty text.
    """
    values = reason.values
    if reason.code is files.XACRO_NAME_UNKNOWN and values.get("unfound"):
        return "package"
    kinds = {files.FILE_MISSING: ("package", "model"), files.XACRO_NAME_UNKNOWN: ("argument",)}
    kind = str(values.get("kind"))
    if kind not in kinds.get(reason.code, ()) or values.get("meant"):
        return ""
    return "" if kind == "model" and "template" in values else kind


def is_lost_model(reason: Diagnostic) -> bool:
    """Whether a model that the robot includes is left out, because its file is not here."""
    return reason.values.get("left_out") == "include" and reason.values.get("kind") == "model"


def most_severe(found: Iterable[Diagnostic]) -> Diagnostic | None:
    """The first of the most severe diagnostics."""
    order = {"error": 0, "warning": 1, "info": 2}
    return min(found, key=lambda each: order[each.severity], default=None)


def coded(found: Iterable[Diagnostic], codes: frozenset[Code]) -> Diagnostic | None:
    """The most severe diagnostic with one of these codes."""
    return most_severe(each for each in found if each.code in codes)
