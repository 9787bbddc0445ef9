"""Parts and edges of surfaces, with few and many faces."""

import numpy as np

from cartwheel.description.meshes import surface
from cartwheel.description.meshes.submesh import unique_rows


def test_few_faces_have_the_same_parts():
    random = np.random.default_rng(4)
    for _ in range(200):
        faces = random.integers(0, 30, (random.integers(1, surface.FEW), 3))
        few = surface.components(faces, 30)
        # So many that numpy finds them: the same corners, in other components above them.
        more = np.concatenate([faces, np.full((surface.FEW, 3), 30) + np.arange(3)])
        many = surface.components(more, 33)
        assert len(many) == len(few) + 1
        for one, other in zip(few, many, strict=False):
            assert np.array_equal(one, other)


def test_closed_surfaces_have_each_edge_twice():
    random = np.random.default_rng(5)
    tetra = np.array([[0, 2, 1], [0, 1, 3], [1, 2, 3], [0, 3, 2]])
    double = np.concatenate([tetra, tetra])
    for faces in (tetra, tetra[:3], double, *(random.integers(0, 5, (4, 3)) for _ in range(200))):
        edges = [tuple(sorted(pair)) for a, b, c in faces for pair in ((a, b), (b, c), (c, a))]
        closed = all(edges.count(edge) == 2 for edge in edges)
        assert surface.is_closed(faces) == closed


def test_distinct_rows_are_found_once_and_again(monkeypatch):
    random = np.random.default_rng(6)
    rows = random.integers(0, 3, (60, 3)).astype(np.float32)
    rows[0] = -0.0
    first, inverse = unique_rows(rows)
    once = rows[first]
    assert len(once) == len(np.unique(rows + 0, axis=0))
    assert np.array_equal(once[inverse], rows)
    with monkeypatch.context() as patched:
        patched.delattr(np, "unique")
        again, back = unique_rows(once)
    assert again.tolist() == back.tolist() == list(range(len(once)))
    changed = once[::-1]
    again, back = unique_rows(changed)
    assert np.array_equal(changed[again], once)
    assert np.array_equal(once[back], changed)
