"""The bumper light: contacts of the contact sensors, and their forces in the scene."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from cartwheel.graph import Mailbox, TopicInfo
from cartwheel.simulation.snapshot import Snapshot
from cartwheel.viewer.panels.base import Panel, escape, of_type
from cartwheel.viewer.stage import Stage

CONTACTS = "gazebo_msgs/msg/ContactsState"
LATCH = 0.5
"""Time that a contact stays lit, s of wall time: a bounce lasts only milliseconds."""
_METRES_PER_NEWTON = 0.004
_LONGEST = 0.8


class BumperPanel(Panel):
    """Lit while any ContactsState topic reports a contact, with the names of the models."""

    def __init__(self, stage: Stage) -> None:
        super().__init__(stage)
        self._boxes: dict[str, Mailbox] = {}
        self._topics: tuple[str, ...] = ()
        self._seen: dict[tuple[str, str], float] = {}
        """Wall time of the last contact by topic and collision, s."""
        self._states: dict[str, Sequence[Any]] = {}
        """The latest message of each topic."""
        self._arrows: dict[int, Any] = {}
        """The arrows of each browser that shows contacts."""
        self._light = self.gui.add_html(light_html(()), visible=False)
        self._shown = self._light.content

    def watch(self) -> None:
        for topic in self._topics:
            if topic not in self._boxes:
                self._boxes[topic] = self.graph.mailbox(topic, size=200, node="viewer")

    def leave(self) -> None:
        for box in self._boxes.values():
            box.close()
        self._boxes.clear()
        self._states.clear()

    def show_topics(self, topics: Sequence[TopicInfo]) -> None:
        found = tuple(of_type(topics, CONTACTS))
        if found == self._topics:
            return
        self._topics = found
        self._light.visible = bool(found)
        for topic in set(self._boxes) - set(found):
            self._boxes.pop(topic).close()
            self._states.pop(topic, None)
        if self.page.clients:
            self.watch()

    def update(self, snapshot: Snapshot, now: float) -> None:  # noqa: ARG002
        news = False
        for topic, box in self._boxes.items():
            messages = box.drain()
            for message in messages:
                for state in message.states:
                    self._seen[topic, other_side(state)] = now
            if messages:
                news = True
                self._states[topic] = messages[-1].states
        self._show_forces(news)
        self._seen = {contact: at for contact, at in self._seen.items() if now - at < LATCH}
        content = light_html(sorted(self._seen), topics=len(self._topics) > 1)
        if content != self._shown:
            self._light.content = self._shown = content

    def _show_forces(self, news: bool) -> None:
        """Draws the forces of all bumpers in browsers that show contacts.

        Args:
            news: Whether they have changed.
        """
        seats = self.stage.seats
        points = self._points() if any(seat.display.contacts for seat in seats.values()) else None
        for number in set(self._arrows) - set(seats):
            del self._arrows[number]
        for number, seat in seats.items():
            arrows = self._arrows.get(number)
            if points is None or not len(points) or not seat.display.contacts:
                if arrows is not None:
                    self._arrows.pop(number).remove()
            elif news or arrows is None:
                self._arrows[number] = seat.scene.add_arrows(
                    "/contacts",
                    points,
                    (224, 49, 49),
                    shaft_radius=0.008,
                    head_radius=0.02,
                    head_length=0.04,
                )

    def _points(self) -> NDArray[np.float32]:
        """Start and end points of the arrows, shape (n, 2, 3), m."""
        points = []
        for state in (state for states in self._states.values() for state in states):
            for position, wrench in zip(state.contact_positions, state.wrenches, strict=False):
                start = np.array([position.x, position.y, position.z])
                force = np.array([wrench.force.x, wrench.force.y, wrench.force.z])
                length = float(np.linalg.norm(force)) * _METRES_PER_NEWTON
                arrow = force / (np.linalg.norm(force) or 1.0) * min(_LONGEST, max(0.06, length))
                points.append((start, start + arrow))
        return np.array(points, dtype=np.float32).reshape(-1, 2, 3)


def other_side(state: Any) -> str:
    """The other collision in a sensor's contact."""
    return str(state.collision2_name)


def light_html(contacts: Sequence[tuple[str, str]], *, topics: bool = False) -> str:
    """The light: grey without a contact, red with the names of the models.

    Args:
        contacts: The topic and the other collision of each contact.
        topics: Whether to show the topics.
    """
    if contacts:
        shown = (
            f"<b>{escape(name.split('::')[0])}</b>" + (f" ({escape(topic)})" if topics else "")
            for topic, name in contacts
        )
        models = ", ".join(dict.fromkeys(shown))
        full = escape("\n".join(f"{topic}: {name}" for topic, name in contacts))
        return (
            f'<div class="cw"><div class="cw-bumper cw-hit" title="{full}">'
            f"<i></i><span>Contact: {models}</span></div></div>"
        )
    return '<div class="cw"><div class="cw-bumper"><i></i><span>No contact</span></div></div>'
