"""Meshes and outlines that a few kilobytes make endless: bounded work, and a clear error."""

from __future__ import annotations

import time

import numpy as np
import pytest
from tests.coded import raises

from cartwheel.codes.files import MESH_UNREADABLE
from cartwheel.codes.tags import VALUE_INVALID
from cartwheel.description import load_text
from cartwheel.description.meshes import load_mesh, loading, standing_parts, submesh
from cartwheel.description.meshes.polygons import triangulate
from cartwheel.description.meshes.standing import standing_pieces
from cartwheel.description.model import Mesh, Polyline
from cartwheel.description.shapes.outline import OutlineError, convex_pieces, solid

RANDOM = np.random.default_rng(1)


def seconds(function, *arguments):
    """CPU time of a call, which a busy machine does not lengthen."""
    begin = time.process_time()
    function(*arguments)
    return time.process_time() - begin


def stl(path, corners):
    record = np.dtype([("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("attribute", "<u2")])
    records = np.zeros(len(corners), dtype=record)
    records["corners"] = corners
    path.write_bytes(bytes(80) + len(corners).to_bytes(4, "little") + records.tobytes())
    return Mesh(uri="", path=path)


def test_150_000_random_triangles_are_one_hull_within_seconds(tmp_path):
    mesh = stl(tmp_path / "soup.stl", RANDOM.random((150_000, 3, 3)))
    load_mesh(mesh)
    found = []
    # 0.5 s of an idle core; each part for itself took minutes.
    assert seconds(lambda: found.append(standing_parts(mesh))) < 15
    assert (found[0].pieces, found[0].hulls) == ((), 1)


@pytest.mark.parametrize("corners", [1000, 20_000])
def test_triangles_that_hang_together_at_random_are_a_hull(corners):
    points = RANDOM.random((corners, 3))
    faces = RANDOM.integers(0, corners, (100_000, 3))
    found = []
    assert seconds(lambda: found.append(standing_pieces(points, faces))) < 15
    assert (found[0].pieces, found[0].hulls) == ((), 1)


def test_a_polygon_with_many_corners_is_cut_quickly():
    """A comb, of which each ear was looked for among all corners."""
    teeth = 3000
    x = np.arange(2 * teeth, dtype=float)
    comb = np.column_stack([x, np.where(np.arange(2 * teeth) % 2, 5.0, 1.0), 0 * x])
    comb = np.concatenate([comb, [[x[-1], 0, 0], [0, 0, 0]]])
    found = []
    assert seconds(lambda: found.append(triangulate([len(comb)], comb))) < 10
    a, b, c = (comb[found[0][:, k]] for k in range(3))
    area = np.abs(np.cross(b - a, c - a)[:, 2]).sum() / 2
    x, y = comb[:, 0], comb[:, 1]
    assert area == pytest.approx(abs((x * np.roll(y, -1) - np.roll(x, -1) * y).sum()) / 2)


def test_a_mesh_has_a_most_of_bytes_and_triangles(tmp_path, monkeypatch):
    mesh = stl(tmp_path / "a.stl", RANDOM.random((300, 3, 3)))
    monkeypatch.setattr(loading, "MOST_TRIANGLES", 299)
    with raises(MESH_UNREADABLE, triangles=300, most=299):
        load_mesh(mesh)
    monkeypatch.setattr(loading, "MOST_BYTES", 15_000)
    with raises(MESH_UNREADABLE, bytes=84 + 50 * 301, most=15_000):
        load_mesh(stl(tmp_path / "b.stl", RANDOM.random((301, 3, 3))))


def test_instances_of_a_geometry_count_each(tmp_path, monkeypatch):
    from cartwheel.description.meshes import dae

    monkeypatch.setattr(dae, "MOST_TRIANGLES", 100)
    shown = '<instance_geometry url="#g"/>' * 101
    (tmp_path / "a.dae").write_text(
        f"""<COLLADA><library_geometries><geometry id="g"><mesh>
        <source id="p"><float_array>0 0 0 1 0 0 0 1 0</float_array></source>
        <vertices id="v"><input semantic="POSITION" source="#p"/></vertices>
        <triangles><input semantic="VERTEX" source="#v" offset="0"/><p>0 1 2</p></triangles>
        </mesh></geometry></library_geometries>
        <library_visual_scenes><visual_scene><node>{shown}</node></visual_scene>
        </library_visual_scenes></COLLADA>"""
    )
    with raises(MESH_UNREADABLE, name=str(tmp_path / "a.dae")):
        load_mesh(Mesh(uri="", path=tmp_path / "a.dae"))
    monkeypatch.setattr(dae, "MOST_TRIANGLES", 101)
    assert sum(len(part.faces) for part in load_mesh(Mesh(uri="", path=tmp_path / "a.dae"))) == 101
    assert submesh.MOST_TRIANGLES > 1_000_000


def polyline(points):
    return Polyline(points=tuple(map(tuple, points.tolist())), height=1.0)


def test_an_outline_that_crosses_itself_everywhere_is_refused_with_its_place():
    points = RANDOM.random((3000, 2)) * 10
    outline = "".join(f"<point>{x} {y}</point>" for x, y in points[:1500].tolist())
    text = f"""<sdf version="1.7"><model name="m"><static>1</static><link name="l">
      <collision name="c"><geometry>
        <polyline><height>1</height>{outline}</polyline>
      </geometry></collision></link></model></sdf>"""
    with raises(VALUE_INVALID, tag="polyline", kind="crossings", most=1000) as error:
        load_text(text, file="a.sdf")
    assert error.value.origin.line == 3
    with pytest.raises(OutlineError) as many:
        convex_pieces(polyline(points))
    assert (many.value.kind, many.value.most) == ("points", 2000)


@pytest.mark.parametrize("kind", ["star", "comb"])
def test_the_largest_outlines_are_built_within_seconds(kind):
    if kind == "star":
        points = RANDOM.random((60, 2))
    else:
        x = np.arange(1000, dtype=float)
        points = np.column_stack([x, np.where(x % 2, 5 + RANDOM.random(1000), RANDOM.random(1000))])
        points = np.concatenate([points, [[999, -1], [0, -1]]])
    shape = polyline(points)
    assert seconds(lambda: (convex_pieces(shape), solid(shape))) < 20
