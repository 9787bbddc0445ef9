"""The published ``sensor_msgs/CameraInfo`` of a camera, which ``set_camera_info`` can replace."""

from __future__ import annotations

import dataclasses
from dataclasses import dataclass
from typing import Any

import numpy as np

from cartwheel.description.model import Pinhole
from cartwheel.devices.cameras.lens import Lens
from cartwheel.geometry import Array
from cartwheel.messages import header, message_class, service_classes

INFO = "sensor_msgs/msg/CameraInfo"
SET_INFO = "sensor_msgs/srv/SetCameraInfo"


@dataclass(frozen=True, kw_only=True, slots=True)
class Rectified:
    """Entries of R and P. None keeps the entry of the identity (R) or of K (P)."""

    rotation: tuple[float, ...] | None = None
    """R, row by row."""
    fx: float | None = None
    fy: float | None = None
    cx: float | None = None
    cy: float | None = None
    """Pixels."""
    tx: float | None = None
    ty: float = 0.0
    """Last column of P."""


UNCHANGED = Rectified()
"""R is the identity, and P has the entries of K."""


@dataclass(frozen=True, kw_only=True, slots=True)
class CalibrationConfig:
    """Entries of a CameraInfo that do not follow from the lens."""

    focal_length: float = 0.0
    """Pixels; 0: computed from the field of view."""
    centre: tuple[float, float] = (0.0, 0.0)
    """Principal point, pixels; 0: (size + 1) / 2."""
    pinhole: Pinhole | None = None
    """Focal lengths and principal point that replace these."""
    baseline: float = 0.0
    """Distance to the right of the left camera of a stereo pair, m."""
    rectified: Rectified = UNCHANGED


class Calibration:
    """CameraInfo of a camera.

    Args:
        lens: The rendered lens.
        frame: Frame ID of the messages.
        config: Entries that do not follow from the lens.
    """

    def __init__(self, lens: Lens, frame: str, config: CalibrationConfig) -> None:
        self._frame = frame
        self.width, self.height = lens.intrinsics.width, lens.intrinsics.height
        focal = fy = config.focal_length or lens.focal
        cx = config.centre[0] or (self.width + 1) / 2
        cy = config.centre[1] or (self.height + 1) / 2
        if config.pinhole is not None:
            focal, fy = config.pinhole.fx, config.pinhole.fy
            cx, cy = config.pinhole.cx, config.pinhole.cy
        rectified = config.rectified
        self.info = message_class(INFO)(
            header=header(0, frame),
            height=self.height,
            width=self.width,
            distortion_model="plumb_bob",
            d=np.array(lens.distortion.coefficients, dtype=float),
            k=np.array([focal, 0, cx, 0, fy, cy, 0, 0, 1]),
            r=np.eye(3).ravel() if rectified.rotation is None else np.array(rectified.rotation),
            p=projection(rectified, focal, cx, cy, config.baseline),
        )
        """The published message without its stamp."""
        self._response = service_classes(SET_INFO)[1]

    def message(self, now: int) -> Any:
        """Returns the message for a time in ns."""
        return dataclasses.replace(self.info, header=header(now, self._frame))

    def set(self, request: Any) -> Any:
        """Serves ``set_camera_info``: replaces the published message. The image does not change."""
        given = request.camera_info
        if (given.width, given.height) != (self.width, self.height):
            return self._response(
                success=False,
                status_message=f"the calibration is for {given.width} x {given.height} pixels, "
                f"but the camera has {self.width} x {self.height}",
            )
        self.info = given
        return self._response(success=True)


def projection(rectified: Rectified, focal: float, cx: float, cy: float, baseline: float) -> Array:
    """Returns P, row by row, for the focal length and principal point of K in pixels.

    Args:
        rectified: Entries that differ from K.
        focal: Focal length, pixels.
        cx: x of the principal point, pixels.
        cy: y of the principal point, pixels.
        baseline: Distance to the right of the left camera of a stereo pair, m.
    """
    fx, fy = _or_default(rectified.fx, focal), _or_default(rectified.fy, focal)
    cx, cy = _or_default(rectified.cx, cx), _or_default(rectified.cy, cy)
    tx = _or_default(rectified.tx, -focal * baseline)
    return np.array([fx, 0, cx, tx, 0, fy, cy, rectified.ty, 0, 0, 1, 0], dtype=float)


def _or_default(value: float | None, default: float) -> float:
    return default if value is None else value
