"""``$(arg …)``, ``$(var …)``, ``$(find …)`` and the like in parameter files.

Launch files replace them where they load a file; here the robot's own arguments count.
"""

from __future__ import annotations

import os
import re
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from cartwheel import yaml_text
from cartwheel.codes import devices
from cartwheel.description.packages import Packages
from cartwheel.errors import CartwheelError, Origin, PluginError

_CALL = re.compile(r"\$\(\s*([\w-]+)((?:\s[^()]*)?)\)")


def substitute(content: Any, path: Path, arguments: Mapping[str, str]) -> Any:
    """A file's content with everything replaced; what a replaced text then says is YAML.

    Args:
        content: As read.
        path: Of the file; packages are looked for around it.
        arguments: The robot's, by name.

    Raises:
        PluginError: An argument, a variable or a package does not exist.
    """
    packages: list[Packages] = []

    def find(name: str) -> str:
        if not packages:
            packages.append(Packages(path))
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
                f"{match[0]} has no value because the robot has no argument with this name",
                code=devices.CONTROLLERS_FILE_ARGUMENT,
                origin=Origin(file=str(path)),
                hint=f"Write the value into the file, or pass it with {name}:=…."
                if not arguments
                else f"Arguments: {', '.join(sorted(arguments))}.",
                values={"name": name},
            )
        raise PluginError(
            f"{match[0]} cannot be evaluated",
            code=devices.CONTROLLERS_FILE_ARGUMENT,
            origin=Origin(file=str(path)),
            values={"name": match[0]},
        )

    def text(found: str) -> str:
        try:
            return _CALL.sub(value, found)
        except PluginError:
            raise
        except CartwheelError as error:
            raise PluginError(
                error.message,
                code=devices.CONTROLLERS_FILE_ARGUMENT,
                origin=Origin(file=str(path)),
                hint=error.hint,
                values=error.values,
            ) from None

    def walk(found: Any) -> Any:
        if isinstance(found, Mapping):
            return {
                text(key) if isinstance(key, str) else key: walk(each)
                for key, each in found.items()
            }
        if isinstance(found, list):
            return [walk(each) for each in found]
        if isinstance(found, str) and _CALL.search(found):
            return _parsed(text(found))
        return found

    return walk(content)


def _parsed(text: str) -> Any:
    """A number or a truth where the text is one."""
    import yaml

    try:
        made = yaml_text.load(text)
    except yaml.YAMLError:
        return text
    return made if isinstance(made, bool | int | float) else text
