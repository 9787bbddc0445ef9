"""Images as heights: scaled to the brightest pixel, north up."""

import numpy as np
import pytest
from PIL import Image
from tests.coded import raises

from cartwheel.codes.files import PICTURE_UNREADABLE
from cartwheel.description.model import Heightmap
from cartwheel.description.shapes.terrain import heights_of


def test_the_brightest_pixel_is_as_high_as_the_size_says(tmp_path):
    path = tmp_path / "dim.png"
    Image.fromarray(np.array([[0, 50], [100, 25]], dtype=np.uint8)).save(path)
    found = heights_of(Heightmap(path=path, size=(1, 1, 3.0)))
    assert found == pytest.approx(np.array([[0, 1.5], [3.0, 0.75]]))


def test_sixteen_bits_are_finer_than_eight(tmp_path):
    path = tmp_path / "deep.png"
    Image.fromarray(np.array([[0, 1], [2, 40000]], dtype=np.uint16)).save(path)
    found = heights_of(Heightmap(path=path, size=(1, 1, 4.0)))
    assert found == pytest.approx(np.array([[0, 1e-4], [2e-4, 4.0]]))


def test_a_colour_counts_by_its_red(tmp_path):
    path = tmp_path / "red.png"
    Image.fromarray(np.array([[[200, 0, 0], [100, 255, 255]]] * 2, dtype=np.uint8)).save(path)
    found = heights_of(Heightmap(path=path, size=(1, 1, 1.0)))
    assert found == pytest.approx(np.array([[1.0, 0.5]] * 2))


def test_a_fine_image_is_thinned_out_with_its_corners_kept(tmp_path):
    path = tmp_path / "ramp.png"
    Image.fromarray(np.tile(np.linspace(0, 255, 256, dtype=np.uint8), (256, 1))).save(path)
    found = heights_of(Heightmap(path=path, size=(1, 1, 1.0)), most=18)
    assert found.shape == (18, 18)
    # A ramp stays one: sampled, not blurred.
    assert found[0] == pytest.approx(np.linspace(0, 1, 18), abs=1e-9)


def test_no_image_is_an_error_of_ours(tmp_path):
    path = tmp_path / "hills.png"
    path.write_text("x")
    with raises(PICTURE_UNREADABLE, kind="heightmap", name=str(path)):
        heights_of(Heightmap(path=path, size=(1, 1, 1.0)))
