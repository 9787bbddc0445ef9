"""Topics, types, rates, and one topic's messages as text."""

from __future__ import annotations

from collections.abc import Sequence

from cartwheel.graph import TopicInfo
from cartwheel.messages import to_yaml
from cartwheel.simulation.snapshot import Snapshot
from cartwheel.viewer.every import Every
from cartwheel.viewer.panels.base import Panel, escape
from cartwheel.viewer.seat import Seat
from cartwheel.viewer.stage import Stage
from cartwheel.viewer.tap import Tap

_NONE = "none"
_LONGEST = 6000
"""Maximum characters of a message to show: more than a screenful."""


class TopicsPanel(Panel):
    """The list of topics and an echo of one topic."""

    def __init__(self, stage: Stage, seat: Seat) -> None:
        super().__init__(stage, seat)
        self._tap: Tap | None = None
        self._due = Every(5)
        self._list_due = Every(1)
        self._shown = 0
        self._list = self.gui.add_html(list_html(()))
        self._topic = self.gui.add_dropdown("Echo", (_NONE,))
        self._topic.on_update(self.page.do(self._choose))
        self._text = self.gui.add_html("")

    def watch(self) -> None:
        self._choose()

    def leave(self) -> None:
        if self._tap is not None:
            self._tap.close()
            self._tap = None

    def show_topics(self, topics: Sequence[TopicInfo]) -> None:
        content = list_html(topics)
        if content != self._list.content:
            self._list.content = content
        names = (_NONE, *(topic.name for topic in topics if topic.publishers))
        if names != tuple(self._topic.options):
            chosen = self._topic.value
            self._topic.options = names
            self._topic.value = chosen if chosen in names else _NONE

    def update(self, snapshot: Snapshot, now: float) -> None:  # noqa: ARG002
        if self._list_due(now):
            # The number of dropped messages changes without a graph change.
            self.show_topics(self.graph.topics())
        tap = self._tap
        if tap is None or tap.count == self._shown or not self._due(now):
            return
        self._shown = tap.count
        text = to_yaml(tap.newest)
        if len(text) > _LONGEST:
            text = text[:_LONGEST] + "\n…"
        self._text.content = (
            f'<div class="cw"><div class="cw-echo cw-mono">{escape(text)}</div></div>'
        )

    def _choose(self) -> None:
        wanted = self._topic.value
        if self._tap is not None and self._tap.topic == wanted:
            return
        self.leave()
        self._shown = 0
        if wanted == _NONE:
            self._text.content = ""
        else:
            self._text.content = '<div class="cw cw-dim">Waiting for a message.</div>'
            self._tap = Tap(self.graph, wanted)


def _lost(topic: TopicInfo) -> str:
    count = sum(topic.dropped)
    return f' <span class="cw-lost">{count} dropped</span>' if count else ""


def _words(kind: str) -> str:
    """A type that can wrap only between package and name."""
    return escape(kind).replace("/", "/<wbr>")


def list_html(topics: Sequence[TopicInfo]) -> str:
    """A table of topics."""
    rows = "".join(
        f'<tr><td title="{escape(", ".join(topic.publishers) or "no publishers")} → '
        f'{escape(", ".join(topic.readers) or "no subscribers")}">'
        f"{escape(topic.name)}{_lost(topic)}</td>"
        f'<td class="cw-dim cw-words">{_words(topic.type.replace("/msg/", "/"))}</td>'
        f'<td class="cw-right">{f"{topic.rate:g} Hz" if topic.rate else ""}</td></tr>'
        for topic in topics
    )
    return (
        '<div class="cw cw-list"><table><tr><th>topic</th><th>type</th>'
        f'<th class="cw-right">rate</th></tr>{rows}</table></div>'
    )
