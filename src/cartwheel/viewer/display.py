"""The visible parts of the scene."""

from __future__ import annotations

import dataclasses
from dataclasses import dataclass
from typing import Self


@dataclass(kw_only=True, slots=True)
class Display:
    """The toggles of one browser."""

    visual: bool = True
    collision: bool = False
    transparent: bool = False
    wireframe: bool = False
    axes: bool = False
    """The frame of each link."""
    names: bool = False
    """The name of each link."""
    inertia: bool = False
    """Centres of mass, and boxes with the same inertia."""
    grid: bool = True
    trail: bool = False
    """The path of the robot."""
    camera: bool = True
    """The cameras' views, as pyramids with the image as the base."""
    scans: bool = True
    """The end points of laser rays."""
    clouds: bool = False
    """Point clouds, which are more expensive to measure and send."""
    contacts: bool = False
    """Contact points and forces from bumpers."""
    follow: bool = False
    """The browser's camera follows the robot."""

    def changes(self) -> str:
        """The toggles that differ from their defaults, separated by dots."""
        fields = dataclasses.fields(self)
        return ".".join(f.name for f in fields if getattr(self, f.name) is not f.default)

    @classmethod
    def of(cls, changes: str) -> Self:
        """Toggles from such a text; unknown names are ignored."""
        changed = changes.split(".")
        return cls(
            **{f.name: (f.name in changed) is not f.default for f in dataclasses.fields(cls)}
        )
