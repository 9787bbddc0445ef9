"""Project settings: ``[tool.cartwheel.check]`` in pyproject.toml, or cartwheel.toml."""

from __future__ import annotations

import tomllib
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from cartwheel.codes import command
from cartwheel.description.files.regular_files import read_regular_text
from cartwheel.errors import CartwheelError, Origin
from cartwheel.similar_names import meant

_MAX_BYTES = 1_000_000
_LISTS = ("select", "ignore")
_KNOWN = (*_LISTS, "strict", "baseline")


@dataclass(frozen=True, kw_only=True, slots=True)
class Settings:
    """The settings of a project; command-line options take precedence."""

    select: tuple[str, ...] = ()
    ignore: tuple[str, ...] = ()
    strict: bool = False
    baseline: Path | None = None
    file: Path | None = None
    """The settings file; None for the defaults."""


def settings_for(path: Path) -> Settings:
    """The settings in the nearest folder that has some, at or above the path.

    In each folder, the table ``check`` in ``cartwheel.toml`` takes precedence over
    ``pyproject.toml``.

    Raises:
        CartwheelError: A settings file cannot be read, or has an unknown or invalid entry.
    """
    start = path.absolute()
    folders = [start, *start.parents] if start.is_dir() else list(start.parents)
    for folder in folders:
        for name, keys in (
            ("cartwheel.toml", ("check",)),
            ("pyproject.toml", ("tool", "cartwheel", "check")),
        ):
            file = folder / name
            if file.is_file():
                table = _table(file, keys)
                if table is not None:
                    return _settings(file, table)
    return Settings()


def _table(file: Path, keys: tuple[str, ...]) -> Any:
    try:
        value: Any = tomllib.loads(read_regular_text(file, _MAX_BYTES))
    except (OSError, ValueError) as error:
        raise _invalid(file, f"the settings cannot be read: {error}") from error
    for key in keys:
        value = value.get(key) if isinstance(value, dict) else None
    return value


def _settings(file: Path, table: Any) -> Settings:
    if not isinstance(table, dict):
        raise _invalid(file, "the check settings must be a table")
    for key, value in table.items():
        if key not in _KNOWN:
            near = meant(key, _KNOWN)
            hint = f'Did you mean "{near}"?' if near else f"Valid settings: {', '.join(_KNOWN)}."
            raise _invalid(file, f'the setting "{key}" does not exist', hint, setting=key)
        if key in _LISTS and not (
            isinstance(value, list) and all(isinstance(each, str) for each in value)
        ):
            raise _invalid(file, f'"{key}" must be a list of codes', setting=key)
        if key == "strict" and not isinstance(value, bool):
            raise _invalid(file, '"strict" must be true or false', setting=key)
        if key == "baseline" and not isinstance(value, str):
            raise _invalid(file, '"baseline" must be the name of a file', setting=key)
    baseline = table.get("baseline")
    return Settings(
        select=tuple(table.get("select", ())),
        ignore=tuple(table.get("ignore", ())),
        strict=table.get("strict", False),
        baseline=file.parent / baseline if baseline else None,
        file=file,
    )


def _invalid(file: Path, message: str, hint: str = "", *, setting: str = "") -> CartwheelError:
    return CartwheelError(
        message,
        code=command.SETTINGS_INVALID,
        origin=Origin(file=str(file)),
        hint=hint,
        values={"setting": setting},
    )
