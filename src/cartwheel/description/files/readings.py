"""What was read of files for robots, for further simulations of the same robots."""

from __future__ import annotations

import copy
from collections.abc import Callable, Hashable
from typing import Any, TypeVar

from cartwheel.description.model import RobotDescription

T = TypeVar("T")


class Readings:
    """Stores results of reading files, such as the contents of controller files.

    It can be pickled together with the descriptions of the robots. Simulations in several threads
    can use it once it is `complete`.
    """

    def __init__(self) -> None:
        self._known: list[tuple[RobotDescription, Hashable, Any]] = []
        self.complete = False
        """Whether further results are not stored."""

    def of(self, robot: RobotDescription, question: Hashable, read: Callable[[], T]) -> T:
        """Returns a copy of the stored result, or reads it.

        Args:
            robot: The robot, which is recognised by its identity.
            question: What is read; it can be pickled.
            read: Reads the files.
        """
        for known, asked, result in self._known:
            if known is robot and asked == question:
                stored: T = copy.deepcopy(result)
                return stored
        found = read()
        if not self.complete:
            self._known.append((robot, question, copy.deepcopy(found)))
        return found
