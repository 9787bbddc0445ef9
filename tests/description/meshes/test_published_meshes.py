"""Meshes of published robots, against trimesh, which reads them by other means."""

from __future__ import annotations

import os
from pathlib import Path

import numpy as np
import pytest

from cartwheel.description.meshes import convex_hull_input, load_mesh
from cartwheel.description.model import Mesh

ROOT = Path(__file__).parents[3]
CORPUS = Path(os.environ.get("CARTWHEEL_CORPUS", ROOT.parent / "shared" / "corpus"))
FILES = sorted([*CORPUS.rglob("*.dae"), *CORPUS.rglob("*.stl")]) if CORPUS.is_dir() else []

pytestmark = pytest.mark.skipif(not FILES, reason=f"no corpus of others' robots in {CORPUS}")


def area(vertices, faces) -> float:
    a, b, c = (np.asarray(vertices, float)[faces[:, i]] for i in range(3))
    return float(np.linalg.norm(np.cross(b - a, c - a), axis=1).sum() / 2)


@pytest.mark.parametrize(
    "path", FILES or [CORPUS], ids=lambda path: f"{path.parent.name}/{path.name}"
)
def test_area_and_bounds_are_those_of_trimesh(path):
    import trimesh

    vertices, faces = convex_hull_input(load_mesh(Mesh(uri="", path=path)))
    peer = trimesh.load_scene(path, process=False).to_mesh()
    # COLLADA's unit is left to the caller there.
    text = path.read_bytes()[:2000] if path.suffix == ".dae" else b""
    unit = float(text.partition(b'meter="')[2].partition(b'"')[0] or 1)
    expected = float(peer.area) * unit**2
    assert area(vertices, faces) == pytest.approx(expected, rel=1e-4)
    used = np.asarray(peer.vertices)[np.unique(peer.faces[peer.area_faces > 0])] * unit
    size = float(np.ptp(used, axis=0).max())
    assert vertices.min(axis=0) == pytest.approx(used.min(axis=0), abs=1e-5 * size)
    assert vertices.max(axis=0) == pytest.approx(used.max(axis=0), abs=1e-5 * size)
