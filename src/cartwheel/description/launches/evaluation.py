"""The values of expressions in launch files, which are evaluated without access to Python."""

from __future__ import annotations

import time
from collections.abc import Mapping
from typing import Any

from cartwheel.description.expressions import BUILTINS, MATH, Budget, Evaluator
from cartwheel.description.launches.use import LONGEST, UNKNOWN, Spent

_SECONDS = 0.2
"""Maximum CPU time of an expression, s."""
_TOTAL = 2.0
"""Maximum CPU time of all expressions, s; one takes less than a millisecond."""


class _NoTable:
    """xacro's tables of names do not exist here."""


def evaluated(text: str, names: Mapping[str, Any], spent: Spent) -> str:
    """The value of an expression as text; `UNKNOWN` if it has none.

    Args:
        text: A Python expression.
        names: Values and functions that it may use beside Python's own and those of `math`.
        spent: The time of earlier expressions, to which this one is added.
    """
    if UNKNOWN in text or spent.seconds >= _TOTAL:
        return UNKNOWN
    began = time.thread_time()
    evaluator = Evaluator(Budget(_SECONDS), namespace=_NoTable, dotted=_NoTable)
    try:
        value = str(evaluator.evaluate(text, {**BUILTINS, **MATH, **names}))
    except Exception:  # noqa: BLE001 - whatever the operation of a stranger raises
        return UNKNOWN
    finally:
        spent.seconds += time.thread_time() - began
    return value if len(value) <= LONGEST else UNKNOWN
