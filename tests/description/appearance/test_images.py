"""Pictures of all kinds, and those that a small file makes too large."""

from __future__ import annotations

import io
import struct
import zlib

import numpy as np
import pytest
from PIL import Image
from tests.coded import coded, raises

import cartwheel as cw
from cartwheel.codes import files
from cartwheel.description import load_text
from cartwheel.description.appearance.images import MOST_PIXELS, thumbnail
from cartwheel.description.model import Heightmap
from cartwheel.description.shapes.terrain import TerrainError, heights_of
from cartwheel.errors import CartwheelError

RAMP = np.tile(np.arange(0, 256, 4, dtype=np.uint8), (64, 1))


def png(width, height):
    """A PNG whose header states a size, and whose pixels are missing."""

    def chunk(kind, data):
        return (
            struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))
        )

    head = struct.pack(">IIBBBBB", width, height, 8, 0, 0, 0, 0)
    pixels = chunk(b"IDAT", zlib.compress(bytes(64)))
    return b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", head) + pixels + chunk(b"IEND", b"")


def saved(image, kind):
    buffer = io.BytesIO()
    image.save(buffer, format=kind)
    return buffer.getvalue()


DEEP = saved(Image.fromarray(RAMP.astype(np.uint16) * 257), "PNG")
PALETTE = saved(Image.fromarray(RAMP).convert("P"), "PNG")


@pytest.mark.parametrize("size", [(13_000, 13_000), (60_000, 60_000), (2**31 - 1, 2**31 - 1)])
def test_a_picture_that_is_too_large_is_refused_before_it_is_decoded(tmp_path, size):
    path = tmp_path / "bomb.png"
    path.write_bytes(png(*size))
    with raises(files.PICTURE_UNREADABLE):
        thumbnail(path, 100)
    with raises(files.PICTURE_UNREADABLE, kind="heightmap"):
        heights_of(Heightmap(path=path, size=(1, 1, 1)))


@pytest.mark.wording
def test_the_limit_of_a_picture_is_shown(tmp_path):
    path = tmp_path / "bomb.png"
    path.write_bytes(png(13_000, 13_000))
    with raises(files.PICTURE_UNREADABLE) as error:
        heights_of(Heightmap(path=path, size=(1, 1, 1)))
    assert f"{MOST_PIXELS // 1_000_000} million" in error.value.hint


UNREADABLE = {
    "empty": b"",
    "text": b"text",
    "no pixels": png(64, 64),
    "cut off": DEEP[:60],
    "damaged": DEEP[:33] + b"\xff" * 30,
    "no number": b"P5\n8 x 255\n",
    # Pillow would start ghostscript for it.
    "program": saved(Image.fromarray(RAMP), "EPS"),
}


@pytest.mark.parametrize("content", UNREADABLE.values(), ids=UNREADABLE)
def test_a_picture_that_cannot_be_read_is_refused(tmp_path, content):
    path = tmp_path / "a.png"
    path.write_bytes(content)
    for source in (path, content):
        with raises(files.PICTURE_UNREADABLE):
            thumbnail(source, 100)
    with raises(files.PICTURE_UNREADABLE, kind="heightmap", name=str(path)):
        heights_of(Heightmap(path=path, size=(1, 1, 1)))


@pytest.mark.wording
@pytest.mark.parametrize("content", UNREADABLE.values(), ids=UNREADABLE)
def test_a_picture_that_cannot_be_read_says_why(tmp_path, content):
    path = tmp_path / "a.png"
    path.write_bytes(content)
    for source in (path, content):
        with pytest.raises(CartwheelError, match=r"cannot be read: .") as error:
            thumbnail(source, 100)
        assert "None" not in str(error.value)
    with pytest.raises(TerrainError, match=r'the heightmap "a.png" cannot be read: .'):
        heights_of(Heightmap(path=path, size=(1, 1, 1)))


@pytest.mark.parametrize(
    "content",
    [DEEP, PALETTE, saved(Image.fromarray(RAMP), "TIFF")],
    ids=["deep", "palette", "tiff"],
)
def test_all_depths_are_seen_alike(tmp_path, content):
    path = tmp_path / "a.png"
    path.write_bytes(content)
    pixels = np.asarray(thumbnail(path, 64)).astype(int)
    assert np.abs(pixels - RAMP[..., None]).max() <= 4
    heights = heights_of(Heightmap(path=path, size=(1, 1, 1)))
    assert np.abs(heights - RAMP / RAMP.max()).max() <= 0.02


def test_a_height_without_end_is_refused(tmp_path):
    path = tmp_path / "a.tif"
    path.write_bytes(saved(Image.fromarray(np.full((4, 4), np.inf, dtype=np.float32)), "TIFF"))
    with raises(files.PICTURE_UNREADABLE):
        heights_of(Heightmap(path=path, size=(1, 1, 1)))


@pytest.mark.parametrize(
    "content", [png(60_000, 60_000), png(64, 64), b"text"], ids=["large", "no pixels", "text"]
)
def test_a_texture_that_cannot_be_read_leaves_its_surface_with_a_warning(tmp_path, content):
    picture = tmp_path / "wood.png"
    picture.write_bytes(content)
    crate = load_text(
        f"""<sdf version="1.7"><model name="crate"><link name="base"><visual name="v">
        <geometry><box><size>1 1 1</size></box></geometry>
        <material><pbr><metal><albedo_map>file://{picture}</albedo_map></metal></pbr></material>
        </visual></link></model></sdf>""",
        file=str(tmp_path / "crate.sdf"),
    )
    with cw.World() as world:
        world.spawn(crate)
        world.run(0.01)
        (note,) = coded(world.session.simulation, files.PICTURE_UNREADABLE)
    assert note.severity == "warning"
    assert note.origin.line == 1
    assert note.values["name"] == picture.name


def test_an_unreadable_texture_that_is_remembered_holds_no_picture(tmp_path):
    from cartwheel.world.shapes import picture_error

    path = tmp_path / "a.png"
    path.write_bytes(png(64, 64))
    error = picture_error(path)
    assert picture_error(path) is error
    assert (error.__traceback__, error.__cause__, error.__context__) == (None, None, None)
