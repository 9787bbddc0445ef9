"""What clients see of a recording that is played: the same as of a simulation."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

from cartwheel.bridges.recording.reading import Recording
from cartwheel.codes.recording import PLAYBACK_READ_ONLY
from cartwheel.description.model import WorldDescription
from cartwheel.errors import Diagnostic, RecordingError
from cartwheel.graph import Graph
from cartwheel.playback.player import Player


class PlaybackSession:
    """A recording with its graph.

    Args:
        recording: To play.
        world: Things to show around the robots.
        package_path: Where meshes are looked for first.
        loop: Begin again at the end.
        hold: At the end hold time, instead of ending.

    Raises:
        RecordingError: There is nothing to play.
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
        """What the user should know."""
        return tuple(self.simulation.diagnostics)

    def spawn(self, *_: Any, **__: Any) -> str:
        """Refuses.

        Raises:
            RecordingError: Always.
        """
        raise RecordingError("models cannot be spawned during playback", code=PLAYBACK_READ_ONLY)
