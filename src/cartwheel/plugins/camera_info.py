"""What ``sensor_msgs/CameraInfo`` tells of a camera, until somebody calibrates it anew."""

from __future__ import annotations

import dataclasses
from dataclasses import dataclass
from typing import Any

import numpy as np

from cartwheel.messages import header, message_class, service_classes
from cartwheel.plugins.camera_lens import Lens

INFO = "sensor_msgs/msg/CameraInfo"
SET_INFO = "sensor_msgs/srv/SetCameraInfo"


@dataclass(frozen=True, kw_only=True, slots=True)
class Rectified:
    """What R and P tell where it is not the identity and K: None is that."""

    turn: tuple[float, ...] | None = None
    """R, row by row."""
    fx: float | None = None
    fy: float | None = None
    cx: float | None = None
    cy: float | None = None
    """Pixels."""
    tx: float | None = None
    ty: float = 0.0
    """The last column of P."""


_PLAIN = Rectified()


class Calibration:
    """The numbers of a lens: the pinhole's, with Gazebo's centre and its stereo term.

    Args:
        lens: The one that draws the image.
        frame: Of the messages.
        focal_length: Pixels; 0 is that of the field of view.
        centre: Pixels; a 0 is (size + 1) / 2.
        baseline: m to the right of the pair's left camera.
        rectified: What is told of the rectified image; the same as of the image otherwise.
    """

    def __init__(
        self,
        lens: Lens,
        frame: str,
        *,
        focal_length: float = 0.0,
        centre: tuple[float, float] = (0.0, 0.0),
        baseline: float = 0.0,
        rectified: Rectified = _PLAIN,
    ) -> None:
        self._frame = frame
        self.width, self.height = lens.intrinsics.width, lens.intrinsics.height
        focal = focal_length or lens.focal
        cx = centre[0] or (self.width + 1) / 2
        cy = centre[1] or (self.height + 1) / 2
        self.told = message_class(INFO)(
            header=header(0, frame),
            height=self.height,
            width=self.width,
            distortion_model="plumb_bob",
            d=np.array(lens.distortion.coefficients, dtype=float),
            k=np.array([focal, 0, cx, 0, focal, cy, 0, 0, 1]),
            r=np.eye(3).ravel() if rectified.turn is None else np.array(rectified.turn),
            p=np.array(
                [
                    *(_told(rectified.fx, focal), 0, _told(rectified.cx, cx)),
                    _told(rectified.tx, -focal * baseline),
                    *(0, _told(rectified.fy, focal), _told(rectified.cy, cy), rectified.ty),
                    *(0, 0, 1, 0),
                ],
                dtype=float,
            ),
            binning_x=0,
            binning_y=0,
            roi=message_class("sensor_msgs/msg/RegionOfInterest")(
                x_offset=0, y_offset=0, height=0, width=0, do_rectify=False
            ),
        )
        """What is published, but for its stamp."""
        self._response = service_classes(SET_INFO)[1]

    def message(self, now: int) -> Any:
        """The calibration at a time in ns."""
        return dataclasses.replace(self.told, header=header(now, self._frame))

    def set(self, request: Any) -> Any:
        """Serves ``set_camera_info``: what is published from now on. The image stays as it is."""
        given = request.camera_info
        if (given.width, given.height) != (self.width, self.height):
            return self._response(
                success=False,
                status_message=f"this is for {given.width} x {given.height} pixels, and the camera "
                f"has {self.width} x {self.height}",
            )
        self.told = given
        return self._response(success=True, status_message="")


def _told(value: float | None, otherwise: float) -> float:
    return otherwise if value is None else value
