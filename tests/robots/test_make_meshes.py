"""The meshes in the repository are the script's, light, and of the size the description says."""

from __future__ import annotations

from pathlib import Path
from types import ModuleType
from xml.etree import ElementTree
from xml.etree.ElementTree import Element

import numpy as np
import pytest

COLLADA = "{http://www.collada.org/2005/11/COLLADASchema}"
BUDGET = 8000


def points(path: Path) -> np.ndarray:
    """Every vertex (n, 3) of a Collada file of ours, in metres."""
    root = ElementTree.parse(path).getroot()
    arrays = [
        np.array((array.text or "").split(), dtype=float).reshape(-1, 3)
        for array in root.iter(f"{COLLADA}float_array")
        if str(array.get("id")).endswith("positions-array")
    ]
    return np.concatenate(arrays)


def triangles(path: Path) -> int:
    root = ElementTree.parse(path).getroot()
    return sum(int(str(element.get("count"))) for element in root.iter(f"{COLLADA}triangles"))


@pytest.fixture(scope="module")
def meshes(repository: Path) -> Path:
    return repository / "robots/rosbots_description/meshes"


def test_script_writes_what_is_in_the_repository(
    make_meshes: ModuleType, repository: Path, tmp_path: Path
) -> None:
    written = set()
    for mesh in make_meshes.all_meshes():
        mesh.write(tmp_path)
        written.add(mesh.path)
        assert (tmp_path / mesh.path).read_bytes() == (repository / mesh.path).read_bytes(), (
            f"{mesh.path} is not what tools/make_meshes.py writes: run it"
        )
    kept = [*repository.glob("robots/**/*.dae"), *repository.glob("models/**/*.dae")]
    assert {path.relative_to(repository).as_posix() for path in kept} == written


def test_cart_is_light_enough_for_a_software_renderer(robot: Element, meshes: Path) -> None:
    names = [str(mesh.get("filename")).rsplit("/", 1)[-1] for mesh in robot.iter("mesh")]
    assert len(names) == 6
    assert sum(triangles(meshes / name) for name in names) < BUDGET


def test_units_and_axes_are_stated(meshes: Path) -> None:
    paths = list(meshes.glob("*.dae"))
    assert paths
    for path in paths:
        asset = ElementTree.parse(path).getroot().find(f"{COLLADA}asset")
        assert asset is not None
        unit = asset.find(f"{COLLADA}unit")
        assert unit is not None and unit.get("meter") == "1"
        assert asset.findtext(f"{COLLADA}up_axis") == "Z_UP"


def test_normals_are_unit_and_faces_turned_outward(make_meshes: ModuleType) -> None:
    from mesh_collada import corner_normals

    for mesh in make_meshes.all_meshes():
        for _, solid in mesh.parts:
            normals = corner_normals(solid)
            assert np.linalg.norm(normals, axis=2) == pytest.approx(1)
            corners = solid.vertices[solid.faces]
            face = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
            assert (np.einsum("ij,ikj->ik", face, normals) > 0).all()
            edges = {}
            for a, b in np.concatenate([solid.faces[:, [k, (k + 1) % 3]] for k in range(3)]):
                edges[a, b] = edges.get((a, b), 0) + 1
            assert set(edges.values()) == {1}, f"{mesh.path}: two faces run along one edge alike"
            if all((b, a) in edges for a, b in edges):
                volume = np.einsum("ij,ij->", corners[:, 0], np.cross(corners[:, 1], corners[:, 2]))
                assert volume > 0, f"{mesh.path}: a closed solid is inside out"


def test_wheel_fills_its_collision_cylinder(robot: Element, meshes: Path) -> None:
    cylinder = robot.find("link[@name='wheel_left_link']/collision/geometry/cylinder")
    assert cylinder is not None
    radius, width = (float(str(cylinder.get(key))) for key in ("radius", "length"))
    wheel = points(meshes / "wheel.dae")
    assert np.hypot(wheel[:, 0], wheel[:, 2]).max() == pytest.approx(radius, abs=1e-5)
    assert np.abs(wheel[:, 1]).max() == pytest.approx(width / 2, abs=1e-5)


def test_caster_ball_ends_where_its_collision_does(robot: Element, meshes: Path) -> None:
    sphere = robot.find("link[@name='caster_link']/collision/geometry/sphere")
    assert sphere is not None
    assert -points(meshes / "caster.dae")[:, 2].min() == pytest.approx(
        float(str(sphere.get("radius"))), abs=1e-6
    )


def test_chassis_and_bumper_fill_the_collision_box(robot: Element, meshes: Path) -> None:
    collision = robot.find("link[@name='base_link']/collision")
    assert collision is not None
    origin, box = collision.find("origin"), collision.find("geometry/box")
    assert origin is not None and box is not None
    centre = np.array(str(origin.get("xyz")).split(), dtype=float)
    half = np.array(str(box.get("size")).split(), dtype=float) / 2
    chassis = points(meshes / "chassis.dae")
    assert chassis.min(axis=0) == pytest.approx(centre - half, abs=1e-5)
    assert chassis.max(axis=0)[:2] == pytest.approx((centre + half)[:2], abs=1e-5)
    frame = points(meshes / "frame.dae")
    assert frame[:, 0].max() == pytest.approx(centre[0] + half[0], abs=1e-5)


def test_camera_stays_behind_its_own_eye(meshes: Path) -> None:
    assert 4 * points(meshes / "camera.dae")[:, 0].max() < 0
