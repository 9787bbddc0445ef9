"""Diagnostics about the files: unknown tags, losses, likely mistakes."""

from __future__ import annotations

from collections.abc import Sequence

from cartwheel.errors import Diagnostic
from cartwheel.simulation.snapshot import Snapshot
from cartwheel.viewer.every import Every
from cartwheel.viewer.panels.base import Panel, escape
from cartwheel.viewer.stage import Stage


class NotesPanel(Panel):
    """The list of diagnostics."""

    def __init__(self, stage: Stage) -> None:
        super().__init__(stage)
        self._due = Every(1)
        self._shown = -1
        self._list = self.gui.add_html("")

    def update(self, snapshot: Snapshot, now: float) -> None:  # noqa: ARG002
        if not self._due(now):
            return
        diagnostics = self.session.diagnostics
        if len(diagnostics) != self._shown:
            self._shown = len(diagnostics)
            self._list.content = notes_html(diagnostics)


def notes_html(diagnostics: Sequence[Diagnostic]) -> str:
    """All diagnostics, most severe first."""
    order = {"error": 0, "warning": 1, "info": 2}
    notes = "".join(
        f'<div class="cw-note cw-{note.severity}">{escape(note.text)}'
        f'<div class="cw-dim">{escape(note.origin) if note.origin else ""}</div></div>'
        for note in sorted(diagnostics, key=lambda note: order[note.severity])
    )
    return f'<div class="cw cw-list">{notes or "No warnings."}</div>'
