"""A folder with images, labels, scans and poses."""

from __future__ import annotations

import contextlib
import json
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any, Self

import numpy as np
from numpy.typing import NDArray

from cartwheel import arrays
from cartwheel.codes.command import OUTPUT_NOT_WRITTEN
from cartwheel.dataset.coco import annotation
from cartwheel.dataset.labels import Granularity, Labels
from cartwheel.dataset.viewpoint import Viewpoint, invalid
from cartwheel.errors import CartwheelError
from cartwheel.geometry import Pose

if TYPE_CHECKING:
    from cartwheel.api import World

_MILLIMETRES = 1000.0
_DEEPEST = 65535
"""Largest number of a pixel in a depth image."""


class Dataset:
    """Writes samples of a world to a new folder. Close it, or use it in a ``with`` block.

    With the same world, seed and versions, all files have the same bits.

    Args:
        folder: Must not exist, or be empty.
        world: The world.
        cameras: Cameras: a `Viewpoint`, or the name of a robot's camera as ``model::camera``, whose
            noise and distortion are omitted.
        scans: Topics of LaserScan messages, of which each sample has the newest.
        objects: Whether each model ("models") or each link ("links") is an object with a label.
        categories: Categories of objects by patterns of their names, such as
            ``{"brick_*": "brick", "ground_plane": None}``; see `Labels`.

    Raises:
        CartwheelError: An argument is invalid, or the folder cannot be written.
    """

    def __init__(
        self,
        folder: str | Path,
        world: World,
        *,
        cameras: Sequence[Viewpoint | str] = (),
        scans: Sequence[str] = (),
        objects: Granularity = "models",
        categories: Mapping[str, str | None] | None = None,
    ) -> None:
        self._world, self._folder = world, Path(folder)
        self._labels = Labels(objects, categories or {})
        self._cameras = [
            each if isinstance(each, Viewpoint) else self._mounted(each) for each in cameras
        ]
        names = [each.name for each in self._cameras]
        if not names and not scans:
            raise invalid("a dataset needs a camera or a scan")
        if len(set(names)) < len(names):
            raise invalid("two cameras have the same name")
        for each in self._cameras:
            self._pose(each)
        self._scans = {_file(topic): world.topic(topic) for topic in scans}
        if len(self._scans) < len(scans):
            raise invalid("the topics of two scans have the same file name")
        self._images: list[dict[str, Any]] = []
        self._annotations: list[dict[str, Any]] = []
        self._samples = 0
        self._closed = False
        with self._writing():
            if self._folder.exists() and any(self._folder.iterdir()):
                raise invalid(f'the folder "{folder}" is not empty')
            for name in names:
                for kind in ("images", "depth", "instances", "semantic"):
                    (self._folder / kind / name).mkdir(parents=True)
            for name in self._scans:
                (self._folder / "scans" / name).mkdir(parents=True)
            self._folder.mkdir(parents=True, exist_ok=True)

    def capture(self) -> int:
        """Writes a sample of the current state; returns its number, from 0.

        Raises:
            CartwheelError: The dataset is closed, a scan has no message yet, a camera's link does
                not exist any more, or a file cannot be written.
            NoOpenGLError: OpenGL is missing; the hint says what to install.
        """
        if self._closed:
            raise invalid("the dataset is closed")
        number = self._samples
        scans = {name: arrays.scan(topic.latest) for name, topic in self._scans.items()}
        with self._writing():
            for name, found in scans.items():
                np.savez(
                    self._folder / "scans" / name / f"{number:06}.npz",
                    ranges=found.ranges, angles=found.angles, intensities=found.intensities,
                    limits=np.array([found.range_min, found.range_max]),
                )  # fmt: skip
            cameras = {each.name: self._photograph(each, number) for each in self._cameras}
            line = {"sample": number, "time": self._world.time, "cameras": cameras}
            line["models"] = {
                name: {
                    "pose": _plain(self._world.model(name).pose),
                    "links": {
                        link: _plain(self._world.model(name).link(link).pose)
                        for link in self._world.model(name).links
                    },
                }
                for name in self._world.models
            }
            with (self._folder / "poses.jsonl").open("a", encoding="utf-8") as file:
                file.write(json.dumps(line) + "\n")
        self._samples += 1
        return number

    def close(self) -> None:
        """Writes ``annotations.json``. Further calls have no effect."""
        if self._closed:
            return
        self._closed = True
        contents = {
            "images": self._images,
            "annotations": self._annotations,
            "categories": [
                {"id": number, "name": name} for name, number in self._labels.categories.items()
            ],
            "objects": [
                {"id": number, "name": name} for name, number in self._labels.objects.items()
            ],
        }
        with self._writing():
            text = json.dumps(contents)
            (self._folder / "annotations.json").write_text(text, encoding="utf-8")

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def _photograph(self, camera: Viewpoint, number: int) -> dict[str, Any]:
        pose, file = self._pose(camera), f"{camera.name}/{number:06}.png"
        with self._world._used() as simulation:
            simulation.refresh()
            renderer = simulation.engine.renderer
            seen = renderer.render_labelled(pose, camera.lens)
            instances = np.zeros(seen.bodies.shape, dtype=np.uint16)
            semantic = np.zeros_like(instances)
            image = {
                "id": len(self._images) + 1, "file_name": f"images/{file}", "width": camera.width,
                "height": camera.height, "sample": number, "camera": camera.name,
            }  # fmt: skip
            for label, members in self._labels.add(seen.names).items():
                visible = np.isin(seen.bodies, members)
                instance, category = self._labels.number(label)
                if not visible.any():
                    continue
                instances[visible], semantic[visible] = instance, category
                whole = renderer.render_alone(pose, camera.lens, members)
                self._annotations.append({
                    "id": len(self._annotations) + 1, "image_id": image["id"],
                    "category_id": category, "object_id": instance, **annotation(visible, whole),
                })  # fmt: skip
        self._images.append(image)
        depths = np.where(np.isfinite(seen.depths), seen.depths, 0.0) * _MILLIMETRES
        depths[depths > _DEEPEST] = 0.0
        pictures: dict[str, NDArray[Any]] = {
            "images": seen.pixels, "depth": np.round(depths).astype(np.uint16),
            "instances": instances, "semantic": semantic,
        }  # fmt: skip
        for kind, pixels in pictures.items():
            _save(pixels, self._folder / kind / file)
        return {"pose": _plain(pose), "matrix": camera.matrix}

    def _pose(self, camera: Viewpoint) -> Pose:
        """Pose in the world."""
        if not camera.link:
            return camera.pose
        model, _, link = camera.link.partition("::")
        return self._world.model(model).link(link).pose @ camera.pose

    def _mounted(self, name: str) -> Viewpoint:
        """A camera of a robot."""
        model, _, camera = name.partition("::")
        self._world.model(model)
        with self._world._used() as simulation:
            mounts = simulation.truth.cameras(model)
        for mount in mounts:
            if mount.name == camera:
                lens = mount.intrinsics
                return Viewpoint(
                    name=_file(name), link=f"{model}::{mount.link}", pose=mount.pose,
                    width=lens.width, height=lens.height, fov=lens.horizontal_fov, near=lens.near,
                    far=lens.far,
                )  # fmt: skip
        raise invalid(
            f'there is no camera "{name}"',
            hint="Cameras of this model: "
            + (", ".join(f"{model}::{each.name}" for each in mounts) or "none")
            + ".",
        )

    @contextlib.contextmanager
    def _writing(self) -> Iterator[None]:
        try:
            yield
        except OSError as error:
            raise CartwheelError(
                f"{self._folder} cannot be written: {error.strerror}", code=OUTPUT_NOT_WRITTEN,
                values={"path": str(self._folder)},
            ) from None  # fmt: skip


def _save(pixels: NDArray[Any], file: Path) -> None:
    from PIL import Image

    Image.fromarray(pixels).save(file)


def _file(name: str) -> str:
    """A name of a camera or topic as the name of a folder."""
    return name.strip("/").replace("::", "_").replace("/", "_")


def _plain(pose: Pose) -> dict[str, list[float]]:
    """Position in m, and orientation as x, y, z, w."""
    return {"position": list(pose.position), "orientation": list(pose.orientation)}
