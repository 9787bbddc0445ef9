"""Errors about files, packages and models that do not exist."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from cartwheel.codes import files as codes
from cartwheel.description.elements import numbers
from cartwheel.description.files.missing_packages import Advice
from cartwheel.description.files.package_search import listed
from cartwheel.errors import DescriptionError, Origin


def missing(
    kind: str, name: str, message: str, origin: Origin | None, advice: Advice
) -> DescriptionError:
    """The error for a file, package or model that does not exist.

    Args:
        kind: What it is.
        name: The name in the file.
        message: The error's message.
        origin: The element with the name.
        advice: What to do.
    """
    return DescriptionError(
        message,
        code=codes.FILE_MISSING,
        origin=origin,
        hint=advice.hint,
        values={"kind": kind, "name": name, "meant": advice.meant},
    )


def advice_about(candidates: Sequence[Path]) -> Advice:
    """The likely file name, and a hint with the searched locations."""
    for path in candidates:
        try:
            names = [
                entry.name for _, entry in zip(range(2000), path.parent.iterdir(), strict=False)
            ]
        except (OSError, ValueError):
            continue
        near = numbers.likely(path.name, names)
        if near:
            return Advice(near, f'Did you mean "{near}"? Searched: {listed(candidates)}.')
    return Advice("", f"Searched: {listed(candidates)}.")
