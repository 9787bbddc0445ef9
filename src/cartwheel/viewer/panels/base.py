"""What every panel has."""

from __future__ import annotations

import html
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING

from cartwheel.description.model import RobotDescription
from cartwheel.graph import TopicInfo
from cartwheel.simulation.snapshot import Snapshot

if TYPE_CHECKING:
    from cartwheel.viewer.desk import Desk


class Panel:
    """A part of the page. All its methods run on the page's thread.

    Args:
        desk: What the panels share.
    """

    def __init__(self, desk: Desk) -> None:
        self.desk = desk
        self.page = desk.page
        self.gui = desk.page.gui
        self.session = desk.session
        self.graph = desk.session.graph
        self.simulation = desk.session.simulation

    def watch(self) -> None:
        """The first browser came: subscribe."""

    def leave(self) -> None:
        """The last browser went: let go of everything that makes work."""

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


class Every:
    """Says when something that is done at most `rate` times a second of wall time is due."""

    def __init__(self, rate: float) -> None:
        self._period = 1.0 / rate
        self._due = 0.0

    def __call__(self, now: float) -> bool:
        if now < self._due:
            return False
        self._due = now + self._period
        return True


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
        "mass": "fixed" if description.static else f"{description.mass:.4g} kg",
        "parts": f"{len(description.links)} links, {len(description.joints)} joints",
        "file": escape(description.origin.file.rsplit("/", 1)[-1]),
    }


def of_type(topics: Sequence[TopicInfo], type_name: str) -> list[str]:
    """Names of the topics of a type that somebody publishes."""
    return [topic.name for topic in topics if topic.type == type_name and topic.publishers]
