"""Damaged mesh files end in a MeshError or a mesh, never in another exception."""

from __future__ import annotations

import struct

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from tests.description.meshes import test_dae, test_loading

from cartwheel.codes.files import MESH_UNREADABLE
from cartwheel.description.meshes import MeshError, load_mesh
from cartwheel.description.model import Mesh

SAMPLES = {
    "stl": test_loading.tetra_stl(),
    "obj": test_loading.OBJ.encode(),
    "dae": test_dae.textured_document().encode(),
    "ply": b"ply\nformat binary_little_endian 1.0\nelement vertex 3\nproperty float x\n"
    b"property float y\nproperty float z\nelement face 1\n"
    b"property list uchar int vertex_indices\nend_header\n"
    + struct.pack("<9fB3i", 0, 0, 0, 1, 0, 0, 0, 1, 0, 3, 0, 1, 2),
    "glb": test_loading.triangle_glb(),
}


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    return tmp_path_factory.mktemp("damage")


@pytest.mark.parametrize("kind", sorted(SAMPLES))
def test_samples_are_whole(folder, kind):
    path = folder / f"whole.{kind}"
    path.write_bytes(SAMPLES[kind])
    assert load_mesh(Mesh(uri="", path=path))


@pytest.mark.parametrize("kind", sorted(SAMPLES))
@settings(
    max_examples=120,
    suppress_health_check=[HealthCheck.function_scoped_fixture],
)
@given(data=st.data())
def test_damage(folder, kind, data):
    whole = SAMPLES[kind]
    content = bytearray(whole[: data.draw(st.integers(0, len(whole)), label="length")])
    for _ in range(data.draw(st.integers(0, 6), label="garbled")):
        if content:
            place = data.draw(st.integers(0, len(content) - 1))
            content[place] = data.draw(st.integers(0, 255))
    path = folder / f"damaged.{kind}"
    path.write_bytes(content)
    try:
        parts = load_mesh(Mesh(uri="", path=path))
    except MeshError as error:
        assert error.reason
        return
    for part in parts:
        assert np.isfinite(part.vertices).all()
        assert part.faces.min() >= 0
        assert part.faces.max() < len(part.vertices)


@pytest.mark.parametrize("kind", sorted(SAMPLES))
@settings(max_examples=30)
@given(content=st.binary(max_size=400))
def test_noise(folder, kind, content):
    path = folder / f"noise.{kind}"
    path.write_bytes(content)
    try:
        load_mesh(Mesh(uri="", path=path))
    except MeshError as error:
        assert error.code is MESH_UNREADABLE and error.values["name"] == str(path)
