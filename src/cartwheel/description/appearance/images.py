"""Reads image files for heightmaps and textures, with limits on their decoded size."""

from __future__ import annotations

import io
import warnings
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from cartwheel.codes.files import FILE_MISSING, PICTURE_UNREADABLE
from cartwheel.description.files.regular_files import read_regular
from cartwheel.errors import Code, DescriptionError

FORMATS = ("PNG", "JPEG", "BMP", "GIF", "TGA", "TIFF", "WEBP", "DDS", "PPM")
"""Pillow supports more formats, but starts other programs for some of them."""
MOST_PIXELS = 8193 * 8193
"""The largest heightmap used in Gazebo; 64 MiB in grey, 256 MiB in colour."""

MOST_BYTES = 1 << 28
"""Maximum file size: the same number of pixels with 4 bytes."""


class PictureError(DescriptionError):
    """An image that cannot be used.

    Args:
        name: The name for users.
        reason: What is wrong with it.
        hint: The likely fix.
        code: Replaces `PICTURE_UNREADABLE`.
    """

    code = PICTURE_UNREADABLE

    def __init__(
        self, name: str, reason: str, hint: str | None = None, *, code: Code | None = None
    ) -> None:
        self.name, self.reason = name, reason
        super().__init__(
            f'the image "{name}" cannot be read: {reason}',
            code=code,
            hint=hint,
            values={"kind": "picture", "name": name},
        )


@contextmanager
def open_picture(source: Path | bytes) -> Iterator[Any]:
    """A Pillow image from a file or its contents; pixels are decoded when they are accessed.

    Raises:
        PictureError: The image is missing, damaged, too large, or in an unsupported format. Other
            errors of Pillow within the ``with`` block are also converted.
    """
    from PIL import Image, UnidentifiedImageError

    name = "in the mesh" if isinstance(source, bytes) else source.name
    if isinstance(source, Path) and not source.is_file():
        raise PictureError(name, "the file does not exist", code=FILE_MISSING)
    try:
        # Not opened by name: some of Pillow's readers read as much as the file's header claims.
        content = source if isinstance(source, bytes) else _content(source)
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", Image.DecompressionBombWarning)
            image = Image.open(io.BytesIO(content), formats=FORMATS)
        with image:
            check_size(image, name)
            yield image
    except (PictureError, MemoryError):
        raise
    except UnidentifiedImageError:
        known = ", ".join(FORMATS)
        raise PictureError(
            name, "its format is not supported", f"Convert it to a supported format: {known}."
        ) from None
    except Image.DecompressionBombError:
        raise _too_large(name, "") from None
    except Exception as error:  # Pillow's readers may raise any error
        raise PictureError(name, str(error) or type(error).__name__) from error


def _content(path: Path) -> bytes:
    if path.stat().st_size > MOST_BYTES:
        raise PictureError(
            path.name, "the file is too large", f"The limit is {MOST_BYTES >> 20} MiB."
        )
    return read_regular(path, MOST_BYTES)


def check_size(image: Any, name: str) -> None:
    """Checks an image's size before it is decoded.

    Raises:
        PictureError: The image is too large.
    """
    width, height = image.size
    if width < 1 or height < 1:
        raise PictureError(name, f"it has {width} x {height} pixels")
    if width * height > MOST_PIXELS:
        raise _too_large(name, f"{width} x {height} pixels")


def _too_large(name: str, size: str) -> PictureError:
    return PictureError(
        name,
        f"it is too large{f' ({size})' if size else ''}",
        f"The limit is {MOST_PIXELS // 1_000_000} million pixels. Scale the image down.",
    )


def thumbnail(source: Path | bytes, most: int, mode: str = "RGB") -> Any:
    """An image as a Pillow image with 8 bits per channel.

    Args:
        source: A file, or its contents.
        most: Maximum length of the longer edge, pixels; larger images are scaled down.
        mode: Pillow's mode: ``RGB`` or ``RGBA``.

    Raises:
        PictureError: As `open_picture`.
    """
    with open_picture(source) as image:
        if image.mode.startswith("I"):  # 16 bits, which Pillow would clip at 255
            image = image.point(lambda value: value / 256).convert("L")  # noqa: PLW2901
        elif image.mode in ("P", "PA", "1"):
            image = image.convert(mode)  # noqa: PLW2901
        image.thumbnail((most, most))
        return image.convert(mode)
