"""Outlines with holes: areas by formula, pieces that are convex."""

import numpy as np
import pytest

from cartwheel.description.model import Polyline
from cartwheel.description.shapes.outline import convex_pieces, solid

SQUARE = ((0.0, 0.0), (4.0, 0.0), (4.0, 4.0), (0.0, 4.0))
HOLE = ((1.0, 1.0), (3.0, 1.0), (3.0, 3.0), (1.0, 3.0))
ISLAND = ((1.5, 1.5), (2.5, 1.5), (2.5, 2.5), (1.5, 2.5))
U = ((0.0, 0.0), (3.0, 0.0), (3.0, 3.0), (2.0, 3.0), (2.0, 1.0), (1.0, 1.0), (1.0, 3.0), (0.0, 3.0))
BOW = ((0.0, 0.0), (2.0, 2.0), (2.0, 0.0), (0.0, 2.0))

CASES = [
    pytest.param(Polyline(points=SQUARE, height=2.0), 16.0, id="square"),
    pytest.param(Polyline(points=(*SQUARE, SQUARE[0]), height=2.0), 16.0, id="closed"),
    pytest.param(Polyline(points=SQUARE[::-1], height=2.0), 16.0, id="clockwise"),
    pytest.param(Polyline(points=SQUARE, height=2.0, holes=(HOLE,)), 12.0, id="hole"),
    pytest.param(Polyline(points=HOLE, height=2.0, holes=(SQUARE,)), 12.0, id="hole first"),
    pytest.param(Polyline(points=SQUARE, height=2.0, holes=(HOLE, ISLAND)), 13.0, id="island"),
    pytest.param(Polyline(points=U, height=2.0), 7.0, id="u"),
    pytest.param(Polyline(points=BOW, height=2.0), 2.0, id="crosses itself"),
]


def area(loop):
    x, y = np.array(loop).T
    return float(np.sum(x * np.roll(y, -1) - np.roll(x, -1) * y)) / 2


@pytest.mark.parametrize(("shape", "expected"), CASES)
def test_pieces_fill_the_area_and_are_convex(shape, expected):
    pieces = convex_pieces(shape)
    assert sum(area(piece) for piece in pieces) == pytest.approx(expected)
    for piece in pieces:
        assert area(piece) > 0
        sides = np.roll(piece, -1, axis=0) - np.array(piece)
        after = np.roll(sides, -1, axis=0)
        assert (sides[:, 0] * after[:, 1] - sides[:, 1] * after[:, 0] > -1e-9).all()


@pytest.mark.parametrize(("shape", "expected"), CASES)
def test_the_solid_has_the_volume_with_faces_outwards(shape, expected):
    vertices, faces = solid(shape)
    a, b, c = (vertices[faces[:, k]].astype(float) for k in range(3))
    volume = float(np.einsum("ij,ij->i", a, np.cross(b, c)).sum()) / 6
    assert volume == pytest.approx(2.0 * expected, rel=1e-5)
    assert vertices[:, 2].min() == 0.0
    assert vertices[:, 2].max() == 2.0


def test_a_square_is_one_piece_and_a_ring_is_four():
    assert len(convex_pieces(Polyline(points=SQUARE, height=1.0))) == 1
    assert len(convex_pieces(Polyline(points=SQUARE, height=1.0, holes=(HOLE,)))) == 4
