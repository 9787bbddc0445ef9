"""Unique model names."""

from __future__ import annotations

import itertools
from collections.abc import Collection

from cartwheel.codes import world as world_codes
from cartwheel.errors import WorldError


def free_name(name: str, taken: Collection[str]) -> str:
    """`name`, with the lowest number appended that makes it unique if it is in use."""
    if name not in taken:
        return name
    return next(numbered for i in itertools.count(1) if (numbered := f"{name}_{i}") not in taken)


def check_model_name(name: str) -> None:
    """Checks the name of a model.

    Raises:
        WorldError: It is empty, or contains "::" or a surrogate, which is half a character.
    """
    shown = name.encode(errors="backslashreplace").decode()
    if not name or "::" in name or shown != name:
        raise WorldError(
            f'the name of a model must not be empty or contain "::" or surrogates (got "{shown}")',
            code=world_codes.MODEL_NAME_INVALID,
            values={"name": shown},
        )
