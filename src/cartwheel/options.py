"""Options in messages, written as the caller of Cartwheel writes them.

The ``cartwheel`` program has options such as ``--record drive.mcap``. In Python, the same option is
a parameter of `cartwheel.World`: ``record="drive.mcap"``. A process has one kind of caller.
"""

from __future__ import annotations

from dataclasses import dataclass
from enum import Enum


class Caller(Enum):
    """Who specifies the options of this process."""

    PYTHON = "python"
    """A Python program, which imports Cartwheel."""
    COMMAND_LINE = "command-line"
    """A user of the ``cartwheel`` program."""


_caller = Caller.PYTHON


def caller() -> Caller:
    """The caller of this process."""
    return _caller


def set_caller(value: Caller) -> None:
    """Sets the caller. A program does so before it creates a message."""
    global _caller
    _caller = value


@dataclass(frozen=True, kw_only=True, slots=True)
class Option:
    """An option of the command line that is also a parameter in Python.

    Args:
        flag: Option of the command line.
        parameter: Parameter of `cartwheel.World` and of its methods.
        method: Method of `cartwheel.World` with the same purpose, whose argument is the value.
    """

    flag: str
    parameter: str
    method: str = ""

    def __str__(self) -> str:
        """The name of the option, as the caller writes it."""
        return self.flag if _caller is Caller.COMMAND_LINE else self.parameter

    def given(self, value: str | int | None = None) -> str:
        """The option with a value, as the caller writes it.

        Args:
            value: None for an option without a value. An int is a port.
        """
        if _caller is Caller.COMMAND_LINE:
            return self.flag if value is None else f"{self.flag} {value}"
        text = f'"{value}"' if isinstance(value, str) else str(True if value is None else value)
        named = f"{self.parameter}={text}"
        return f"{named} or {self.method}({text})" if self.method else named


RECORD = Option(flag="--record", parameter="record")
OVERWRITE = Option(flag="--overwrite", parameter="overwrite")
STRICT = Option(flag="--strict", parameter="strict")
WORLD = Option(flag="--world", parameter="world")
NAME = Option(flag="--model", parameter="name")
HOST = Option(flag="--host", parameter="host")
ALLOW_ORIGIN = Option(flag="--allow-origin", parameter="allow_origin")
ALLOW_PATH = Option(flag="--allow-path", parameter="allow_path")
PACKAGE_PATH = Option(flag="--package-path", parameter="package_path")
RMW = Option(flag="--rmw", parameter="rmw")
FOXGLOVE = Option(flag="--foxglove", parameter="foxglove")
FOXGLOVE_PORT = Option(flag="--foxglove-port", parameter="foxglove", method="serve_foxglove")
WITHOUT = Option(flag="--without", parameter="without")
PLUGIN = Option(flag="--plugin", parameter="plugins")
PORT = Option(flag="--port", parameter="viewer", method="show")


def plugin_file() -> str:
    """How to use a plugin that the caller has written, which is not among those of Cartwheel."""
    return f"If it is a Python plugin for Cartwheel, pass its file: {PLUGIN.given('FILE')}."


def xacro_argument(name: str, value: str = "…") -> str:
    """The value of a xacro argument, as the caller passes it."""
    if _caller is Caller.COMMAND_LINE:
        return f"{name}:={value}"
    return f'arguments={{"{name}": "{value}"}}'
