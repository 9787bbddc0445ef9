"""What clients see of a recording during playback: the same as of a simulation."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any, NoReturn

from cartwheel.bridges.recording.reading import Recording
from cartwheel.description.model import WorldDescription
from cartwheel.errors import Diagnostic
from cartwheel.graph import Graph
from cartwheel.playback.player import Player


class PlaybackSession:
    """A recording and its graph.

    Args:
        recording: Recording to play.
        world: World file whose objects are shown around the robots.
        package_path: Directories that are searched first for meshes.
        loop: Whether to restart at the end.
        hold: Whether to pause at the end instead of stopping.

    Raises:
        RecordingError: The recording contains nothing to play.
    """

    def __init__(
        self,
        recording: Recording,
        *,
        world: WorldDescription | None = None,
        package_path: Sequence[Path] = (),
        loop: bool = False,
        hold: bool = True,
    ) -> None:
        self.graph = Graph()
        self.simulation = Player(
            recording,
            self.graph,
            world=world or WorldDescription(name="recording"),
            package_path=package_path,
            loop=loop,
            hold=hold,
        )

    @property
    def diagnostics(self) -> tuple[Diagnostic, ...]:
        """Diagnostics for the user."""
        return tuple(self.simulation.diagnostics)

    def spawn(self, *_: Any, **__: Any) -> NoReturn:
        """Raises an error, because a recording cannot change.

        Raises:
            RecordingError: Always.
        """
        self.simulation.occupied()
