"""Mesh files, surfaces and collision geometry are computed once for all meshes of a scenery."""

import pytest
from tests.description.meshes.test_loading import tetra_stl, write

from cartwheel.description.meshes import loading, standing, standing_parts, surface_of
from cartwheel.description.meshes.kept import _ENTRY, Kept
from cartwheel.description.model import Mesh


def test_thousands_of_small_values_are_kept():
    kept = Kept(1 << 28, len)
    made = []
    for _ in range(3):
        for key in range(20_000):
            kept.get(key, lambda key=key: made.append(key) or "x")
    assert len(made) == 20_000


def test_the_least_recently_used_are_removed():
    kept = Kept(3 * (100 + _ENTRY), len)
    for key in (1, 2, 3, 1, 4):
        kept.get(key, lambda: "x" * 100)
    made = []
    for key in (1, 3, 4, 2):
        kept.get(key, lambda key=key: made.append(key) or "x" * 100)
    assert made == [2]


def test_a_value_above_the_limit_is_kept_until_the_next():
    kept = Kept(10, len)
    made = []
    for key in (1, 1, 2, 1):
        kept.get(key, lambda key=key: made.append(key) or "x" * 100)
    assert made == [1, 2, 1]


def test_an_error_is_raised_again():
    kept = Kept(10, len)

    def fail():
        raise KeyError("again")

    for _ in range(2):
        with pytest.raises(KeyError):
            kept.get(1, fail)
    assert kept.get(1, lambda: "x") == "x"
    kept.clear()
    assert kept.get(1, lambda: "y") == "y"


def test_each_piece_of_a_scenery_is_prepared_once(tmp_path, monkeypatch):
    """More meshes than a cache of a fixed number would contain, each asked for several times."""
    found = []
    original = standing.standing_pieces

    def counted(*surface):
        found.append(len(surface[0]))
        return original(*surface)

    monkeypatch.setattr(loading, "standing_pieces", counted)
    path = write(tmp_path, "t.stl", tetra_stl()).path
    meshes = [Mesh(uri="", path=path, scale=(1 + number / 4096, 1, 1)) for number in range(2000)]
    for _ in range(2):
        for mesh in meshes:
            assert not standing_parts(mesh).hulls
    assert len(found) == len(meshes)
    vertices, _ = surface_of(meshes[0])
    with pytest.raises(ValueError, match="read-only"):
        vertices[0] = 0
