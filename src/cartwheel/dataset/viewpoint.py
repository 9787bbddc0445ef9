"""Cameras of a dataset."""

from __future__ import annotations

import math
import re
from dataclasses import dataclass
from typing import Any

from cartwheel.codes.world import DATASET_INVALID
from cartwheel.description.model import CameraIntrinsics
from cartwheel.errors import CartwheelError
from cartwheel.geometry import Pose

_LARGEST = 8192
"""Pixels."""
_NAME = re.compile(r"[A-Za-z0-9][A-Za-z0-9_.-]*")


@dataclass(frozen=True, kw_only=True)
class Viewpoint:
    """A camera of a dataset, besides those of the robots.

    Raises:
        CartwheelError: A value is invalid.
    """

    name: str
    """Name of its folders: letters, digits, ``_``, ``.`` and ``-``."""
    pose: Pose
    """Pose in the link. The camera looks along its x axis, with z up."""
    link: str = ""
    """Link that carries the camera, as ``model::link``; without one, the pose is in the world."""
    width: int = 640
    height: int = 480
    fov: float = 1.0
    """Horizontal field of view, rad."""
    near: float = 0.05
    far: float = 100.0
    """Clip distances, m."""

    def __post_init__(self) -> None:
        if not _NAME.fullmatch(self.name):
            raise invalid(f"{self.name!r:.60} is not the name of a camera's folder")
        for name in ("width", "height"):
            size: Any = getattr(self, name)
            if isinstance(size, bool) or not isinstance(size, int) or not 1 <= size <= _LARGEST:
                raise invalid(
                    f"the {name} must be a whole number from 1 to {_LARGEST} (got {size})"
                )
        if not 0 < self.fov < math.pi:
            raise invalid(f"the field of view must be between 0 and pi (got {self.fov})")
        if not 0 < self.near < self.far < math.inf:
            raise invalid(
                f"the clip distances must be positive and in order (got {self.near}, {self.far})"
            )

    @property
    def lens(self) -> CameraIntrinsics:
        """The lens, for the renderer."""
        return CameraIntrinsics(
            horizontal_fov=self.fov, width=self.width, height=self.height, near=self.near,
            far=self.far,
        )  # fmt: skip

    @property
    def matrix(self) -> list[list[float]]:
        """The camera matrix K: pixel (x + 0.5, y + 0.5) is the centre of a pixel."""
        focal = self.width / 2 / math.tan(self.fov / 2)
        return [[focal, 0.0, self.width / 2], [0.0, focal, self.height / 2], [0.0, 0.0, 1.0]]


def invalid(message: str, *, hint: str = "") -> CartwheelError:
    """The error of an invalid argument."""
    return CartwheelError(message, code=DATASET_INVALID, hint=hint)
