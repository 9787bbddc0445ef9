"""The base class of all panels."""

from __future__ import annotations

import html
from collections.abc import Mapping, Sequence
from typing import Any

from cartwheel.description.model import RobotDescription
from cartwheel.graph import TopicInfo
from cartwheel.simulation.snapshot import Snapshot
from cartwheel.viewer.seat import Seat
from cartwheel.viewer.stage import Stage


class Panel:
    """A part of the web interface. All methods run on the page's thread.

    Args:
        stage: Shared state of the panels.
        seat: The panel's browser; None for a shared panel.
    """

    def __init__(self, stage: Stage, seat: Seat | None = None) -> None:
        self.stage = stage
        self.page = stage.page
        self.gui: Any = stage.page.gui if seat is None else seat.gui
        self.session = stage.session
        self.graph = stage.session.graph
        self.simulation = stage.session.simulation

    def watch(self) -> None:
        """Subscribes to topics: the first browser, or the panel's browser, has connected."""

    def leave(self) -> None:
        """Unsubscribes: the last browser, or the panel's browser, has disconnected."""

    def show_topics(self, topics: Sequence[TopicInfo]) -> None:
        """Called when the graph has changed."""

    def show_models(self, snapshot: Snapshot) -> None:
        """Called when models were spawned or deleted."""

    def update(self, snapshot: Snapshot, now: float) -> None:
        """Shows a new state, up to 30 times per second.

        Args:
            snapshot: The state.
            now: Wall time, s.
        """


def escape(text: object) -> str:
    """Escapes a text for HTML, because names come from users' files."""
    return html.escape(str(text), quote=True)


def rows_html(rows: Mapping[str, str]) -> str:
    """A table of names and values, which are already HTML."""
    cells = "".join(
        f'<span class="cw-dim">{name}</span><span>{value}</span>' for name, value in rows.items()
    )
    return f'<div class="cw-properties">{cells}</div>'


def facts(description: RobotDescription) -> dict[str, str]:
    """Properties of a description, for `rows_html`."""
    return {
        "mass": "static" if description.static else f"{description.mass:.4g} kg",
        "parts": description.parts,
        "file": escape(description.origin.file.rsplit("/", 1)[-1]),
    }


def of_type(topics: Sequence[TopicInfo], type_name: str) -> list[str]:
    """Names of the published topics with a type."""
    return [topic.name for topic in topics if topic.type == type_name and topic.publishers]
