"""STL, OBJ, PLY and glTF, scaling, hull input; against triangles written out by hand."""

from __future__ import annotations

import json
import math
import os
import struct
import subprocess
import sys
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from PIL import Image
from tests.coded import raises

from cartwheel.codes.files import FILE_MISSING, MESH_UNREADABLE
from cartwheel.description.meshes import MeshError, convex_hull_input, load_mesh, mesh_notes
from cartwheel.description.model import Mesh
from cartwheel.errors import Origin

TETRA = [(0, 0, 0), (1, 0, 0), (0, 2, 0), (0, 0, 3)]
TETRA_FACES = [(0, 2, 1), (0, 1, 3), (0, 3, 2), (1, 2, 3)]


def signed_volume(vertices, faces) -> float:
    """Positive where the faces look outwards."""
    a, b, c = (np.asarray(vertices, float)[np.asarray(faces)[:, i]] for i in range(3))
    return float(np.einsum("ij,ij->i", a, np.cross(b, c)).sum() / 6)


def binary_stl(faces, header=b"") -> bytes:
    data = header.ljust(80, b"\0") + struct.pack("<I", len(faces))
    for face in faces:
        data += struct.pack("<12fH", 0, 0, 0, *(c for corner in face for c in corner), 0)
    return data


def tetra_stl() -> bytes:
    return binary_stl([[TETRA[i] for i in face] for face in TETRA_FACES])


def write(folder: Path, name: str, data: bytes | str) -> Mesh:
    path = folder / name
    path.write_bytes(data if isinstance(data, bytes) else data.encode())
    return Mesh(uri=name, path=path)


def test_binary_stl_merges_its_corners(tmp_path):
    (part,) = load_mesh(write(tmp_path, "t.stl", tetra_stl()))
    assert sorted(map(tuple, part.vertices.tolist())) == sorted(TETRA)
    assert part.faces.shape == (4, 3)
    assert part.vertices.dtype == np.float32
    assert part.faces.dtype == np.int32
    assert signed_volume(part.vertices, part.faces) == pytest.approx(1.0)  # 1*2*3/6


def test_binary_stl_may_begin_with_solid(tmp_path):
    data = binary_stl([[TETRA[i] for i in f] for f in TETRA_FACES], header=b"solid exported")
    (part,) = load_mesh(write(tmp_path, "t.stl", data))
    assert len(part.faces) == 4


def test_ascii_stl(tmp_path):
    text = "solid part\n"
    for face in TETRA_FACES:
        text += "facet normal 0 0 0\n outer loop\n"
        for i in face:
            text += "  vertex {} {} {}\n".format(*TETRA[i])
        text += " endloop\nendfacet\n"
    (part,) = load_mesh(write(tmp_path, "t.STL", text + "endsolid part\n"))
    assert len(part.vertices) == 4
    assert signed_volume(part.vertices, part.faces) == pytest.approx(1.0)


def test_scale_is_applied_on_each_call_and_the_file_read_once(tmp_path):
    mesh = write(tmp_path, "t.stl", tetra_stl())
    plain = load_mesh(mesh)[0]
    again = load_mesh(mesh)[0]
    assert plain.vertices is again.vertices
    scaled = load_mesh(Mesh(uri="t.stl", path=mesh.path, scale=(0.001, 0.002, 0.5)))[0]
    assert scaled.vertices.max(axis=0) == pytest.approx([0.001, 0.004, 1.5])
    with pytest.raises(ValueError, match="read-only"):
        plain.vertices[0, 0] = 7


def test_an_edited_file_is_read_anew(tmp_path):
    mesh = write(tmp_path, "t.stl", tetra_stl())
    assert len(load_mesh(mesh)[0].faces) == 4
    mesh.path.write_bytes(binary_stl([[TETRA[i] for i in TETRA_FACES[0]]]))
    assert len(load_mesh(mesh)[0].faces) == 1


@pytest.mark.parametrize("scale", [(-1, 1, 1), (1, -1, 1), (-1, -1, -1)])
def test_a_mirroring_scale_keeps_the_outside_out(tmp_path, scale):
    mesh = write(tmp_path, "t.stl", tetra_stl())
    (part,) = load_mesh(Mesh(uri="", path=mesh.path, scale=scale))
    assert signed_volume(part.vertices, part.faces) == pytest.approx(1.0)


def test_two_mirrored_axes_are_a_rotation(tmp_path):
    mesh = write(tmp_path, "t.stl", tetra_stl())
    plain, turned = (
        load_mesh(Mesh(uri="", path=mesh.path, scale=s))[0] for s in ((1, 1, 1), (-1, -1, 1))
    )
    assert turned.faces is plain.faces
    assert signed_volume(turned.vertices, turned.faces) == pytest.approx(1.0)


def test_degenerate_triangles_are_dropped(tmp_path):
    line = [(0, 0, 0), (1, 1, 1), (2, 2, 2)]
    point = [(5, 5, 5)] * 3
    good = [(0, 0, 0), (1e-4, 0, 0), (0, 1e-4, 0)]
    (part,) = load_mesh(write(tmp_path, "t.stl", binary_stl([line, point, good])))
    assert len(part.faces) == 1
    assert part.vertices.max() == pytest.approx(1e-4)
    with raises(MESH_UNREADABLE):
        load_mesh(write(tmp_path, "flat.stl", binary_stl([line, point])))


OBJ = """
mtllib colours.mtl
v 0 0 0
v 1 0 0
v 1 1 0
v 0 1 0
v 0 0 1
vt 0 0
vt 1 0
vt 1 1
vt 0 1
vn 0 0 2
o plate
usemtl red
f 1/1/1 2/2/1 3/3/1 4/4/1
usemtl glass
f -5 -4 -1
"""
MTL = """
newmtl red
Kd 1 0.25 0
map_Kd wood.png
newmtl glass
Kd 0 0 1
d 0.5
"""


def test_obj_with_materials(tmp_path):
    (tmp_path / "colours.mtl").write_text(MTL)
    (tmp_path / "wood.png").write_bytes(b"not looked into")
    mesh = write(tmp_path, "t.obj", OBJ)
    plate, glass = load_mesh(mesh)
    assert plate.name == glass.name == "plate"
    assert plate.rgba == (1, 0.25, 0, 1)
    assert plate.texture == tmp_path / "wood.png"
    assert plate.faces.shape == (2, 3)
    assert plate.normals is not None
    assert plate.normals.tolist() == [[0, 0, 1]] * 4
    assert plate.uv is not None
    assert plate.uv.tolist() == plate.vertices[:, :2].tolist()
    assert glass.rgba == (0, 0, 1, 0.5)
    assert glass.normals is None
    assert glass.texture is None
    assert sorted(map(tuple, glass.vertices.tolist())) == [(0, 0, 0), (0, 0, 1), (1, 0, 0)]
    assert mesh_notes(mesh) == ()


@pytest.mark.parametrize("key", ["o", "g"])
def test_obj_objects_and_groups_are_submeshes(tmp_path, key):
    points = "".join(f"v {x} {y} {z}\n" for x, y, z in TETRA)
    text = f"{points}usemtl red\n{key} left wheel\nf 1 2 3\n{key} right\nf 1 2 4\nf 1 3 4\n"
    mesh = write(tmp_path, "t.obj", text)
    parts = load_mesh(mesh)
    assert [(part.name, len(part.faces)) for part in parts] == [("left wheel", 1), ("right", 2)]
    (part,) = load_mesh(replace(mesh, submesh="right"))
    assert len(part.faces) == 2


def test_obj_without_its_library_says_so(tmp_path):
    mesh = write(tmp_path, "t.obj", OBJ)
    assert load_mesh(mesh)[0].rgba is None
    assert "colours.mtl" in mesh_notes(mesh)[0]


@pytest.mark.parametrize(
    "faces", ["f 1 2 3\nf 1//1 2//1 3//1", "f 1/1 2/1 3/1", "f 1//1 2//1 3//1", "f 1 2 3"]
)
def test_obj_corner_spellings(tmp_path, faces):
    text = f"v 0 0 0\nv 1 0 0 # c\nv 0 1 0 1 0 0\nvt 0 0\nvn 0 0 1\n{faces}\n"
    text = text.replace(" # c", "")
    (part,) = load_mesh(write(tmp_path, "t.obj", text))
    assert len(part.vertices) == 3
    assert signed_volume([*part.vertices, (0, 0, -1)], part.faces) == 0


def test_a_concave_polygon_keeps_its_area(tmp_path):
    # An L of five unit squares' area less two: fan triangulation from its first corner would
    # cover the notch.
    corners = [(3, 0), (3, 1), (1, 1), (1, 3), (0, 3), (0, 0)]
    text = "".join(f"v {x} {y} 0\n" for x, y in corners) + "f 1 2 3 4 5 6\n"
    (part,) = load_mesh(write(tmp_path, "t.obj", text))
    a, b, c = (part.vertices[part.faces[:, i]].astype(float) for i in range(3))
    crosses = np.cross(b - a, c - a)[:, 2] / 2
    assert (crosses > 0).all()
    assert crosses.sum() == pytest.approx(5.0)


def test_submesh_is_chosen_and_centred(tmp_path):
    text = "v 1 1 1\nv 3 1 1\nv 1 5 1\nv 0 0 9\no a\nf 1 2 3\no b\nf 1 2 4\n"
    path = write(tmp_path, "t.obj", text).path
    (part,) = load_mesh(Mesh(uri="", path=path, submesh="a", center_submesh=True))
    assert part.vertices.min(axis=0).tolist() == [-1, -2, 0]
    assert part.vertices.max(axis=0).tolist() == [1, 2, 0]
    with raises(MESH_UNREADABLE, submesh="c"):
        load_mesh(Mesh(uri="", path=path, submesh="c"))


def test_hull_input_joins_all_parts(tmp_path):
    text = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\no a\nf 1 2 3\no b\nf 1 2 4\n"
    vertices, faces = convex_hull_input(load_mesh(write(tmp_path, "t.obj", text)))
    assert len(vertices) == 4
    corners = {frozenset(map(tuple, vertices[f].tolist())) for f in faces}
    assert corners == {
        frozenset({(0, 0, 0), (1, 0, 0), (0, 1, 0)}),
        frozenset({(0, 0, 0), (1, 0, 0), (0, 0, 1)}),
    }
    assert [len(a) for a in convex_hull_input(())] == [0, 0]


def test_ply(tmp_path):
    text = "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\n"
    text += "property float z\nproperty uchar red\nproperty uchar green\nproperty uchar blue\n"
    text += "element face 1\nproperty list uchar int vertex_indices\nend_header\n"
    text += "0 0 0 255 0 0\n1 0 0 255 0 0\n0 1 0 255 0 0\n3 0 1 2\n"
    (part,) = load_mesh(write(tmp_path, "t.ply", text))
    assert len(part.faces) == 1
    assert part.rgba == (1, 0, 0, 1)


def triangle_gltf() -> tuple[dict, bytes]:
    points = struct.pack("<9f", 0, 0, 0, 1, 0, 0, 0, 1, 0)
    corners = struct.pack("<3H", 0, 1, 2) + b"\0\0"
    document = {
        "asset": {"version": "2.0"},
        "scene": 0,
        "scenes": [{"nodes": [0]}],
        "nodes": [{"mesh": 0, "translation": [0, 5, 0], "scale": [2, 2, 2]}],
        "meshes": [
            {"primitives": [{"attributes": {"POSITION": 0}, "indices": 1, "material": 0}]}
        ],
        "materials": [{"pbrMetallicRoughness": {"baseColorFactor": [0, 1, 0, 0.5]}}],
        "accessors": [
            {
                "bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3",
                "min": [0, 0, 0], "max": [1, 1, 0],
            },
            {"bufferView": 1, "componentType": 5123, "count": 3, "type": "SCALAR"},
        ],
        "bufferViews": [
            {"buffer": 0, "byteOffset": 0, "byteLength": 36},
            {"buffer": 0, "byteOffset": 36, "byteLength": 6},
        ],
        "buffers": [{"byteLength": 44}],
    }  # fmt: skip
    return document, points + corners


def triangle_glb() -> bytes:
    document, binary = triangle_gltf()
    text = json.dumps(document).encode()
    text += b" " * (-len(text) % 4)
    body = struct.pack("<II", len(text), 0x4E4F534A) + text
    body += struct.pack("<II", len(binary), 0x004E4942) + binary
    return struct.pack("<4sII", b"glTF", 2, 12 + len(body)) + body


def test_glb_keeps_its_axes(tmp_path):
    (part,) = load_mesh(write(tmp_path, "t.glb", triangle_glb()))
    assert sorted(map(tuple, part.vertices.tolist())) == [(0, 5, 0), (0, 7, 0), (2, 5, 0)]
    assert part.rgba == pytest.approx((0, 1, 0, 0.5), abs=1 / 255)


def test_gltf_finds_its_buffer_beside_it(tmp_path):
    document, binary = triangle_gltf()
    document["buffers"][0]["uri"] = "t.bin"
    (tmp_path / "t.bin").write_bytes(binary)
    (part,) = load_mesh(write(tmp_path, "t.gltf", json.dumps(document)))
    assert part.vertices.max(axis=0).tolist() == [2, 7, 0]


def test_the_image_of_a_gltf_is_the_file_beside_it(tmp_path):
    """It is not encoded again, which takes a second for the usual sizes."""
    document, binary = triangle_gltf()
    places = np.array([[0, 0], [1, 0], [0, 1]], dtype="<f4").tobytes()
    document["buffers"] = [{"byteLength": len(binary + places), "uri": "t.bin"}]
    document["bufferViews"].append(
        {"buffer": 0, "byteOffset": len(binary), "byteLength": len(places)}
    )
    document["accessors"].append(
        {"bufferView": len(document["bufferViews"]) - 1, "componentType": 5126, "count": 3,
         "type": "VEC2"}
    )  # fmt: skip
    attributes = document["meshes"][0]["primitives"][0]["attributes"]
    attributes["TEXCOORD_0"] = len(document["accessors"]) - 1
    document["images"] = [{"uri": "t.jpg"}]
    document["textures"] = [{"source": 0}]
    document["materials"][0]["pbrMetallicRoughness"]["baseColorTexture"] = {"index": 0}
    image = tmp_path / "t.jpg"
    Image.new("RGB", (8, 8), (200, 30, 10)).save(image)
    (tmp_path / "t.bin").write_bytes(binary + places)
    (part,) = load_mesh(write(tmp_path, "t.gltf", json.dumps(document)))
    assert part.texture == image.read_bytes()


UNUSABLE = [
    ("a.stl", b"", "is empty"),
    ("a.stl", b"solid nothing\nendsolid\n", "no triangles"),
    ("a.stl", b"short", "is not an STL file"),
    ("a.stl", tetra_stl()[:-20], "it declares 4 triangles but contains 3"),
    ("a.stl", b"solid a\nfacet normal 0 0 0\nvertex 1 2 x\n" * 3, '"x" is not a number'),
    ("a.stl", binary_stl([[(0, 0, 0), (1, 0, 0), (0, float("nan"), 0)]]), "not finite"),
    ("a.obj", "v 0 0 0\nv 1 0\nf 1 2 3\n", '"v" statement'),
    ("a.obj", "v 0 0 0\nv 1 0 0\nf 1 2 3\n", "the index 2"),
    ("a.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf a b c\n", "is not an OBJ index"),
    ("a.obj", "nothing of use", "no triangles"),
    ("a.fbx", b"Kaydara", 'format "fbx" is not supported'),
    ("a.glb", b"glTF but no more", "."),
    ("a.ply", b"ply\nformat ascii 1.0\nelement vertex 99\n", "."),
]
"""Names and contents of files, and why each is refused."""


@pytest.mark.parametrize(("name", "data"), [case[:2] for case in UNUSABLE])
def test_unusable_files(tmp_path, name, data):
    mesh = write(tmp_path, name, data)
    place = Origin(file="robot.urdf", line=12)
    with raises(MESH_UNREADABLE, name=str(mesh.path)) as caught:
        load_mesh(mesh, origin=place)
    assert caught.value.origin is place
    with pytest.raises(MeshError):  # failures are not cached as something else
        load_mesh(mesh)


@pytest.mark.wording
@pytest.mark.parametrize(("name", "data", "reason"), UNUSABLE)
def test_unusable_files_say_why(tmp_path, name, data, reason):
    with pytest.raises(MeshError, match=reason):
        load_mesh(write(tmp_path, name, data))


def test_missing_file_folder_and_flat_scale(tmp_path):
    with raises(FILE_MISSING, kind="mesh"):
        load_mesh(Mesh(uri="", path=tmp_path / "none.stl"))
    (tmp_path / "folder.stl").mkdir()
    with raises(MESH_UNREADABLE, name=str(tmp_path / "folder.stl")):
        load_mesh(Mesh(uri="", path=tmp_path / "folder.stl"))
    mesh = write(tmp_path, "t.stl", tetra_stl())
    for scale in ((1, 0, 1), (1, 1, 1e-50), (-1e50, 1, 1), (1, math.nan, 1)):
        with raises(MESH_UNREADABLE) as caught:
            load_mesh(Mesh(uri="", path=mesh.path, scale=scale))
        assert caught.value.values["scale"] is scale


def test_robots_meshes_load_without_the_slow_importers():
    """STL, OBJ and DAE belong to the first second; trimesh alone takes a tenth of it."""
    code = (
        "import sys, cartwheel.description.meshes; print({'trimesh', 'collada'} & {*sys.modules})"
    )
    found = subprocess.run(
        [sys.executable, "-c", code], capture_output=True, text=True, check=True, env=os.environ
    )
    assert found.stdout.strip() == "set()"
