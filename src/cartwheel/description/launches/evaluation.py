"""The values of expressions in launch files, which are evaluated without access to Python."""

from __future__ import annotations

import time
from collections.abc import Mapping
from typing import Any

from cartwheel.description.expressions import BUILTINS, MATH, Budget, Evaluator
from cartwheel.description.launches.effort import UNKNOWN, Effort, TooCostlyError, limited

_SECONDS = 0.2
"""Maximum CPU time of an expression, s."""


class _NoTable:
    """xacro's tables of names do not exist here."""


def evaluated(text: str, names: Mapping[str, Any], effort: Effort) -> str:
    """The value of an expression as text; `UNKNOWN` if it has none.

    Args:
        text: A Python expression.
        names: Values and functions that it may use beside Python's own and those of `math`.
        effort: The remaining effort.

    Raises:
        TooCostlyError: All expressions together took too long.
    """
    if UNKNOWN in text:
        return UNKNOWN
    begin = time.thread_time()
    evaluator = Evaluator(Budget(_SECONDS), namespace=_NoTable, dotted=_NoTable)
    try:
        value = limited(str(evaluator.evaluate(text, {**BUILTINS, **MATH, **names})))
    except TooCostlyError:
        raise
    except Exception:  # noqa: BLE001 - whatever an untrusted operation raises
        value = UNKNOWN
    effort.spend_seconds(time.thread_time() - begin)
    return value
