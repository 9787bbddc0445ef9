"""Names of worlds for people."""

from __future__ import annotations

from pathlib import PurePath
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from cartwheel.description.model import WorldDescription


def world_title(world: WorldDescription) -> str:
    """A world's name, or that of its file: half of all worlds are named default."""
    if world.name not in ("default", "world", ""):
        return world.name
    return PurePath(world.origin.file).stem.strip("<>")
