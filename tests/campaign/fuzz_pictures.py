"""Pictures: as a heightmap, as a texture of the renderer, and as one of the page."""

from __future__ import annotations

import io
import itertools
from pathlib import Path

from tests.campaign.target import Target

from cartwheel.errors import CartwheelError

_numbers = itertools.count()


def _seeds() -> list[bytes]:
    import numpy as np
    from PIL import Image

    grey = (np.arange(24 * 16) % 251).reshape(16, 24).astype(np.uint8)
    colour = Image.fromarray(np.stack([grey, grey.T.reshape(16, 24), 255 - grey], axis=2))
    made = []
    for mode, kinds in {
        "RGB": ("PNG", "JPEG", "BMP", "GIF", "TGA", "TIFF", "WEBP", "PPM", "DDS", "ICO", "EPS"),
        "L": ("PNG", "JPEG", "TIFF"),
        "P": ("PNG", "GIF"),
        "1": ("PNG", "TIFF"),
        "RGBA": ("PNG", "TGA", "WEBP"),
        "LA": ("PNG",),
        "CMYK": ("JPEG", "TIFF"),
    }.items():
        for kind in kinds:
            buffer = io.BytesIO()
            colour.convert(mode).save(buffer, format=kind)
            made.append(buffer.getvalue())
    deep = Image.fromarray(grey.astype(np.uint16) * 257)
    floats = Image.fromarray(grey.astype(np.float32))
    for image, kind in ((deep, "PNG"), (deep, "TIFF"), (floats, "TIFF")):
        buffer = io.BytesIO()
        image.save(buffer, format=kind)
        made.append(buffer.getvalue())
    return made


def _run_one(data: bytes) -> None:
    import numpy as np

    from cartwheel.description.model import Heightmap
    from cartwheel.description.shapes.terrain import heights_of
    from cartwheel.viewer.shapes import _mean_colour
    from cartwheel.viewer.skins import _reduced
    from cartwheel.world.shapes import _pixels

    path = Path(f"picture{next(_numbers)}.png").resolve()
    path.write_bytes(data)
    refused: list[str] = []
    try:
        for read in (
            lambda: np.isfinite(heights_of(Heightmap(path=path, size=(1.0, 1.0, 1.0)))).all(),
            lambda: isinstance(_pixels(path, 0), CartwheelError) or _pixels(path, 0).shape[2] == 3,
            lambda: _reduced(path).size,
            lambda: _mean_colour(path) is None or len(_mean_colour(path)) == 4,
        ):
            try:
                assert read()
            except CartwheelError as error:
                refused.append(str(error))  # an error holds the picture
    finally:
        path.unlink()
    if refused:
        raise CartwheelError(refused[0])


TARGETS = (Target(name="pictures", seeds=_seeds, run_one=_run_one, allowed=(CartwheelError,)),)
