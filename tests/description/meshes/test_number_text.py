"""Numbers in mesh files, and statements of OBJ files in unusual spellings."""

import warnings

import numpy as np
import pytest
from tests.description.meshes.test_loading import write

from cartwheel.description.meshes import MeshError, load_mesh, number_text
from cartwheel.description.meshes.number_text import floats_of, integers_of
from cartwheel.description.meshes.polygons import triangulate


@pytest.fixture(params=[True, False])
def strict(request, monkeypatch):
    """Whether numpy rejects words that are no numbers."""
    monkeypatch.setattr(number_text, "_is_strict", lambda: request.param)


@pytest.mark.usefixtures("strict")
@pytest.mark.parametrize("kind", [str, str.encode])
def test_numbers(kind):
    assert floats_of(kind(" 1\n-2.5e3\t+.5 1_0 ")).tolist() == [1.0, -2500.0, 0.5, 10.0]
    assert np.isnan(floats_of(kind("nan"))).all()
    assert integers_of(kind("3 -4\r\n007")).tolist() == [3, -4, 7]
    for read in (floats_of, integers_of):
        assert read(kind("")).tolist() == read(kind(" \n")).tolist() == []
        for wrong in ("1 x", "1,2", "0x10", "1 2 3a"):
            with pytest.raises(ValueError, match=r"x|,|a"):
                read(kind(wrong))
    with pytest.raises(ValueError, match=r"1\.5"):
        integers_of(kind("1.5"))


@pytest.mark.parametrize("rejects", [True, False])
def test_old_versions_of_numpy_are_recognised(monkeypatch, rejects):
    """They warn, and return the numbers before a word that is none."""

    def read(text, dtype=float, sep=""):
        if rejects:
            raise ValueError(text)
        warnings.warn("could not be read to its end", DeprecationWarning, stacklevel=1)
        return np.zeros(0)

    monkeypatch.setattr(np, "fromstring", read)
    number_text._is_strict.cache_clear()
    assert number_text._is_strict() is rejects
    number_text._is_strict.cache_clear()


SQUARE = ["v 0 0 0", "v 1 0 0", "v 1 1 0", "v 0 1 0"]
FACES = ["f 1 2 3", "f 1 3 4"]


@pytest.mark.parametrize(
    "lines",
    [
        [*SQUARE, *FACES],
        [*SQUARE, "f 1 2 3 4"],
        ["  " + line for line in (*SQUARE, *FACES)],
        [line + "\r" for line in (*SQUARE, *FACES)],
        ["", "# v 9 9 9", SQUARE[0], "", *SQUARE[1:], "s off", FACES[0], "# f", FACES[1], "f "],
        [*SQUARE[:3], FACES[0], SQUARE[3], "f -4 -2 -1"],
        [*(line + " 0.5 0.5 0.5" for line in SQUARE), *FACES],
        [SQUARE[0], *(line + " 1.0" for line in SQUARE[1:]), *FACES],
        ["v  0  0 \\", "0", *SQUARE[1:], "f  1   2 3 ", FACES[1]],
        [*SQUARE, "vt 0 0", "vn 0 0 1", "f 1/1/1 2/1/1 3/1/1", "f 1/1/1 3/1/1 4/1/1"],
        [*SQUARE, "vn 0 0 1", "f 1//1 2//1 3//1", "f 1//1 3//1 4//1"],
        [*SQUARE, "vt 0 0", "f 1/1 2/1 3/1", "f 1/1 3/1 4/1"],
        [*SQUARE, "vt 0 0", "vn 0 0 1", "f 1 2/1 3//1", "f 1/1/1 3 4"],
        [*SQUARE, "vn 0 0 1", "f 1//1 2//1 3//1", "f 1 3 4"],
    ],
)
@pytest.mark.parametrize("end", ["", "\n"])
def test_spellings_of_an_obj_file(tmp_path, lines, end):
    (part,) = load_mesh(write(tmp_path, "t.obj", "\n".join(lines) + end))
    corners = part.vertices[part.faces]
    area = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]).sum(axis=0) / 2
    assert part.faces.shape == (2, 3)
    assert area.tolist() == [0.0, 0.0, 1.0]
    assert sorted(map(tuple, part.vertices[:, :2].tolist())) == [(0, 0), (0, 1), (1, 0), (1, 1)]


@pytest.mark.parametrize(
    "line",
    [
        "f 1 2 3 # face",
        "f 1 2 x",
        "f 1 2 3.0",
        "f 1/a 2/1 3/1",
        "f 1 2f 3",
        "v 0 0",
        "v 0 0 x",
        "v 0 0 0v",
        "vn 0 0 t",
    ],
)
def test_statements_of_an_obj_file_that_are_wrong(tmp_path, line):
    with pytest.raises(MeshError):
        load_mesh(write(tmp_path, "t.obj", "\n".join([*SQUARE, line, *FACES])))


def test_polygons_whose_sizes_exceed_the_largest_integer_are_wrong():
    """Their sum is three again."""
    sizes = np.array([1 << 62] * 4 + [3], dtype=np.int64)
    with pytest.raises(ValueError, match="polygons"):
        triangulate(sizes, np.zeros((3, 3)))
