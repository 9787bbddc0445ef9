"""Pictures of a world, and its web interface, in notebooks and files."""

from __future__ import annotations

import html
import io
import math
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from cartwheel import arrays
from cartwheel.api.running import RunningWorld
from cartwheel.codes.world import NUMBER_OUT_OF_RANGE
from cartwheel.description.model import CameraIntrinsics
from cartwheel.errors import CartwheelError
from cartwheel.geometry import Array, Vec3
from cartwheel.simulation import Simulation
from cartwheel.simulation.limits import number, numbers
from cartwheel.simulation.sensing.views import Image

_LARGEST = 8192
"""Largest width and height of a picture, pixels."""
_FOV = 0.9
"""Horizontal field of view of pictures, rad."""
_AZIMUTH, _ELEVATION = math.radians(-138.0), math.radians(24.0)
"""Direction of the camera as seen from the models."""
_SMALLEST, _WIDEST = 0.15, 30.0
"""m; limits of the radius that a picture shows."""
_MARGIN = 1.15
"""Distance of the camera, relative to the smallest distance at which all models are visible."""


class Picture:
    """An image that notebooks display.

    Args:
        pixels: Shape (height, width, 3), RGB, uint8.
    """

    @classmethod
    def of(cls, source: Any) -> Picture:
        """The picture of an image message or an array, for display.

        Args:
            source: ``sensor_msgs/Image``, ``sensor_msgs/CompressedImage``, or an array of shape
                (height, width), (height, width, 3) or (height, width, 4). Values that are not
                uint8, such as depths, are scaled from black, the smallest, to white; values that
                are not finite are black.

        Raises:
            GraphError: The message is inconsistent, or has an unknown encoding.
            CartwheelError: The array has a different shape.
        """
        pixels: Any = arrays.image(source) if hasattr(source, "__msgtype__") else source
        pixels = np.asarray(pixels)
        channels = pixels.shape[2] if pixels.ndim == 3 else 1
        if pixels.ndim not in (2, 3) or channels not in (1, 3, 4) or not pixels.size:
            raise CartwheelError(
                f"an array of shape {pixels.shape} is not an image",
                code=NUMBER_OUT_OF_RANGE,
                values={"name": "shape", "value": str(pixels.shape)},
                hint="Pass an array of shape (height, width), (height, width, 3) or "
                "(height, width, 4).",
            )
        pixels = pixels.reshape(*pixels.shape[:2], channels)[..., :3]
        if pixels.dtype != np.uint8:
            pixels = _scaled(pixels.astype(float))
        return cls(np.ascontiguousarray(np.broadcast_to(pixels, (*pixels.shape[:2], 3))))

    def __init__(self, pixels: Image) -> None:
        self.pixels: Image = pixels
        """Shape (height, width, 3), RGB, uint8."""

    def __array__(self, dtype: Any = None, copy: bool | None = None) -> np.ndarray[Any, Any]:
        if dtype is None and not copy:
            return self.pixels
        return np.array(self.pixels, dtype=dtype)

    def __repr__(self) -> str:
        height, width, _ = self.pixels.shape
        return f"<Picture {width} x {height}>"

    def save(self, file: str | Path) -> None:
        """Writes the picture to a file.

        Args:
            file: The suffix selects the format: ``.png``, ``.jpg``, ``.webp`` and others.

        Raises:
            ValueError: The suffix is unknown.
            OSError: The file cannot be written.
        """
        from PIL import Image as Images

        Images.fromarray(self.pixels).save(file)

    def _repr_png_(self) -> bytes:
        from PIL import Image as Images

        file = io.BytesIO()
        Images.fromarray(self.pixels).save(file, format="PNG")
        return file.getvalue()


@dataclass(frozen=True, slots=True)
class Page:
    """The web interface, which notebooks display in the cell's output."""

    url: str
    """Address for browsers on this computer."""
    frame: str | None
    """Address for a frame in another page. It contains a key, which is valid until the world is
    closed. None if browsers need a token, which they do not send from a frame."""
    width: str
    height: int

    def _repr_html_(self) -> str:
        url = html.escape(self.url)
        link = f'<a href="{url}" target="_blank" rel="noopener">Open the web interface</a>'
        if self.frame is None:
            return link
        return (
            f'<iframe src="{html.escape(self.frame)}" width="{html.escape(self.width)}" '
            f'height="{self.height}" style="border: 0" allow="fullscreen"></iframe>'
            f"<div>{link}</div>"
        )

    def __repr__(self) -> str:
        return self.url


class PicturedWorld(RunningWorld):
    """The part of `World` that shows it."""

    def picture(
        self,
        width: int = 640,
        height: int = 480,
        *,
        eye: Vec3 | None = None,
        target: Vec3 | None = None,
    ) -> Picture:
        """Renders the world, independently of the cameras of the models.

        A closed world is rendered in its last state.

        Args:
            width: Pixels, 1 to 8192.
            height: Pixels, 1 to 8192.
            eye: Position of the camera in the world, m. None: all models that can move are visible.
            target: Point in the centre of the picture, m. None: the middle of these models.

        Raises:
            NoOpenGLError: OpenGL is missing; the hint says what to install.
            ForkedError: This process was forked from a process that had rendered an image.
            CartwheelError: A number is out of range, or `eye` and `target` are equal.
        """
        for name, size in (("the width", width), ("the height", height)):
            if not 1 <= number(size, name) <= _LARGEST or size != int(size):
                raise CartwheelError(
                    f"{name} must be a whole number from 1 to {_LARGEST} (got {size})",
                    code=NUMBER_OUT_OF_RANGE,
                    values={"name": name, "value": size},
                )
        # A closed world shows its last state.
        with self.lock if self.session.simulation.closed else self._used():
            simulation = self.session.simulation
            middle, radius = _movable(simulation)
            target = middle if target is None else _point(target, "target")
            # The narrower side must show the whole sphere.
            half = math.atan(math.tan(_FOV / 2) * min(1.0, height / width))
            far = _MARGIN * radius / math.sin(half)
            eye = _beside(target, far) if eye is None else _point(eye, "eye")
            away = math.dist(eye, target)
            if not away:
                raise CartwheelError(
                    "the points eye and target must differ",
                    code=NUMBER_OUT_OF_RANGE,
                    values={"name": "eye", "value": 0.0},
                )
            lens = CameraIntrinsics(
                horizontal_fov=_FOV,
                width=int(width),
                height=int(height),
                near=min(0.01, 0.1 * away),
                far=max(100.0, 10.0 * away),
            )
            simulation.refresh()
            try:
                return Picture(simulation.engine.renderer.render_from(eye, target, lens))
            finally:
                if simulation.closed:
                    simulation.engine.renderer.close()

    def view(
        self, port: int | None = None, *, width: int | str = "100%", height: int = 480
    ) -> Page:
        """Starts the web interface, and shows it in the output of a notebook's cell.

        The frame shows the world while cells run it, and between two runs. Elsewhere, open the
        printed address.

        Args:
            port: As for `show`.
            width: Width of the frame in pixels, or as in CSS.
            height: Height of the frame, pixels.

        Raises:
            ControlError: The port is not available, or the web interface cannot start.
            SimulationError: The world is closed.
        """
        url = self.show(port)
        with self._used():
            frame = self._connected().assembly.access.framed(url)
        return Page(url, frame, str(width), int(number(height, "the height")))


def _scaled(values: Array) -> Any:
    """Brightnesses from 0 to 255 of any values."""
    known = np.isfinite(values)
    if not known.any():
        return np.zeros(values.shape, dtype=np.uint8)
    low, high = values[known].min(), values[known].max()
    share = np.where(known, values - low, 0.0) / ((high - low) or 1.0)
    return np.round(255 * share).astype(np.uint8)


def _point(point: Vec3, name: str) -> Vec3:
    x, y, z = point
    numbers((x, y, z), name)
    return float(x), float(y), float(z)


def _movable(simulation: Simulation) -> tuple[Vec3, float]:
    """The centre and radius of a sphere around all models that can move; m, in the world."""
    model, data = simulation.model, simulation.data
    # A body that cannot move is welded to the world.
    bodies = [body for body in range(1, model.nbody) if model.body_weldid[body]]
    centres = data.xpos[bodies]
    radii = np.zeros(len(bodies))
    if bodies:
        solid = np.isin(model.geom_bodyid, bodies)
        centres = np.concatenate([centres, data.geom_xpos[solid]])
        radii = np.concatenate([radii, model.geom_rbound[solid]])
    if not len(centres):
        return (0.0, 0.0, 0.0), 1.0
    low, high = (centres - radii[:, None]).min(axis=0), (centres + radii[:, None]).max(axis=0)
    middle = (low + high) / 2
    reach = float(np.max(np.linalg.norm(centres - middle, axis=1) + radii))
    x, y, z = middle.tolist()
    return (x, y, z), min(max(reach, _SMALLEST), _WIDEST)


def _beside(target: Vec3, distance: float) -> Vec3:
    """The position of a camera at a distance from a point."""
    level = distance * math.cos(_ELEVATION)
    return (
        target[0] + level * math.cos(_AZIMUTH),
        target[1] + level * math.sin(_AZIMUTH),
        target[2] + distance * math.sin(_ELEVATION),
    )
