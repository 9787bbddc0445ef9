"""Surfaces in the browser's scene: plain ones, and those with an image on them."""

from __future__ import annotations

from collections.abc import Callable
from functools import lru_cache
from pathlib import Path
from typing import Any

import numpy as np

from cartwheel.viewer.shapes import Surface, opened

_LARGEST = 1024
"""Pixels of an image's longer edge: a browser without a GPU has to draw it too."""


class Skin:
    """A node that is sent only what changes.

    Args:
        handle: viser's.
    """

    def __init__(self, handle: Any) -> None:
        self._handle = handle

    def show(self, visible: bool) -> None:
        """Shows or hides it."""
        if self._handle.visible != visible:
            self._handle.visible = visible

    def draw(self, opacity: float | None, wireframe: bool) -> None:
        """Makes it see-through, or wires; None is opaque."""
        if self._handle.opacity != opacity:
            self._handle.opacity = opacity
        if self._handle.wireframe != wireframe:
            self._handle.wireframe = wireframe

    def on_click(self, clicked: Any) -> None:
        """Tells of clicks on it."""
        self._handle.on_click(clicked)

    def remove_click_callback(self, clicked: Any) -> None:
        """Tells of them no longer."""
        self._handle.remove_click_callback(clicked)


class PicturedSkin(Skin):
    """A surface with its image, or where that cannot be, in its mean colour.

    The browser draws images neither see-through nor as wires. The plain surface is sent when it is
    first wanted.

    Args:
        handle: Of the surface with its image.
        add_plain: Adds it without, in place of the other.
    """

    def __init__(self, handle: Any, add_plain: Callable[[], Any]) -> None:
        super().__init__(handle)
        self._add_plain = add_plain
        self._plain: Skin | None = None
        self._visible, self._is_plain = True, False
        self._clicked: list[Any] = []

    def show(self, visible: bool) -> None:
        self._visible = visible
        super().show(visible and not self._is_plain)
        if self._plain is not None:
            self._plain.show(visible and self._is_plain)

    def draw(self, opacity: float | None, wireframe: bool) -> None:
        self._is_plain = opacity is not None or wireframe
        if self._is_plain and self._plain is None:
            self._plain = Skin(self._add_plain())
            for clicked in self._clicked:
                self._plain.on_click(clicked)
        if self._plain is not None:
            self._plain.draw(opacity, wireframe)
        self.show(self._visible)

    def on_click(self, clicked: Any) -> None:
        self._clicked.append(clicked)
        super().on_click(clicked)
        if self._plain is not None:
            self._plain.on_click(clicked)

    def remove_click_callback(self, clicked: Any) -> None:
        self._clicked.remove(clicked)
        super().remove_click_callback(clicked)
        if self._plain is not None:
            self._plain.remove_click_callback(clicked)


def glb_of(surface: Surface) -> bytes:
    """A surface with its image, as the browser reads it.

    Raises:
        OSError: The image cannot be read.
    """
    import trimesh

    visual: Any = trimesh.visual
    picture = surface.picture
    assert picture is not None
    # glTF's factors are of light, and not of what a screen is sent for it.
    factor = [*(channel**2.2 for channel in picture.tint[:3]), 1.0]
    material = visual.material.PBRMaterial(
        baseColorTexture=_reduced(picture.image),
        baseColorFactor=np.round(255 * np.array(factor)).astype(np.uint8),
        metallicFactor=0.0,
        roughnessFactor=0.9,
    )
    mesh = trimesh.Trimesh(
        vertices=surface.vertices,
        faces=surface.faces,
        visual=visual.TextureVisuals(uv=picture.uv, material=material),
        process=False,
    )
    made: Any = mesh.export(file_type="glb", include_normals=True)
    return bytes(made)


@lru_cache(maxsize=8)
def _reduced(source: Path | bytes) -> Any:
    from PIL import Image

    with Image.open(opened(source)) as image:
        image.load()
        reduced = image.convert("RGB")
    reduced.thumbnail((_LARGEST, _LARGEST))
    # By this name it is written into the file: a photograph takes a tenth of what it would as PNG.
    reduced.format = "JPEG"
    return reduced
