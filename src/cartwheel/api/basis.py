"""What worlds of the same files share."""

from __future__ import annotations

from dataclasses import dataclass

from cartwheel.description.files.readings import Readings
from cartwheel.simulation.models.compilations import Compiler


@dataclass(frozen=True, kw_only=True, slots=True)
class Basis:
    """What a world has in common with others that are made of the same files."""

    compiler: Compiler | None = None
    """None: a new one."""
    readings: Readings | None = None
    """None: all files are read."""
    watched: bool = True
    """Whether reports of tests show the world."""
