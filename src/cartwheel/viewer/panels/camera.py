"""Shows a camera's images."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from cartwheel import arrays
from cartwheel.graph import TopicInfo
from cartwheel.messages import nanoseconds
from cartwheel.simulation.snapshot import Snapshot
from cartwheel.viewer.every import Every
from cartwheel.viewer.panels.base import Panel, escape, of_type
from cartwheel.viewer.seat import Seat
from cartwheel.viewer.stage import Stage
from cartwheel.viewer.tap import Tap

IMAGE = "sensor_msgs/msg/Image"
_NONE = "none"
_RATE = 15.0
"""Maximum frame rate, Hz of wall time, because each image must be compressed."""
_COLOURS = ("rgb8", "bgr8", "rgba8", "bgra8", "rgb16", "bgr16", "mono8", "mono16")
_MOSAICS = ("bayer_rggb8", "bayer_bggr8", "bayer_gbrg8", "bayer_grbg8")
_DEPTHS = ("32FC1", "16UC1")
_DARKEST = 30
"""Brightness of the farthest depth; black means no depth."""


class CameraPanel(Panel):
    """Shows an image topic in one browser; images are rendered only while they are visible."""

    def __init__(self, stage: Stage, seat: Seat) -> None:
        super().__init__(stage, seat)
        self._topics: tuple[str, ...] = ()
        self._tap: Tap | None = None
        self._due = Every(_RATE)
        self._shown = 0
        self._mark: tuple[int, int] = (0, 0)
        self._rate = 0.0
        self._text = ""
        self._on = self.gui.add_checkbox("Show the image", initial_value=True, visible=False)
        self._on.on_update(self.page.do(self._choose))
        self._topic = self.gui.add_dropdown("Topic", (_NONE,), visible=False)
        self._topic.on_update(self.page.do(self._choose))
        blank = np.zeros((3, 4, 3), dtype=np.uint8)
        self._image = self.gui.add_image(blank, format="jpeg", jpeg_quality=85, visible=False)
        self._caption = self.gui.add_html(_caption("No image topic is published."))

    def watch(self) -> None:
        self._choose()

    def leave(self) -> None:
        if self._tap is not None:
            self._tap.close()
            self._tap = None

    def show_topics(self, topics: Sequence[TopicInfo]) -> None:
        # Colour images first, as the most useful ones.
        found = tuple(sorted(of_type(topics, IMAGE), key=lambda name: "depth" in name))
        if found == self._topics:
            return
        self._topics = found
        self._on.visible = self._topic.visible = bool(found)
        chosen = self._topic.value
        self._topic.options = found or (_NONE,)
        self._topic.value = chosen if chosen in found else (found or (_NONE,))[0]
        self._choose()

    def update(self, snapshot: Snapshot, now: float) -> None:  # noqa: ARG002
        tap = self._tap
        if tap is None or tap.count == self._shown or not self._due(now):
            return
        self._shown = tap.count
        message = tap.newest
        self._measure(tap.count, nanoseconds(message.header.stamp))
        picture = pixels_of(message)
        size = f"{message.width} × {message.height} {escape(message.encoding)}"
        if picture is None:
            self._say(f"{size}: unsupported encoding")
            return
        self._image.image = picture
        if not self._image.visible:
            self._image.visible = True
        self._say(f"{size} · {self._rate:.1f} Hz" if self._rate else size)
        self.stage.frustums.show_image(self._topic.value, picture)

    def _choose(self) -> None:
        wanted = self._topic.value
        if self._tap is not None and self._tap.topic == wanted and self._on.value:
            return
        self.leave()
        self._shown, self._rate, self._mark = 0, 0.0, (0, 0)
        if wanted not in self._topics:
            self._image.visible = False
            self._say("No image topic is published.")
        elif not self._on.value:
            self._image.visible = False
            self._say("The image is off, so this browser does not subscribe to the topic.")
        else:
            self._tap = Tap(self.graph, wanted)

    def _measure(self, count: int, time_ns: int) -> None:
        """Measures the message rate in simulation time, which is how a camera's rate is defined.

        Args:
            count: Number of messages so far.
            time_ns: Timestamp of the last message.
        """
        count_before, time_before = self._mark
        passed = (time_ns - time_before) / 1e9
        if not count_before or passed < 0:
            self._mark = (count, time_ns)
        elif passed >= 1.0:
            self._rate = (count - count_before) / passed
            self._mark = (count, time_ns)

    def _say(self, text: str) -> None:
        if text != self._text:
            self._text = text
            self._caption.content = _caption(text)


def pixels_of(message: Any) -> NDArray[np.uint8] | None:
    """An image message as RGB, shape (height, width, 3); None for unsupported encodings.

    Depth images are grey, with the nearest pixels brightest and missing depths black.

    Raises:
        GraphError: The data do not fit the size of the image.
    """
    encoding = message.encoding
    shown = encoding in (*_COLOURS, *_MOSAICS, *_DEPTHS)
    if not shown or not message.height or not message.width:
        return None
    values = arrays.image(message)
    if encoding in _DEPTHS:
        return _grey_of(values)
    picture = (values >> 8 if values.dtype.itemsize == 2 else values).astype(np.uint8)
    if encoding in _MOSAICS:
        return _from_mosaic(picture, encoding)
    if picture.ndim == 2:
        return np.repeat(picture[..., None], 3, axis=2)
    return np.ascontiguousarray(picture[..., :3])


def _grey_of(depths: NDArray[Any]) -> NDArray[np.uint8]:
    """Depths as brightness, scaled to the image's range."""
    metres = depths.astype(np.float32)
    there = np.isfinite(metres) & (metres > 0)
    grey = np.zeros(depths.shape, dtype=np.uint8)
    if there.any():
        near, far = float(metres[there].min()), float(metres[there].max())
        share = 1 - (metres[there] - near) / max(far - near, 1e-6)
        grey[there] = (_DARKEST + share * (255 - _DARKEST)).astype(np.uint8)
    return np.repeat(grey[..., None], 3, axis=2)


def _from_mosaic(mosaic: NDArray[np.uint8], encoding: str) -> NDArray[np.uint8]:
    """Converts each 2 x 2 block to one colour, which is enough for display."""
    height, width = mosaic.shape
    padded = np.pad(mosaic, ((0, height % 2), (0, width % 2)), mode="edge")
    filters = encoding.removeprefix("bayer_")[:4]
    sums = np.zeros((*(size // 2 for size in padded.shape), 3), dtype=np.uint16)
    for index, letter in enumerate(filters):
        row, column = divmod(index, 2)
        sums[..., "rgb".index(letter)] += padded[row::2, column::2]
    sums[..., 1] //= 2
    whole = np.repeat(np.repeat(sums.astype(np.uint8), 2, axis=0), 2, axis=1)
    return np.ascontiguousarray(whole[:height, :width])


def _caption(text: str) -> str:
    return f'<div class="cw cw-dim cw-caption">{text}</div>'
