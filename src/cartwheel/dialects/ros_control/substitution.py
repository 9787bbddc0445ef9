"""Substitutions in parameter files, such as ``$(arg …)``, ``$(var …)`` and ``$(find …)``.

Launch files evaluate them when they load a file. Here they are evaluated with the robot's own
arguments.
"""

from __future__ import annotations

import os
import re
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from cartwheel import yaml_text
from cartwheel.codes import devices
from cartwheel.description.elements.xml import shown_path
from cartwheel.description.files.packages import Packages
from cartwheel.description.rewritten import original
from cartwheel.errors import CartwheelError, Origin, PluginError
from cartwheel.options import xacro_argument

_CALL = re.compile(r"\$\(\s*([\w-]+)((?:\s[^()]*)?)\)")


def substitute(content: Any, path: Path, arguments: Mapping[str, str]) -> Any:
    """Replaces all substitutions in a file. A string with a substitution is then read as YAML.

    Args:
        content: Content of the file.
        path: The file, from which packages are searched.
        arguments: Arguments of the robot, by name.

    Raises:
        PluginError: An argument, a variable or a package does not exist.
    """
    packages: list[Packages] = []

    def find(name: str) -> str:
        if not packages:
            packages.append(Packages(original(path)))
        return str(packages[0].find(name))

    def value(match: re.Match[str]) -> str:
        command, words = match[1], match[2].split()
        name = words[0] if words else ""
        if command in ("arg", "var") and name in arguments:
            return arguments[name]
        if command in ("find", "find-pkg-share") and name:
            return find(name)
        if command in ("env", "optenv") and name in os.environ:
            return os.environ[name]
        if command == "optenv" or (command == "env" and len(words) > 1):
            return " ".join(words[1:])
        if command in ("arg", "var"):
            raise PluginError(
                f"{match[0]} has no value because the description has no argument of this name",
                code=devices.CONTROLLERS_FILE_ARGUMENT,
                origin=Origin(file=shown_path(path)),
                hint=f"Write the value into the file, or pass {xacro_argument(name)}."
                if not arguments
                else f"Arguments of the robot: {', '.join(sorted(arguments))}.",
                values={"name": name},
            )
        raise PluginError(
            f"{match[0]} cannot be evaluated",
            code=devices.CONTROLLERS_FILE_ARGUMENT,
            origin=Origin(file=shown_path(path)),
            hint="Write the value into the file.",
            values={"name": match[0]},
        )

    def text(template: str) -> str:
        try:
            return _CALL.sub(value, template)
        except PluginError:
            raise
        except CartwheelError as error:
            raise PluginError(
                error.message,
                code=devices.CONTROLLERS_FILE_ARGUMENT,
                origin=Origin(file=shown_path(path)),
                hint=error.hint,
                values=error.values,
            ) from None

    def walk(node: Any) -> Any:
        if isinstance(node, Mapping):
            return {
                text(key) if isinstance(key, str) else key: walk(each) for key, each in node.items()
            }
        if isinstance(node, list):
            return [walk(each) for each in node]
        if isinstance(node, str) and _CALL.search(node):
            return _parsed(text(node))
        return node

    return walk(content)


def _parsed(text: str) -> Any:
    """Returns a number or boolean if the text is one, otherwise the text."""
    import yaml

    try:
        parsed = yaml_text.load(text)
    except yaml.YAMLError:
        return text
    return parsed if isinstance(parsed, bool | int | float) else text
