"""What every panel has."""

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
    """A part of the page. All its methods run on the page's thread.

    Args:
        stage: What the panels share.
        seat: The browser that it is for; None is for all of them.
    """

    def __init__(self, stage: Stage, seat: Seat | None = None) -> None:
        self.stage = stage
        self.page = stage.page
        self.gui: Any = stage.page.gui if seat is None else seat.gui
        self.session = stage.session
        self.graph = stage.session.graph
        self.simulation = stage.session.simulation

    def watch(self) -> None:
        """The first browser came, or that whose panel it is: subscribe."""

    def leave(self) -> None:
        """The last browser went, or that whose panel it is: let go of everything."""

    def show_topics(self, topics: Sequence[TopicInfo]) -> None:
        """The graph has changed."""

    def show_models(self, snapshot: Snapshot) -> None:
        """Models came or went."""

    def update(self, snapshot: Snapshot, now: float) -> None:
        """A new state, up to 30 times a second.

        Args:
            snapshot: It.
            now: s of wall time.
        """


def escape(text: object) -> str:
    """Text as HTML shows it: names come from users' files."""
    return html.escape(str(text), quote=True)


def rows_html(rows: Mapping[str, str]) -> str:
    """Names and values, which are HTML already, side by side."""
    cells = "".join(
        f'<span class="cw-dim">{name}</span><span>{value}</span>' for name, value in rows.items()
    )
    return f'<div class="cw-properties">{cells}</div>'


def facts(description: RobotDescription) -> dict[str, str]:
    """What a description is, for `rows_html`."""
    return {
        "mass": "static" if description.static else f"{description.mass:.4g} kg",
        "parts": description.parts,
        "file": escape(description.origin.file.rsplit("/", 1)[-1]),
    }


def of_type(topics: Sequence[TopicInfo], type_name: str) -> list[str]:
    """Names of the topics of a type that somebody publishes."""
    return [topic.name for topic in topics if topic.type == type_name and topic.publishers]
