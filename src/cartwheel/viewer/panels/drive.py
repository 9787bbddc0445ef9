"""Driving with keys and buttons.

The keys are commands of the page, so browsers also list them with Ctrl+K. viser's types allow only
letters and digits as hotkeys, but viser passes the name unchanged to the browser, which compares it
with the event's key. Therefore "," and "." work too (`test_driving.py` presses them). ``page.js``
adds what commands cannot do: it prevents the camera from handling w, q and e, makes every other key
stop the robot, and maps the buttons to keys, so that both always do the same.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import Any

from cartwheel.graph import TWIST, TWIST_STAMPED, TopicInfo
from cartwheel.messages import header, message_class
from cartwheel.viewer.panels.base import Panel
from cartwheel.viewer.seat import Seat
from cartwheel.viewer.stage import Stage
from cartwheel.viewer.teleop import MOVES, Teleop

_ALL = "all subscribers"
_NONE = "no subscribers"
_LABELS = {
    "u": "forward left",
    "i": "forward",
    "o": "forward right",
    "j": "turn left",
    "k": "stop",
    "l": "turn right",
    "m": "backward left",
    ",": "backward",
    ".": "backward right",
    "q": "increase both speeds",
    "z": "decrease both speeds",
    "w": "increase linear speed",
    "x": "decrease linear speed",
    "e": "increase angular speed",
    "c": "decrease angular speed",
}
_ANGLES = {"u": -45, "i": 0, "o": 45, "j": -90, "l": 90, "m": -135, ",": 180, ".": 135}


class DrivePanel(Panel):
    """Publishes Twist messages on drive topics, for one browser."""

    def __init__(self, stage: Stage, seat: Seat) -> None:
        super().__init__(stage, seat)
        self._seat = seat
        self._teleop = Teleop()
        self._drivable: dict[str, str] = {}
        self._topic = self.gui.add_dropdown("Drive", (_NONE,), visible=False)
        self._pad = self.gui.add_html(self._html(), visible=False)
        for key, label in _LABELS.items():
            command = self.gui.add_command(f"Drive: {label}", hotkey=key)
            command.on_trigger(self.page.do(self.press, key))

    def press(self, key: str) -> None:
        """Handles a key."""
        publish = self._teleop.press(key)
        if publish:
            chosen = self._topic.value
            self._publish(self._drivable if chosen == _ALL else (chosen,))
        self._pad.content = self._html()

    def show_topics(self, topics: Sequence[TopicInfo]) -> None:
        drivable = {topic.name: topic.type for topic in topics if topic.drives}
        if drivable == self._drivable:
            return
        self._drivable = drivable
        # Hidden for robots that cannot drive, such as an arm on a table.
        self._topic.visible = self._pad.visible = bool(drivable)
        chosen = self._topic.value
        options = (_ALL, *drivable) if len(drivable) > 1 else (tuple(drivable) or (_NONE,))
        self._topic.options = options
        self._topic.value = chosen if chosen in options else options[0]

    def leave(self) -> None:
        """Stops the robot that this browser drives, unless a different browser drives it now."""
        if self._teleop.key == "k":
            return
        self._teleop.press("k")
        drivers = self.stage.drivers
        self._publish([name for name, number in drivers.items() if number == self._seat.number])
        self._pad.content = self._html()

    def _publish(self, topics: Iterable[str]) -> None:
        vector = message_class("geometry_msgs/msg/Vector3")
        twist: Any = message_class(TWIST)(
            linear=vector(x=float(self._teleop.linear)),
            angular=vector(z=float(self._teleop.angular)),
        )
        for topic in topics:
            self.stage.drivers[topic] = self._seat.number
            kind = self._drivable.get(topic)
            if kind == TWIST:
                self.graph.publish(topic, TWIST, twist)
            elif kind == TWIST_STAMPED:
                # A zero timestamp means now: this thread cannot read the simulation time.
                message: Any = message_class(TWIST_STAMPED)(header=header(0, ""), twist=twist)
                self.graph.publish(topic, TWIST_STAMPED, message)

    def _html(self) -> str:
        teleop = self._teleop
        caps = "".join(self._cap(key) for key in MOVES)
        return (
            f'<div class="cw"><div class="cw-pad">{caps}</div>'
            '<div class="cw-speeds">'
            f"<span>linear <b>{teleop.linear_speed:.2f} m/s</b></span>{_speed('x', 'w')}"
            f"<span>angular <b>{teleop.angular_speed:.2f} rad/s</b></span>{_speed('c', 'e')}"
            f'<span class="cw-dim">both</span>{_speed("z", "q")}</div></div>'
        )

    def _cap(self, key: str) -> str:
        classes = "cw-stop" if key == "k" else "cw-active" if key == self._teleop.key else ""
        picture = _STOP if key == "k" else _ARROW.format(angle=_ANGLES[key])
        return (
            f'<button class="{classes}" data-key="{key}" title="{_LABELS[key]}" '
            f'aria-label="{_LABELS[key]}">{picture}<kbd>{key}</kbd></button>'
        )


def _speed(slower: str, faster: str) -> str:
    return "".join(
        f'<button data-key="{key}" title="{_LABELS[key]} by 10 %" '
        f'aria-label="{_LABELS[key]}">{sign} <kbd>{key}</kbd></button>'
        for key, sign in ((slower, "−"), (faster, "+"))
    )


_ARROW = (
    '<svg viewBox="0 0 24 24" fill="none" stroke="currentColor" stroke-width="2.4" '
    'stroke-linecap="round" stroke-linejoin="round" style="transform: rotate({angle}deg)">'
    '<path d="M12 20V4M5 11l7-7 7 7"/></svg>'
)
_STOP = (
    '<svg viewBox="0 0 24 24" fill="currentColor"><rect x="5" y="5" width="14" height="14" '
    'rx="2"/></svg>'
)
