"""Sliders for joints with position commands."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from functools import partial
from typing import Any

from cartwheel.description.model import Joint
from cartwheel.graph import JointInput, TopicInfo
from cartwheel.simulation.snapshot import Snapshot
from cartwheel.viewer.every import Every
from cartwheel.viewer.panels.base import Panel, escape
from cartwheel.viewer.stage import Stage

_STEPS = 400
"""Minimum number of steps in a slider."""
_FINEST = 0.001
"""Minimum slider step for joints with a long range, rad or m."""
_SPEED = 1.0
"""Commanded speed of a joint, rad/s or m/s, unless its limit is lower."""
_SOONEST = 0.2
"""Minimum duration of a trajectory, s."""
_NEAR = 0.05
"""rad or m; a joint within this distance from its last target keeps that target when others move,
so that it does not sag further under its weight.
"""
_UNTOUCHED = 3.0
"""s after arrival until the sliders follow their joints again."""


def limits_of(joint: Joint) -> tuple[float, float]:
    """Range of a joint's slider, rad or m: its limits, or one turn or a metre."""
    reach = 1.0 if joint.type == "prismatic" else math.pi
    low = -reach if joint.axis.lower is None else joint.axis.lower
    high = reach if joint.axis.upper is None else joint.axis.upper
    return (low, high) if high > low else (low - reach, low + reach)


def range_of(joint: Joint) -> tuple[float, float, float]:
    """A slider's limits and step, rad or m, within the joint's range.

    The web interface shows as many decimals as these values have, and has room for a few.
    """
    low, high = limits_of(joint)
    digits = -math.floor(math.log10(min(_FINEST, (high - low) / _STEPS)) + 1e-9)
    scale = 10.0**digits
    ends = math.ceil(low * scale - 1e-6) / scale, math.floor(high * scale + 1e-6) / scale
    return *ends, 1 / scale


def add_slider(gui: Any, joint: Joint, value: float, **options: Any) -> Any:
    """A slider with the joint's range."""
    low, high, step = range_of(joint)
    return gui.add_slider(
        joint.name,
        min=low,
        max=high,
        step=step,
        initial_value=min(high, max(low, value)),
        hint=f"{joint.type}, {'m' if joint.type == 'prismatic' else 'rad'}",
        **options,
    )


def way(
    joints: Mapping[str, Joint],
    actual: Mapping[str, float],
    sent: Mapping[str, float],
    moved: Mapping[str, float],
) -> tuple[dict[str, float], float]:
    """Targets for all joints of a controller after some sliders moved, and the duration in s.

    Args:
        joints: All joints of the controller, by name.
        actual: Current positions, rad or m.
        sent: Previous targets that the joints have reached or are moving to.
        moved: New targets from sliders.
    """
    targets, seconds = {}, _SOONEST
    for name, joint in joints.items():
        targets[name] = moved.get(name, sent.get(name, actual[name]))
        speed = min(_SPEED, joint.axis.velocity or math.inf)
        seconds = max(seconds, abs(targets[name] - actual[name]) / speed)
    return targets, seconds


@dataclass(eq=False)
class _Group:
    """The sliders of one topic or action."""

    taker: JointInput
    joints: dict[str, Joint]
    title: Any
    sliders: dict[str, Any] = field(default_factory=dict)
    moved: dict[str, float] = field(default_factory=dict)
    """Changes that have not been sent yet."""
    sent: dict[str, float] = field(default_factory=dict)
    free: float = -math.inf
    """Wall time from which the sliders follow their joints, s."""

    def remove(self) -> None:
        for handle in (self.title, *self.sliders.values()):
            handle.remove()


class JointsPanel(Panel):
    """Sliders for joints with position commands, grouped by controller."""

    def __init__(self, stage: Stage, tab: Any) -> None:
        super().__init__(stage)
        self._tab = tab
        self._groups: list[_Group] = []
        self._none = self.gui.add_html(
            '<div class="cw cw-dim">No controller accepts joint positions.</div>'
        )
        self._send_due, self._follow_due = Every(20), Every(4)
        self._known: tuple[tuple[JointInput, ...], int] | None = None

    def show_topics(self, topics: Sequence[TopicInfo]) -> None:  # noqa: ARG002
        self._rebuild()

    def show_models(self, snapshot: Snapshot) -> None:  # noqa: ARG002
        self._rebuild()

    def update(self, snapshot: Snapshot, now: float) -> None:
        actual = None
        if any(group.moved for group in self._groups) and self._send_due(now):
            actual = _positions(snapshot)
            for group in self._groups:
                if group.moved:
                    self._send(group, actual, now)
        if self._groups and self._follow_due(now):
            actual = _positions(snapshot) if actual is None else actual
            for group in self._groups:
                if now > group.free:
                    self._follow(group, actual)

    def _send(self, group: _Group, actual: Mapping[tuple[str, str], float], now: float) -> None:
        here = {name: actual.get((group.taker.model, name), 0.0) for name in group.joints}
        targets, seconds = way(group.joints, here, group.sent, group.moved)
        group.moved, group.sent = {}, targets
        group.free = now + seconds + _UNTOUCHED
        put = group.taker.put
        self.graph.post(lambda: put(targets, seconds))

    def _follow(self, group: _Group, actual: Mapping[tuple[str, str], float]) -> None:
        with self.page.server.atomic():
            for name, slider in group.sliders.items():
                value = actual.get((group.taker.model, name), 0.0)
                if abs(group.sent.get(name, value) - value) > _NEAR:
                    # The joint was moved by something else.
                    del group.sent[name]
                value = min(slider.max, max(slider.min, value))
                # Skip changes that are too small to see.
                if abs(value - slider.value) > (slider.max - slider.min) / (2 * _STEPS):
                    slider.value = value

    def _touch(self, group: _Group, name: str, event: Any, value: float) -> None:
        if event.client is None:
            # Set by this panel, not by the user.
            return
        group.moved[name] = float(value)
        group.free = math.inf

    def _rebuild(self) -> None:
        snapshot = self.stage.scene.snapshot
        if snapshot is None:
            return
        inputs = self.graph.joint_inputs.all()
        known = (inputs, snapshot.scene.version)
        if known == self._known:
            return
        self._known = known
        kept = {group.taker: group for group in self._groups}
        models = {model.name: model.description for model in snapshot.scene.models}
        actual = _positions(snapshot)
        self._groups = []
        with self._tab, self.page.server.atomic():
            for taker in inputs:
                group = kept.pop(taker, None)
                description = models.get(taker.model)
                if group is None and description is not None:
                    joints = {name: description.joint(name) for name in taker.joints}
                    found = {name: joint for name, joint in joints.items() if joint is not None}
                    group = self._build(taker, found, actual)
                if group is not None:
                    self._groups.append(group)
        for group in kept.values():
            group.remove()
        self._none.visible = not self._groups

    def _build(
        self,
        taker: JointInput,
        joints: dict[str, Joint],
        actual: Mapping[tuple[str, str], float],
    ) -> _Group:
        title = self.gui.add_html(
            f'<div class="cw cw-rows">{escape(taker.model)} '
            f'<span class="cw-dim">{escape(taker.owner)}</span></div>'
        )
        group = _Group(taker=taker, joints=joints, title=title)
        for name, joint in joints.items():
            slider = add_slider(self.gui, joint, actual.get((taker.model, name), 0.0))
            slider.on_update(self.page.on_value(partial(self._touch, group, name)))
            group.sliders[name] = slider
        return group


def _positions(snapshot: Snapshot) -> dict[tuple[str, str], float]:
    values = (float(value) for value in snapshot.joint_positions)
    return dict(zip(snapshot.scene.joints, values, strict=True))
