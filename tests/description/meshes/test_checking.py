"""`check_mesh` raises the errors of `load_mesh`, but reads no triangles of valid STL files."""

import dataclasses
import random
import struct

import numpy as np
import pytest
from tests.description.meshes.test_loading import TETRA, TETRA_FACES, binary_stl, tetra_stl, write

from cartwheel.description.meshes import (
    MeshError,
    check_mesh,
    known_size,
    load_mesh,
    loading,
)
from cartwheel.errors import Origin

LINE = [(0, 0, 0), (1, 0, 0), (2, 0, 0)]
FACES = [[TETRA[i] for i in face] for face in TETRA_FACES]
PLACE = Origin(file="robot.urdf", line=7)


def error_of(function, mesh):
    try:
        function(mesh, origin=PLACE)
    except MeshError as error:
        return str(error), error.code, error.origin, error.values
    return None


@pytest.fixture
def reads(monkeypatch):
    """The number of STL files whose triangles were read, in a list."""
    calls = [0]
    original = loading.read_stl

    def counted(data):
        calls[0] += 1
        return original(data)

    monkeypatch.setattr(loading, "read_stl", counted)
    return calls


def test_a_valid_file_is_read_when_its_triangles_are_needed(tmp_path, reads):
    mesh = write(tmp_path, "t.stl", tetra_stl())
    check_mesh(mesh)
    assert known_size(mesh) == 3.0
    assert reads == [0]
    (part,) = load_mesh(mesh)
    assert len(part.faces) == 4
    load_mesh(mesh)
    assert reads == [1]


def test_the_triangles_are_those_of_the_time_of_the_check(tmp_path):
    mesh = write(tmp_path, "t.stl", tetra_stl())
    loaded = loading._loaded(mesh.path, None)
    mesh.path.write_bytes(b"")
    assert len(loaded.submeshes[0].faces) == 4


@pytest.mark.parametrize(
    "data",
    [
        b"",
        b"\0" * 83,
        b"\0" * 84,
        tetra_stl()[:-1],
        binary_stl(FACES)[:80] + struct.pack("<I", 2**31) + binary_stl(FACES)[84:],
        binary_stl([*FACES, [(0, 0, 0), (1, 0, 0), (0, float("nan"), 0)]]),
        binary_stl([[(float("inf"), 0, 0), (1, 0, 0), (0, 1, 0)], *FACES]),
        binary_stl([LINE]),
        binary_stl([LINE] * 500),
        b"solid a\nendsolid a\n" + b" " * 100,
        b"solid a\nfacet\nouter loop\nvertex 0 0 0\nvertex 1 0 0\n" + b" " * 100,
    ],
)
def test_a_damaged_file_is_an_error_at_once(tmp_path, data):
    mesh = write(tmp_path, "t.stl", data)
    expected = error_of(load_mesh, mesh)
    assert expected is not None
    loading._files.clear()
    assert error_of(check_mesh, mesh) == expected


@pytest.mark.parametrize(
    "data",
    [
        binary_stl([LINE] * 500 + FACES),
        binary_stl([LINE, *FACES]),
        binary_stl(FACES, header=b"solid exported"),
        tetra_stl() + b"more",
        b"solid a\nfacet\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\nendfacet\nendsolid\n"
        + b" " * 84,
    ],
)
def test_an_unusual_file_is_no_error(tmp_path, data):
    mesh = write(tmp_path, "t.stl", data)
    check_mesh(mesh)
    assert load_mesh(mesh)


def test_files_changed_at_random_have_the_same_errors(tmp_path):
    """Bytes of headers, counts and coordinates are replaced."""
    choice = random.Random(5)
    wrong = 0
    for number in range(300):
        data = bytearray(binary_stl([FACES[choice.randrange(4)] for _ in range(3)]))
        for _ in range(choice.randrange(1, 6)):
            place = choice.choice([choice.randrange(len(data)), choice.randrange(80, 84)])
            data[place] = choice.choice([0, 1, 2, 0x7F, 0x80, 0xFF, choice.randrange(256)])
        mesh = write(
            tmp_path, f"{number}.stl", bytes(data[: choice.choice([len(data)] * 3 + [99])])
        )
        found = error_of(check_mesh, mesh)
        loading._files.clear()
        assert found == error_of(load_mesh, mesh)
        wrong += found is not None
        if found is None and (size := known_size(mesh)) is not None:
            points = np.concatenate([part.vertices for part in load_mesh(mesh)])
            assert np.ptp(points.astype(float), axis=0).max() >= size * (1 - 1e-6)
    assert 50 < wrong < 250


@pytest.mark.parametrize("name", ["t.obj", "t.ply", "t.xyz", "none.stl"])
def test_other_files_have_the_same_errors(tmp_path, name):
    mesh = write(tmp_path, name, "nothing")
    if name == "none.stl":
        mesh.path.unlink()
    assert error_of(check_mesh, mesh) == error_of(load_mesh, mesh) is not None


def test_scales_and_submeshes_are_checked(tmp_path):
    mesh = write(tmp_path, "t.stl", tetra_stl())
    for changed in (
        dataclasses.replace(mesh, scale=(1.0, 1e-40, 1.0)),
        dataclasses.replace(mesh, submesh="wheel"),
    ):
        assert error_of(check_mesh, changed) == error_of(load_mesh, changed) is not None
    assert known_size(dataclasses.replace(mesh, scale=(1.0, -0.5, 2.0))) == 1.5


def test_a_size_is_known_of_plain_files_alone(tmp_path):
    mesh = write(tmp_path, "t.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n")
    assert known_size(mesh) is None
