"""Numbers of objects and categories, which stay the same in a dataset."""

from __future__ import annotations

import fnmatch
from collections.abc import Iterable, Mapping
from typing import Literal

from cartwheel.dataset.viewpoint import invalid

Granularity = Literal["models", "links"]


class Labels:
    """Numbers objects and categories from 1, in the order of their first appearance.

    Args:
        objects: Whether a model or each link is an object.
        categories: Categories by patterns of names such as ``brick_*``; the first that matches
            applies. An object without one has a category of its own name. None ignores the object,
            which is then background.

    Raises:
        CartwheelError: `objects` is invalid.
    """

    def __init__(self, objects: Granularity, categories: Mapping[str, str | None]) -> None:
        if objects not in ("models", "links"):
            raise invalid(f'objects must be "models" or "links" (got {objects!r:.60})')
        self._links = objects == "links"
        self._patterns = dict(categories)
        self.objects: dict[str, int] = {}
        """Numbers of objects by name."""
        self.categories: dict[str, int] = {}
        """Numbers of categories by name."""

    def add(self, names: Iterable[str]) -> dict[str, list[int]]:
        """Numbers the objects of bodies; returns the indices of the bodies of each object.

        Args:
            names: Scoped names of bodies.
        """
        members: dict[str, list[int]] = {}
        for index, name in enumerate(names):
            model, separator, link = name.partition("::")
            label = name if self._links else model
            if not separator or not link or self.category(label) is None:
                continue
            members.setdefault(label, []).append(index)
        return members

    def category(self, label: str) -> str | None:
        """The category of an object; None if it is ignored."""
        for pattern, category in self._patterns.items():
            if fnmatch.fnmatchcase(label, pattern):
                return category
        return label

    def number(self, label: str) -> tuple[int, int]:
        """The numbers of an object and of its category."""
        category = self.category(label) or label
        return (
            self.objects.setdefault(label, len(self.objects) + 1),
            self.categories.setdefault(category, len(self.categories) + 1),
        )
