"""Numbers in texts, which are most of a COLLADA or OBJ file."""

from __future__ import annotations

import functools
import warnings
from typing import Any

import numpy as np
from numpy.typing import NDArray


def floats_of(text: str | bytes) -> NDArray[np.float64]:
    """The numbers in a text, separated by whitespace.

    Raises:
        ValueError: A word is not a number.
    """
    return _parsed(text, np.float64)


def integers_of(text: str | bytes) -> NDArray[np.int64]:
    """The integers in a text, separated by whitespace. The largest stands for any above it.

    Raises:
        ValueError: A word is not an integer.
    """
    return _parsed(text, np.int64)


def _parsed(text: str | bytes, kind: type[np.float64] | type[np.int64]) -> NDArray[Any]:
    if not text.strip():
        return np.zeros(0, dtype=kind)
    if _is_strict():
        try:
            return np.fromstring(text, dtype=kind, sep=" ")
        except ValueError:
            pass  # a word that only Python reads as a number, or an error, which names the word
    words = text.split()
    return np.array(words, dtype="S" if isinstance(text, bytes) else None).astype(kind)


@functools.cache
def _is_strict() -> bool:
    """Whether numpy rejects a word that is not a number; older versions end there."""
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            np.fromstring("x", sep=" ")
    except ValueError:
        return True
    return False
