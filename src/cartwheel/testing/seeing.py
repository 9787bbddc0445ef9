"""Conditions on the messages of sensors."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from cartwheel.api.arguments import refused
from cartwheel.api.values import array, invalid, scalar
from cartwheel.arrays import cloud, scan
from cartwheel.codes.graph import TOPIC_TYPE_MISMATCH
from cartwheel.errors import GraphError
from cartwheel.testing.conditions import Condition

if TYPE_CHECKING:
    from cartwheel.api import World

_COLOR_DISTANCE = 0.25
"""Maximum difference of each of red, green and blue, as a fraction of the brightness."""
_DARKEST = 0.4
"""Brightness of the darkest shaded surface, as a fraction of that of its saturated colour. For a
grey, it is 1, because other greys are other colours."""
_CHANNELS = {"rgb8": (0, 1, 2), "bgr8": (2, 1, 0), "rgba8": (0, 1, 2), "bgra8": (2, 1, 0)}
_DEPTHS = {"32FC1": (np.float32, 1.0), "16UC1": (np.uint16, 1e-3)}
"""Type and unit in m of the values of depth images."""
_KINDS: dict[str, tuple[str, ...]] = {
    "sensor_msgs/msg/Image": ("color", "range"),
    "sensor_msgs/msg/LaserScan": ("range", "angle"),
    "sensor_msgs/msg/Range": ("range",),
    "sensor_msgs/msg/PointCloud2": ("range",),
    "sensor_msgs/msg/PointCloud": ("range",),
    "ros_gz_interfaces/msg/LogicalCameraImage": ("model",),
}
"""What the messages of each type can be tested for. The encoding of an image decides further."""
_WITHIN, _SHARE = 0.05, 0.01
_ROUNDED = 1e-3
"""Rounding of the angles of a scan, which are float32, rad."""
_NEEDS = {"within": "range", "share": "color"}
"""Arguments that only have a meaning with another one."""


class Sees(Condition):
    """A sensor sees an object.

    Args:
        topic: A topic with images, depth images, laser scans, ranges, point clouds or images of
            logical cameras.
        range: Shortest measured distance, m; None if any distance is sufficient.
        within: Tolerance of the range, m; None is 0.05.
        angle: Angle of the only ray of a laser scan that counts, rad.
        color: Red, green and blue from 0 to 1, for images.
        share: Minimum share of the image's pixels that have the colour; None is 0.01.
        model: Name of the detected model, for logical cameras.

    Raises:
        CartwheelError: The colour is invalid, or a tolerance or share is given without the range or
            colour to which it belongs.
    """

    def __init__(
        self,
        topic: str,
        *,
        range: float | None = None,
        within: float | None = None,
        angle: float | None = None,
        color: Sequence[float] | None = None,
        share: float | None = None,
        model: str | None = None,
    ) -> None:
        super().__init__()
        given = {"range": range, "within": within, "angle": angle, "color": color, "share": share,
                 "model": model}  # fmt: skip
        self._asked = tuple(name for name, each in given.items() if each is not None)
        for name in self._asked:
            if _NEEDS.get(name, name) not in self._asked:
                raise refused(name, f"used with {_NEEDS[name]}", given[name])
        self.topic, self.model = topic, model
        self.range = None if range is None else scalar(range, "range", least=0.0)
        self.within = _WITHIN if within is None else scalar(within, "within", least=0.0)
        self.angle = None if angle is None else scalar(angle, "angle")
        self.color = None if color is None else _checked(color)
        self.share = _SHARE if share is None else scalar(share, "share", least=0.0, most=1.0)
        self.nearest: float | None = None
        self.seen_share: float | None = None
        self._pixels: Any = None
        self.seen_models: tuple[str, ...] = ()
        self.count = 0
        self._met = False
        self._latest: Any = None
        self._best = math.inf
        self._end: Callable[[], None] = lambda: None

    def begin(self, world: World) -> None:
        super().begin(world)
        kind = world.graph.topic(self.topic).type
        if kind not in _KINDS:
            raise GraphError(
                f'the topic "{self.topic}" has the type {kind}, in which nothing can be seen',
                code=TOPIC_TYPE_MISMATCH,
                hint=f"Use a topic of one of these types: {', '.join(_KINDS)}.",
                values={"topic": self.topic, "type": kind},
            )
        self._require(_KINDS[kind], f"has the type {kind}", type=kind)
        self.count = 0
        self._end = world.graph.subscribe(self.topic, self._take).close

    def _require(self, testable: Sequence[str], found: str, **values: str) -> None:
        """Refuses what cannot be tested.

        Args:
            testable: What the messages can be tested for.
            found: The reason, as a phrase about the topic.
            values: The same, for programs.

        Raises:
            GraphError: The messages cannot be tested for what the condition asks.
        """
        unable = [name for name in self._asked if _NEEDS.get(name, name) not in testable]
        if testable and not unable:
            return
        raise GraphError(
            f'the topic "{self.topic}" {found}, which cannot be tested'
            + "".join(f' for "{name}"' for name in unable[:1]),
            code=TOPIC_TYPE_MISMATCH,
            hint=f"It can be tested for {' and '.join(testable)}." if testable else None,
            values={"topic": self.topic, "name": "".join(unable[:1]), **values},
        )

    def _take(self, message: Any) -> None:
        self._latest = message

    def close(self) -> None:
        self._end()
        self._end = lambda: None
        self._latest = None
        super().close()

    def holds(self) -> bool:
        message, self._latest = self._latest, None
        if message is not None:
            self.count += 1
            self._met = self._evaluate(message)
        return self._met

    def _evaluate(self, message: Any) -> bool:
        kind = message.__msgtype__.rpartition("/")[2]
        if kind == "LogicalCameraImage":
            self.seen_models = tuple(each.name for each in message.model)
            return self.model in self.seen_models if self.model else bool(self.seen_models)
        if kind == "Image":
            coloured = message.encoding in _CHANNELS
            testable = ("color",) if coloured else ("range",) * (message.encoding in _DEPTHS)
            found = f"has images with the encoding {message.encoding}"
            self._require(testable, found, encoding=message.encoding)
            if coloured:
                return self._evaluate_color(message)
        distance = _nearest(message, kind) if self.angle is None else self._ray(message)
        if distance is None:
            return False
        if self.range is None:
            self.nearest = distance
            return True
        if abs(distance - self.range) < self._best:
            self._best, self.nearest = abs(distance - self.range), distance
        return abs(distance - self.range) <= self.within

    def _ray(self, message: Any) -> float | None:
        """The distance that the ray at the angle measures, m; None if nothing is in range."""
        view = scan(message)
        turns = np.abs((view.angles - self.angle + math.pi) % math.tau - math.pi)
        ray = int(turns.argmin()) if turns.size else 0
        if not turns.size or turns[ray] > abs(message.angle_increment) / 2 + _ROUNDED:
            limits = f"{message.angle_min:.3f} to {message.angle_max:.3f} rad"
            raise refused("angle", f"that of a ray, from {limits}", self.angle)
        return float(view.ranges[ray]) if view.valid[ray] else None

    def _evaluate_color(self, message: Any) -> bool:
        size = len(message.encoding.rstrip("0123456789"))
        rows: Any = np.asarray(message.data).reshape(message.height, message.step)
        pixels = rows[:, : message.width * size].reshape(message.height, message.width, size)
        red_first = pixels[:, :, _CHANNELS[message.encoding]]
        if self.color is None:
            # An image of one colour shows nothing.
            return bool((red_first != red_first[0, 0]).any())
        share = float(_similar(red_first / 255.0, np.array(self.color)).mean())
        if self.seen_share is None or share > self.seen_share:
            self.seen_share, self._pixels = share, red_first
        return share >= self.share

    @property
    def expected(self) -> str:
        place = "" if self.angle is None else f" at {self.angle:g} rad"
        if self.color is not None:
            color = ", ".join(f"{each:g}" for each in self.color)
            return (
                f"{self.topic} shows the colour ({color}) in {100 * self.share:g} % of its pixels"
            )
        if self.model is not None:
            return f"{self.topic} shows {self.model}"
        if self.range is not None:
            what = "the shortest distance" if self.angle is None else "the distance"
            return (
                f"{what} that {self.topic} measures{place} is {self.range:g} m within "
                f"{self.within:g} m"
            )
        return f"{self.topic} shows an object{place}"

    @property
    def actual(self) -> str:
        if not self.count:
            return "no message arrived"
        if self.seen_share is not None:
            pixels = self._pixels.reshape(-1, 3) / 255.0
            distances = np.abs(pixels - np.array(self.color)).max(axis=1)
            seen = ", ".join(f"{each:.2g}" for each in pixels[distances.argmin()])
            return (
                f"at most {100 * self.seen_share:.3g} % of the pixels had the colour; the most "
                f"similar colour was ({seen})"
            )
        if self.model is not None:
            return f"it showed {', '.join(self.seen_models) or 'no model'}"
        if self.nearest is not None:
            if self.range is None:
                return f"the distance was {self.nearest:.3f} m"
            return f"the most similar one was {self.nearest:.3f} m"
        return f"{self.count} message{'s' * (self.count > 1)} contained no object"

    @property
    def values(self) -> Mapping[str, float | str | None]:
        return {"count": self.count, "range": self.nearest, "share": self.seen_share}


def _checked(color: Sequence[float]) -> tuple[float, ...]:
    """Red, green and blue from 0 to 1."""
    try:
        opaque = color[:3]
    except TypeError:
        opaque = ()
    values = array(opaque, (3,), "color")
    if values.min() < 0.0 or values.max() > 1.0:
        error = invalid("color", "must be red, green and blue from 0 to 1", tuple(color))
        error.hint = "Divide values from 0 to 255 by 255."
        raise error
    return tuple(values.tolist())


def _similar(pixels: Any, color: Any) -> Any:
    """Which pixels show a surface with a colour, lit or shaded; shape (height, width)."""
    near = (np.abs(pixels - color) <= _COLOR_DISTANCE).all(axis=2)
    brightest = float(color.max())
    if brightest == 0.0:
        return near
    saturation = 1.0 - float(color.min()) / brightest
    scale = (pixels @ color / (color @ color)).clip(1.0 - (1.0 - _DARKEST) * saturation, 1.0)
    shaded = np.abs(pixels - scale[..., None] * color) <= _COLOR_DISTANCE * scale[..., None]
    return near | shaded.all(axis=2)


def _nearest(message: Any, kind: str) -> float | None:
    """The shortest distance in a message, m; None if nothing is in range."""
    if kind == "LaserScan":
        values = np.asarray(message.ranges, dtype=float)
        values = values[(values >= message.range_min) & (values <= message.range_max)]
    elif kind == "Range":
        good = message.min_range <= message.range < message.max_range
        values = np.array([message.range] if good else [], dtype=float)
    elif kind in ("PointCloud2", "PointCloud"):
        # Points are in the frame of the sensor. Those without a measurement are NaN or at 0.
        values = np.linalg.norm(cloud(message).reshape(-1, 3).astype(float), axis=1)
        values = values[values > 0]
    elif message.encoding in _DEPTHS:
        dtype, unit = _DEPTHS[message.encoding]
        values = np.frombuffer(np.asarray(message.data).tobytes(), dtype=dtype).astype(float) * unit
        values = values[values > 0]
    else:
        return None
    values = values[np.isfinite(values)]
    return float(values.min()) if values.size else None
