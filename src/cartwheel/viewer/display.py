"""What of the scene is to be seen."""

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
    """Every link's frame."""
    names: bool = False
    """Every link's name."""
    inertia: bool = False
    """Centres of mass, and boxes of the same inertia."""
    grid: bool = True
    trail: bool = False
    """Where the robot has been."""
    camera: bool = True
    """What the cameras see, as a pyramid with the image at its end."""
    scans: bool = True
    """Where the rays of laser scanners end."""
    clouds: bool = False
    """Point clouds, which cost more to measure and to send."""
    contacts: bool = False
    """Points and forces that the bumpers report."""
    follow: bool = False
    """The browser's camera goes with the robot."""

    def changes(self) -> str:
        """The toggles that differ from their defaults, separated by dots."""
        fields = dataclasses.fields(self)
        return ".".join(f.name for f in fields if getattr(self, f.name) is not f.default)

    @classmethod
    def of(cls, changes: str) -> Self:
        """The toggles with such changes; unknown names are ignored."""
        changed = changes.split(".")
        return cls(
            **{f.name: (f.name in changed) is not f.default for f in dataclasses.fields(cls)}
        )
