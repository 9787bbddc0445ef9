"""Scenarios in folders, which may also contain other YAML files, such as those of controllers."""

from __future__ import annotations

import re
from collections.abc import Iterator
from pathlib import Path

from cartwheel import yaml_text
from cartwheel.description.files.source_folders import source_folders
from cartwheel.scenarios.schema import schema

_SUFFIXES = (".yaml", ".yml")
# Blanks, not `\s`: many empty lines would take time by their square.
_EXPECT = re.compile(r"""^[ \t]*["']?expect["']?[ \t]*:""", re.MULTILINE)


def find_scenarios(folder: Path) -> tuple[list[Path], list[Path]]:
    """Searches a folder for scenarios, but not its hidden folders and those of build tools.

    Returns:
        The scenarios, also invalid ones, and the YAML files that are none, both sorted.
    """
    scenarios: list[Path] = []
    others: list[Path] = []
    for file in sorted(_files(folder)):
        (scenarios if _is_scenario(file) else others).append(file)
    return scenarios, others


def _files(folder: Path) -> Iterator[Path]:
    for here, names in source_folders(folder):
        for name in names:
            if name.endswith(_SUFFIXES) and not name.startswith("."):
                yield here / name


def _is_scenario(file: Path) -> bool:
    """Whether a file is meant to be a scenario.

    A scenario whose key ``expect`` is missing or misspelt counts, so that it is reported.
    """
    import yaml

    try:
        text = yaml_text.read(file)
    except (OSError, UnicodeDecodeError):
        return True  # it is not known, so the error is reported
    try:
        root = yaml.compose(text, Loader=yaml_text.loader())
    except yaml.YAMLError:
        return _EXPECT.search(text) is not None
    if not isinstance(root, yaml.MappingNode):
        return False
    keys = {key.value for key, _ in root.value if isinstance(key.value, str)}
    known = set(schema()["properties"])
    return bool(keys) and ("expect" in keys or {"robots", "steps"} <= keys or keys <= known)
