"""Drawings of trajectories as SVG."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from html import escape

from cartwheel.scenarios.outcome import Outcome

_SIZE = 420
"""Width and maximum height of a drawing in pixels."""
_MARGIN = 34
_MOST_POINTS = 120
"""Maximum number of points of a line."""
_LEAST = 1.0
"""Minimum size of the shown area, m."""
_LINES = 8
"""Maximum number of grid lines in a direction."""


def drawing(outcomes: Sequence[Outcome]) -> str:
    """The trajectories of cases from above, as an SVG element.

    Failed cases are drawn last, in a different colour.
    """
    points = [
        (point[1], point[2]) for each in outcomes for track in each.trajectories.values()
        for point in track
    ]  # fmt: skip
    if not points:
        return ""
    targets = list(dict.fromkeys(tuple(target) for each in outcomes for target in each.targets))
    points += [(x, y) for x, y, _ in targets]
    area = _Area(points)
    parts = [*area.grid()]
    parts += [area.box(box) for box in outcomes[0].obstacles]
    parts += [area.circle(target) for target in targets[:50]]
    ordered = sorted(outcomes, key=lambda each: each.status != "passed")
    for outcome in ordered:
        kind = "good" if outcome.status == "passed" else "bad"
        for name, track in outcome.trajectories.items():
            parts.append(area.line(track, kind, f"{outcome.id}: {name}"))
    return (
        f'<svg viewBox="0 0 {area.width:.0f} {area.height:.0f}" width="{area.width:.0f}" '
        f'height="{area.height:.0f}" role="img" aria-label="trajectories from above">'
        f"{''.join(parts)}</svg>"
    )


class _Area:
    """The part of the ground that a drawing shows."""

    def __init__(self, points: Iterable[tuple[float, float]]) -> None:
        xs, ys = zip(*((x, y) for x, y in points if math.isfinite(x + y)), strict=True)
        self._x, self._y, wide, high = min(xs), min(ys), max(xs) - min(xs), max(ys) - min(ys)
        border = 0.08 * max(wide, high, _LEAST)
        for name, length in (("_x", wide), ("_y", high)):
            missing = max(0.0, 0.4 * max(wide, high, _LEAST) - length)
            setattr(self, name, getattr(self, name) - border - missing / 2)
        least = 0.4 * max(wide, high, _LEAST)
        self._wide = max(wide, least) + 2 * border
        self._high = max(high, least) + 2 * border
        self._scale = (_SIZE - 2 * _MARGIN) / max(self._wide, self._high)
        self.width = self._wide * self._scale + 2 * _MARGIN
        self.height = self._high * self._scale + 2 * _MARGIN

    def at(self, x: float, y: float) -> tuple[float, float]:
        """Pixels of a point."""
        return (
            _MARGIN + (x - self._x) * self._scale,
            self.height - _MARGIN - (y - self._y) * self._scale,
        )

    def grid(self) -> Iterable[str]:
        """Lines with their coordinates in m."""
        step = _step(max(self._wide, self._high) / _LINES)
        left, top = _MARGIN, _MARGIN
        right, bottom = self.width - _MARGIN, self.height - _MARGIN
        for value in _marks(self._x, self._wide, step):
            x, _ = self.at(value, 0.0)
            yield f'<path class="grid" d="M{x:.1f} {top}V{bottom:.1f}"/>'
            yield f'<text x="{x:.1f}" y="{bottom + 14:.1f}" text-anchor="middle">{value:g}</text>'
        for value in _marks(self._y, self._high, step):
            _, y = self.at(0.0, value)
            yield f'<path class="grid" d="M{left} {y:.1f}H{right:.1f}"/>'
            yield f'<text x="{left - 5}" y="{y + 3:.1f}" text-anchor="end">{value:g}</text>'
        yield f'<text x="{right:.1f}" y="{bottom + 28:.1f}" text-anchor="end">x in m</text>'
        yield f'<text x="{left - 26}" y="{top - 10}">y in m</text>'

    def box(self, box: Sequence[float]) -> str:
        """A fixed shape, within the area."""
        x0, y0 = max(box[0], self._x), max(box[1], self._y)
        x1, y1 = min(box[2], self._x + self._wide), min(box[3], self._y + self._high)
        if x0 >= x1 or y0 >= y1:
            return ""
        (left, bottom), (right, top) = self.at(x0, y0), self.at(x1, y1)
        return (
            f'<rect class="solid" x="{left:.1f}" y="{top:.1f}" width="{right - left:.1f}" '
            f'height="{bottom - top:.1f}"/>'
        )

    def circle(self, target: Sequence[float]) -> str:
        """A position to reach."""
        x, y = self.at(target[0], target[1])
        radius = max(3.0, target[2] * self._scale)
        return f'<circle class="target" cx="{x:.1f}" cy="{y:.1f}" r="{radius:.1f}"/>'

    def line(self, track: Sequence[Sequence[float]], kind: str, title: str) -> str:
        """A trajectory, with a dot at its end."""
        every = max(1, math.ceil(len(track) / _MOST_POINTS))
        chosen = [*track[::every], track[-1]]
        places = [self.at(point[1], point[2]) for point in chosen]
        text = " ".join(f"{x:.1f},{y:.1f}" for x, y in places)
        x, y = places[-1]
        return (
            f'<g class="{kind}"><title>{escape(title)}</title><polyline points="{text}"/>'
            f'<circle cx="{x:.1f}" cy="{y:.1f}" r="2.5"/></g>'
        )


def _step(length: float) -> float:
    """The next round number: 1, 2 or 5 times a power of ten."""
    power = 10.0 ** math.floor(math.log10(length))
    return next(power * each for each in (1, 2, 5, 10) if power * each >= length)


def _marks(start: float, length: float, step: float) -> Iterable[float]:
    first = math.ceil(start / step)
    return [float(f"{i * step:.6g}") for i in range(first, math.floor((start + length) / step) + 1)]
