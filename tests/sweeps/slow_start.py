"""A module that takes longer to import than its job may take, such as one that imports torch."""

import multiprocessing
import time
from collections.abc import Callable

STARTING = 4.0
"""s."""

if multiprocessing.parent_process() is not None:
    time.sleep(STARTING)


def prepare(number: int) -> Callable[[int], int]:
    return double


def double(value: int) -> int:
    return 2 * value


def lost(value: int, reason: str) -> int:
    raise AssertionError(f"{value}: {reason}")
