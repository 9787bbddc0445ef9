"""A lens: the pinhole image to render, and the point in that image that each pixel shows."""

from __future__ import annotations

import dataclasses
import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from cartwheel.description.model import CameraIntrinsics, Pinhole

Floats = NDArray[np.float64]

_INVISIBLE = 0.02
"""Pixels; smaller distortions are not rendered."""
_WIDEST = 4
"""Maximum width and height of the rendered image, relative to the final image."""
_ROUNDS = 40
_CLOSE = 1e-10
_ONE = 256
"""Weight of a whole pixel."""


@dataclass(frozen=True, kw_only=True, slots=True)
class Distortion:
    """Brown-Conrady distortion model, ``plumb_bob`` in ROS.

    Source: sensor_msgs/CameraInfo; OpenCV, Camera Calibration and 3D Reconstruction.
    """

    k1: float = 0.0
    k2: float = 0.0
    p1: float = 0.0
    p2: float = 0.0
    k3: float = 0.0

    @property
    def coefficients(self) -> tuple[float, float, float, float, float]:
        """Coefficients in the order of `CameraInfo.d`: k1, k2, t1, t2, k3."""
        return (self.k1, self.k2, self.p1, self.p2, self.k3)

    def apply(self, x: Floats, y: Floats) -> tuple[Floats, Floats]:
        """Returns the distorted position of a point at depth 1, x to the right, y down."""
        r2 = x * x + y * y
        radial = 1 + r2 * (self.k1 + r2 * (self.k2 + r2 * self.k3))
        return (
            x * radial + 2 * self.p1 * x * y + self.p2 * (r2 + 2 * x * x),
            y * radial + self.p1 * (r2 + 2 * y * y) + 2 * self.p2 * x * y,
        )

    def invert(self, x: Floats, y: Floats) -> tuple[Floats, Floats]:
        """Returns the undistorted points for x, y; nan where the distortion has no inverse.

        A strong distortion folds the plane; only points within the fold are returned.
        """
        fold = self._fold()
        u, v = x.copy(), y.copy()
        for _ in range(_ROUNDS):
            _limit_radius(u, v, fold)
            r2 = u * u + v * v
            radial = 1 + r2 * (self.k1 + r2 * (self.k2 + r2 * self.k3))
            slope = 2 * (self.k1 + r2 * (2 * self.k2 + r2 * 3 * self.k3))
            a = radial + u * u * slope + 2 * self.p1 * v + 6 * self.p2 * u
            b = u * v * slope + 2 * self.p1 * u + 2 * self.p2 * v
            d = radial + v * v * slope + 6 * self.p1 * v + 2 * self.p2 * u
            applied_u, applied_v = self.apply(u, v)
            error_u, error_v = x - applied_u, y - applied_v
            if not max(np.abs(error_u).max(), np.abs(error_v).max()) > _CLOSE:
                break
            determinant = a * d - b * b
            determinant[np.abs(determinant) < 1e-9] = 1e-9
            u = u + (d * error_u - b * error_v) / determinant
            v = v + (a * error_v - b * error_u) / determinant
        applied_u, applied_v = self.apply(u, v)
        invalid = ~(np.hypot(applied_u - x, applied_v - y) < 1e-6) | (np.hypot(u, v) > fold)
        u[invalid] = v[invalid] = math.nan
        return u, v

    def _fold(self) -> float:
        """Radius of the fold. Points beyond it are imaged closer to the centre again."""
        roots = np.roots([7 * self.k3, 5 * self.k2, 3 * self.k1, 1.0])
        real = [root.real for root in roots if abs(root.imag) < 1e-9 and root.real > 0]
        return math.sqrt(min(real)) if real else math.inf


def _limit_radius(u: Floats, v: Floats, radius: float) -> None:
    """Moves points beyond `radius` to slightly inside of it."""
    if math.isinf(radius):
        return
    far = np.hypot(u, v)
    scale = np.where(far > 0.999 * radius, 0.999 * radius / np.maximum(far, 1e-12), 1.0)
    u *= scale
    v *= scale


class Lens:
    """Maps the rendered pinhole image to the image of a lens with distortion.

    Args:
        intrinsics: The final image; its own distortion and pinhole are ignored.
        distortion: Distortion of the lens.
        pinhole: Focal lengths and principal point; None for those of the field of view.
    """

    def __init__(
        self,
        intrinsics: CameraIntrinsics,
        distortion: Distortion,
        pinhole: Pinhole | None = None,
    ) -> None:
        self.intrinsics = intrinsics
        self.distortion = distortion
        width, height = intrinsics.width, intrinsics.height
        self.focal = width / (2 * math.tan(intrinsics.horizontal_fov / 2))
        """Focal length, pixels."""
        self.rendered = intrinsics
        """The pinhole image to render, larger than the final image for barrel distortion."""
        centred = Pinhole(fx=self.focal, fy=self.focal, cx=width / 2, cy=height / 2)
        self._pinhole = pinhole or centred
        self._x, self._y = _directions(centred, width, height)
        self._map: _Map | None = None
        if any(distortion.coefficients) or pinhole is not None:
            self._distort()

    def _distort(self) -> None:
        image, pinhole = self.intrinsics, self._pinhole
        x, y = _directions(pinhole, image.width, image.height)
        if any(self.distortion.coefficients):
            # The distortion is centred at the point in the description.
            cx = (image.distortion_center[0] * image.width - pinhole.cx) / pinhole.fx
            cy = (image.distortion_center[1] * image.height - pinhole.cy) / pinhole.fy
            x, y = self.distortion.invert(x - cx, y - cy)
            x, y = x + cx, y + cy
        moved = np.hypot(x - self._x, y - self._y) * self.focal
        if not (np.isnan(moved).any() or moved.max() > _INVISIBLE):
            return
        self._x, self._y = x, y
        width = _even(2 * self.focal * _reach(x), image.width)
        height = _even(2 * self.focal * _reach(y), image.height)
        self.rendered = dataclasses.replace(
            image,
            width=width,
            height=height,
            horizontal_fov=2 * math.atan(width / (2 * self.focal)),
        )
        self._map = _Map(x * self.focal + width / 2, y * self.focal + height / 2, width, height)

    def rays(self) -> tuple[Floats, Floats]:
        """Returns the direction of each pixel's centre, at depth 1: right and down."""
        return self._x, self._y

    def image(self, picture: NDArray[np.uint8]) -> NDArray[np.uint8]:
        """Returns the distorted image, shape (height, width, 3); black where no light enters."""
        return picture if self._map is None else self._map.blend(picture)

    def depths(self, picture: NDArray[np.float32]) -> NDArray[np.float32]:
        """Returns distorted depths in m, shape (height, width); nan where no light enters.

        Depths are not interpolated: between an object and its background there is no surface.
        """
        return picture if self._map is None else self._map.pick(picture)


def _directions(pinhole: Pinhole, width: int, height: int) -> tuple[Floats, Floats]:
    """Returns the direction of each pixel's centre, at depth 1, shape (height, width)."""
    x = (np.arange(width) + 0.5 - pinhole.cx) / pinhole.fx
    y = (np.arange(height) + 0.5 - pinhole.cy) / pinhole.fy
    return np.broadcast_to(x, (height, width)), np.broadcast_to(y[:, None], (height, width))


def _reach(values: Floats) -> float:
    return float(np.nanmax(np.abs(values))) if not np.isnan(values).all() else 0.0


def _even(pixels: float, least: int) -> int:
    """Returns the even rendered size for a width in pixels, with a margin for interpolation."""
    most = _WIDEST * least
    return min(most, max(least, 2 * math.ceil(pixels / 2) + 2))


class _Map:
    """The four neighbours of each pixel in the rendered image, for bilinear interpolation.

    Args:
        u: Position from the left edge of the rendered image, pixels; nan for none.
        v: Position from its upper edge, pixels.
        width: Of the rendered image.
        height: Of the rendered image.
    """

    def __init__(self, u: Floats, v: Floats, width: int, height: int) -> None:
        self.shape = u.shape
        with np.errstate(invalid="ignore"):
            self._outside = ~((u >= 0) & (u < width) & (v >= 0) & (v < height))
        u = np.where(self._outside, 0.0, u) - 0.5
        v = np.where(self._outside, 0.0, v) - 0.5
        left, top = np.floor(u).astype(np.int64), np.floor(v).astype(np.int64)
        part = np.round((u - left) * _ONE).astype(np.int64)
        below = np.round((v - top) * _ONE).astype(np.int64)
        right, low = np.minimum(left + 1, width - 1), np.minimum(top + 1, height - 1)
        left, top = np.maximum(left, 0), np.maximum(top, 0)
        first = (_ONE - part) * (_ONE - below) // _ONE
        second = part * (_ONE - below) // _ONE
        third = (_ONE - part) * below // _ONE
        corners = [
            (top * width + left, first),
            (top * width + right, second),
            (low * width + left, third),
            (low * width + right, _ONE - first - second - third),
        ]
        self._corners = [
            # A weight for each of the three colour channels.
            (index.ravel(), np.repeat(weight.ravel().astype(np.uint16), 3))
            for index, weight in corners
        ]
        near_u = np.clip(np.round(u), 0, width - 1).astype(np.int64)
        near_v = np.clip(np.round(v), 0, height - 1).astype(np.int64)
        self._nearest = near_v * width + near_u
        self._none = np.flatnonzero(self._outside.ravel())

    def blend(self, picture: NDArray[np.uint8]) -> NDArray[np.uint8]:
        flat = picture.reshape(-1, 3)
        mixed = np.full(3 * self._nearest.size, _ONE // 2, dtype=np.uint16)
        product = np.empty_like(mixed)
        for index, weight in self._corners:
            # The four weights add up to 256, and 256 times 255 fits into 16 bits.
            np.multiply(flat.take(index, axis=0).ravel(), weight, out=product, dtype=np.uint16)
            mixed += product
        mixed //= _ONE
        image: NDArray[np.uint8] = mixed.astype(np.uint8).reshape(*self.shape, 3)
        image.reshape(-1, 3)[self._none] = 0
        return image

    def pick(self, picture: NDArray[np.float32]) -> NDArray[np.float32]:
        depths: NDArray[np.float32] = picture.ravel().take(self._nearest)
        depths.ravel()[self._none] = np.nan
        return depths
