"""The bumper light: what the contact sensors feel, and their forces in the scene."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from cartwheel.graph import Mailbox, TopicInfo
from cartwheel.simulation.snapshot import Snapshot
from cartwheel.viewer.panels.base import Panel, escape, of_type
from cartwheel.viewer.stage import Stage

CONTACTS = "gazebo_msgs/msg/ContactsState"
LATCH = 0.5
"""s of wall time that a touch stays lit, as a bounce lasts a few milliseconds."""
_METRES_PER_NEWTON = 0.004
_LONGEST = 0.8


class BumperPanel(Panel):
    """Lit while any ContactsState topic reports a touch, with the names of what was hit."""

    def __init__(self, stage: Stage) -> None:
        super().__init__(stage)
        self._boxes: dict[str, Mailbox] = {}
        self._topics: tuple[str, ...] = ()
        self._seen: dict[str, float] = {}
        self._arrows: Any = None
        self._light = self.gui.add_html(light_html((), known=False))
        self._shown = self._light.content

    def watch(self) -> None:
        for topic in self._topics:
            if topic not in self._boxes:
                self._boxes[topic] = self.graph.mailbox(topic, size=200, node="viewer")

    def leave(self) -> None:
        for box in self._boxes.values():
            box.close()
        self._boxes.clear()

    def show_topics(self, topics: Sequence[TopicInfo]) -> None:
        found = tuple(of_type(topics, CONTACTS))
        if found == self._topics:
            return
        self._topics = found
        for topic in set(self._boxes) - set(found):
            self._boxes.pop(topic).close()
        if self.page.clients:
            self.watch()

    def update(self, snapshot: Snapshot, now: float) -> None:  # noqa: ARG002
        states: list[Any] = []
        for box in self._boxes.values():
            messages = box.drain()
            for message in messages:
                for state in message.states:
                    self._seen[other_side(state)] = now
            if messages:
                states += messages[-1].states
                self._show_forces(messages[-1].states)
        self._seen = {name: at for name, at in self._seen.items() if now - at < LATCH}
        content = light_html(tuple(sorted(self._seen)), known=bool(self._topics))
        if content != self._shown:
            self._light.content = self._shown = content

    def _show_forces(self, states: Sequence[Any]) -> None:
        if not self.stage.scene.display.contacts or not states:
            if self._arrows is not None:
                self._arrows.remove()
                self._arrows = None
            return
        points = []
        for state in states:
            for position, wrench in zip(state.contact_positions, state.wrenches, strict=False):
                start = np.array([position.x, position.y, position.z])
                force = np.array([wrench.force.x, wrench.force.y, wrench.force.z])
                length = float(np.linalg.norm(force)) * _METRES_PER_NEWTON
                arrow = force / (np.linalg.norm(force) or 1.0) * min(_LONGEST, max(0.06, length))
                points.append((start, start + arrow))
        self._arrows = self.page.scene.add_arrows(
            "/contacts",
            np.array(points, dtype=np.float32).reshape(-1, 2, 3),
            (224, 49, 49),
            shaft_radius=0.008,
            head_radius=0.02,
            head_length=0.04,
        )


def other_side(state: Any) -> str:
    """What was hit: the collision that is not the sensor's own."""
    return str(state.collision2_name)


def light_html(hit: Sequence[str], *, known: bool) -> str:
    """The light: off without a bumper, grey when free, red with names when touching."""
    if hit:
        models = ", ".join(dict.fromkeys(escape(name.split("::")[0]) for name in hit))
        full = escape("\n".join(hit))
        return (
            f'<div class="cw"><div class="cw-bumper cw-hit" title="{full}">'
            f"<i></i><span>Bumper: <b>{models}</b></span></div></div>"
        )
    text = "Bumper free" if known else "No bumper"
    return f'<div class="cw"><div class="cw-bumper"><i></i><span>{text}</span></div></div>'
