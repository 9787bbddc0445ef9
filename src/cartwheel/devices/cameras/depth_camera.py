"""The depth topics of a camera: depth images and coloured points."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from cartwheel.component import Component
from cartwheel.devices.cameras.compressed import CompressedDepths
from cartwheel.devices.cameras.formats import Pixels
from cartwheel.devices.cameras.imager import Imager
from cartwheel.devices.cameras.info import INFO
from cartwheel.devices.point_clouds import point_cloud2
from cartwheel.messages import header, message_class

Floats = NDArray[np.float32]

_MILLIMETRES = 1000.0
_FURTHEST = float(np.finfo(np.float32).max)

POINT = np.dtype(
    {
        "names": ["x", "y", "z", "rgb"],
        "formats": ["<f4", "<f4", "<f4", "<f4"],
        "offsets": [0, 4, 8, 16],
        "itemsize": 32,
    }
)
"""Layout of ``xyz`` and ``rgb`` as in sensor_msgs' PointCloud2Modifier."""


@dataclass(frozen=True, kw_only=True, slots=True)
class DepthConfig:
    """Topics, limits and encoding of a `DepthImager`."""

    depth_topic: str
    """Topic of the depth images."""
    points_topic: str = ""
    """Topic of the points; empty if they are not published."""
    info_topic: str = ""
    """Topic of the CameraInfo of the depths; empty if it is not published."""
    nearest: float = 0.0
    """Depths at or below this value are published as `beyond`, m."""
    furthest: float = np.inf
    """Depths at or above this value are published as `beyond`, m."""
    points_nearest: float | None = None
    """Lower limit of the points, m. Default: `nearest`."""
    points_furthest: float | None = None
    """Upper limit of the points, m. Default: `furthest`."""
    beyond: Literal["nan", "inf"] = "nan"
    """Value outside the limits: nan, or -inf if too near and inf if too far (REP 118)."""
    millimetres: bool = False
    """Publish 16UC1 in mm instead of 32FC1 in m; 0 means no depth."""
    compressed: bool = False
    """Whether ``<depth_topic>/compressedDepth`` is published."""
    optical: bool = True
    """Points with x right, y down, z forward; otherwise x forward, y left, z up."""


class DepthImager:
    """The depth topics of an `Imager`. The colour image comes from the same rendering.

    Args:
        owner: The camera.
        imager: The lens.
        config: Topics, limits and encoding.
        rate: Publish rate for listings, Hz.
    """

    def __init__(
        self, owner: Component, imager: Imager, config: DepthConfig, *, rate: float | None
    ) -> None:
        self._imager = imager
        self._config = config
        self._message = message_class("sensor_msgs/msg/Image")
        self._image = owner.advertise(
            config.depth_topic, "sensor_msgs/msg/Image", rate=rate, qos="sensor"
        )
        self._points = (
            owner.advertise(
                config.points_topic, "sensor_msgs/msg/PointCloud2", rate=rate, qos="sensor"
            )
            if config.points_topic
            else None
        )
        self._compressed = (
            CompressedDepths(owner, config.depth_topic, rate=rate) if config.compressed else None
        )
        self._info = (
            owner.advertise(config.info_topic, INFO, rate=rate, qos="sensor")
            if config.info_topic
            else None
        )
        right, down = imager.lens.rays()
        self._right, self._down = right.astype(np.float32), down.astype(np.float32)

    @property
    def needs_rendering(self) -> bool:
        """Whether the depth image or the points have subscribers, so that it must be rendered."""
        compressed = self._compressed is not None and self._compressed.wanted
        return compressed or self._image.wanted or self._points_wanted()

    @property
    def wanted(self) -> bool:
        """Whether one of the topics has subscribers."""
        return self.needs_rendering or (self._info is not None and self._info.wanted)

    def publish_info(self, now: int) -> None:
        """Publishes the calibration if it has subscribers."""
        if self._info is not None and self._info.wanted:
            self._info.publish(self._imager.calibration.message(now))

    def publish(self, now: int, pixels: Pixels, depths: Floats) -> None:
        """Publishes depths in m, and points with the colours of `pixels`."""
        moment = header(now, self._imager.frame)
        config = self._config
        clipped = clip(depths, config.nearest, config.furthest, beyond=config.beyond)
        if self._image.wanted:
            self._image.publish(self._depth_image(moment, clipped))
        if self._compressed is not None and self._compressed.wanted:
            self._compressed.publish(moment, clipped)
        if self._points is not None and self._points.wanted:
            near, far = config.points_nearest, config.points_furthest
            if near is not None or far is not None:
                near = config.nearest if near is None else near
                far = config.furthest if far is None else far
                clipped = clip(depths, near, far, beyond=config.beyond)
            dense = bool(np.isfinite(clipped).all())
            self._points.publish(point_cloud2(moment, self._cloud(pixels, clipped), dense=dense))

    def _points_wanted(self) -> bool:
        return self._points is not None and self._points.wanted

    def _depth_image(self, moment: Any, clipped: Floats) -> Any:
        height, width = clipped.shape
        data: NDArray[Any] = clipped.astype("<f4", copy=False)
        if self._config.millimetres:
            data = to_millimetres(clipped)
        return self._message(
            header=moment,
            height=height,
            width=width,
            encoding="16UC1" if self._config.millimetres else "32FC1",
            is_bigendian=0,
            step=width * data.itemsize,
            data=np.ascontiguousarray(data).reshape(-1).view(np.uint8),
        )

    def _cloud(self, pixels: Pixels, clipped: Floats) -> NDArray[np.void]:
        cloud = np.zeros(clipped.shape, dtype=POINT)
        infinite, optical = self._config.beyond == "inf", self._config.optical
        positions = points(clipped, self._right, self._down, infinite=infinite, optical=optical)
        for name, values in zip("xyz", positions, strict=True):
            cloud[name] = values
        colours = np.zeros((*clipped.shape, 4), dtype=np.uint8)
        # 0x00RRGGBB, little-endian.
        colours[..., 2], colours[..., 1], colours[..., 0] = np.moveaxis(pixels, -1, 0)
        cloud["rgb"] = colours.view("<f4")[..., 0]
        return cloud


def clip(
    depths: Floats, nearest: float, furthest: float, *, beyond: Literal["nan", "inf"]
) -> Floats:
    """Returns depths in m of which those outside the limits are marked; see `DepthConfig`."""
    # Limits are restricted to the range of float32.
    near = depths <= max(-_FURTHEST, min(nearest, _FURTHEST))
    far = depths >= max(-_FURTHEST, min(furthest, _FURTHEST))
    if beyond == "nan":
        # inf, where the ray hits nothing, also becomes nan if the limit is inf.
        return np.where(near | far, np.float32(np.nan), depths)
    return np.where(near, np.float32(-np.inf), np.where(far, np.float32(np.inf), depths))


def to_millimetres(depths: Floats) -> NDArray[np.uint16]:
    """Converts depths in m to mm; 0 if a depth is not finite or does not fit into 16 bits."""
    whole = np.nan_to_num(depths * _MILLIMETRES, nan=0.0, posinf=0.0, neginf=0.0)
    return np.where(whole > np.iinfo(np.uint16).max, 0, whole).astype("<u2")


def points(
    depths: Floats, right: Floats, down: Floats, *, infinite: bool, optical: bool
) -> tuple[Floats, Floats, Floats]:
    """Returns the coordinates of points, m.

    Args:
        depths: m.
        right: Direction of each pixel to the right, at depth 1.
        down: Direction of each pixel downward, at depth 1.
        infinite: Points at an infinite depth have three infinite coordinates.
        optical: x right, y down, z forward; otherwise x forward, y left, z up.
    """
    with np.errstate(invalid="ignore"):
        right, down = right * depths, down * depths
    if infinite:
        # All three coordinates get the same infinity. Multiplying it by the slope of a ray
        # would give the opposite sign on the left, and nan in the centre.
        missing = ~np.isfinite(depths)
        np.copyto(right, depths if optical else -depths, where=missing)
        np.copyto(down, depths if optical else -depths, where=missing)
    return (right, down, depths) if optical else (depths, -right, -down)
