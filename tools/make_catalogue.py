"""Writes src/cartwheel/dialects/generated.py: the modules that define plugins and controllers.

Usage: python tools/make_catalogue.py [--check]
"""

from __future__ import annotations

import importlib
import pkgutil
import sys
from collections.abc import Iterator
from pathlib import Path

import cartwheel.dialects
from cartwheel.dialects.catalogue import short_name
from cartwheel.dialects.plugin import Plugin
from cartwheel.dialects.ros_control.controller import Controller

TARGET = Path(cartwheel.dialects.__file__).with_name("generated.py")
HEAD = '''# ruff: noqa: E501
"""The modules that define plugins and controllers. Written by `make catalogue`; do not edit.

A module is imported only when a model uses it: importing all of them takes as long as the rest of
the startup.
"""
'''
TABLES = {
    "PLUGINS": "The module in this package that defines a plugin, by the plugin's short name.",
    "SENSORS": "The module of the plugin for sensors without a ``<plugin>``, by sensor type.",
    "CONTROLLERS": "The module that defines a controller, by the controller's type.",
}


def classes(base: type) -> Iterator[tuple[str, type]]:
    """Yields the subclasses of a class that the modules of the package define."""
    package = cartwheel.dialects
    prefix = f"{package.__name__}."
    for module in pkgutil.walk_packages(package.__path__, prefix):
        for each in vars(importlib.import_module(module.name)).values():
            if isinstance(each, type) and issubclass(each, base) and each.__module__ == module.name:
                yield module.name.removeprefix(prefix), each


def tables() -> dict[str, dict[str, str]]:
    """Collects the names that each class lists.

    Raises:
        SystemExit: Two classes list the same name.
    """
    made: dict[str, dict[str, str]] = {name: {} for name in TABLES}

    def add(table: str, name: str, module: str) -> None:
        if made[table].setdefault(name, module) != module:
            sys.exit(f'"{name}" is defined in {made[table][name]} and in {module}')

    for module, each in classes(Plugin):
        for filename in vars(each).get("filenames", ()):
            add("PLUGINS", short_name(filename), module)
        for kind in vars(each).get("serves", ()):
            add("SENSORS", kind, module)
    for module, each in classes(Controller):
        for kind in vars(each).get("types", ()):
            add("CONTROLLERS", kind, module)
    return made


def text() -> str:
    """Returns the contents of the generated file."""
    lines = [HEAD]
    for table, entries in tables().items():
        lines += [f"{table} = {{", *(f'    "{key}": "{entries[key]}",' for key in sorted(entries))]
        lines += ["}", f'"""{TABLES[table]}"""']
    return "\n".join(lines) + "\n"


def main() -> int:
    wanted = text()
    if "--check" in sys.argv[1:]:
        if TARGET.read_text() != wanted:
            print(f"{TARGET} is out of date: run `make catalogue`", file=sys.stderr)
            return 1
        return 0
    TARGET.write_text(wanted)
    return 0


if __name__ == "__main__":
    sys.exit(main())
