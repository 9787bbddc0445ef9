"""Triangles of shapes, against the formulas of their volumes and areas."""

import math
from pathlib import Path

import numpy as np
import pytest
from tests.coded import raises

from cartwheel.codes.files import FILE_MISSING
from cartwheel.description.model import (
    Box,
    Capsule,
    Collision,
    Cone,
    Cylinder,
    Ellipsoid,
    Heightmap,
    Material,
    Mesh,
    Plane,
    Polyline,
    Sphere,
    Visual,
)
from cartwheel.errors import Origin
from cartwheel.geometry import Pose
from cartwheel.viewer.shapes import (
    DEFAULT,
    bounds_of,
    merge,
    surfaces_of_collision,
    surfaces_of_visual,
    triangles_of,
)

ORIGIN = Origin(file="<test>")


def volume(vertices, faces):
    """By the divergence theorem; positive only where the faces turn outwards."""
    a, b, c = (vertices[faces[:, k]].astype(float) for k in range(3))
    return float(np.einsum("ij,ij->i", a, np.cross(b, c)).sum() / 6)


# A circle of 32 corners has 32/2 sin(2π/32) / π of a circle's area.
ROUND = 16 * math.sin(math.pi / 16) / math.pi
# 0.6 % are lost around, and 16 steps from pole to pole lose 1 % more.
ROUGH = 0.018


@pytest.mark.parametrize(
    ("shape", "expected", "tolerance"),
    [
        (Box(size=(1.0, 2.0, 3.0)), 6.0, 1e-6),
        (Cylinder(radius=0.5, length=2.0), ROUND * math.pi * 0.25 * 2.0, 1e-5),
        (Cone(radius=0.5, length=3.0), ROUND * math.pi * 0.25, 1e-5),
        (Sphere(radius=0.5), 4 / 3 * math.pi * 0.125, ROUGH),
        (Ellipsoid(radii=(1.0, 2.0, 0.5)), 4 / 3 * math.pi, ROUGH),
        (Capsule(radius=0.5, length=2.0), math.pi * (0.5 + 0.125 * 4 / 3), ROUGH),
        (
            Polyline(points=((0, 0), (2, 0), (2, 2), (1, 0.5), (0, 2), (0, 0)), height=2.0),
            2.0 * 2.5,
            1e-6,
        ),
    ],
    ids=lambda value: type(value).__name__,
)
def test_solids_enclose_their_volume_with_faces_outwards(shape, expected, tolerance):
    assert volume(*triangles_of(shape)) == pytest.approx(expected, rel=tolerance)


def test_a_clockwise_outline_is_no_inside_out_prism():
    clockwise = Polyline(points=((0, 0), (0, 1), (1, 1), (1, 0)), height=1.0)
    assert volume(*triangles_of(clockwise)) == pytest.approx(1.0)


def test_shapes_reach_as_far_as_they_say():
    low, high = (
        triangles_of(Capsule(radius=0.2, length=1.0))[0].min(axis=0),
        triangles_of(Capsule(radius=0.2, length=1.0))[0].max(axis=0),
    )
    np.testing.assert_allclose(low, (-0.2, -0.2, -0.7), atol=1e-6)
    np.testing.assert_allclose(high, (0.2, 0.2, 0.7), atol=1e-6)


def test_a_plane_lies_across_its_normal():
    vertices, faces = triangles_of(Plane(normal=(1.0, 0.0, 0.0), size=(2.0, 4.0)))
    np.testing.assert_allclose(vertices[:, 0], 0.0, atol=1e-6)
    a, b, c = (vertices[faces[0, k]] for k in range(3))
    np.testing.assert_allclose(np.cross(b - a, c - a) / np.linalg.norm(np.cross(b - a, c - a)),
                               (1, 0, 0), atol=1e-6)  # fmt: skip


def test_a_heightmap_has_its_image_as_heights(tmp_path):
    from PIL import Image

    path = tmp_path / "hill.png"
    pixels = np.zeros((33, 33), dtype=np.uint8)
    pixels[0, 0] = 255  # the upper left corner of the image is at -x, +y
    Image.fromarray(pixels).save(path)
    vertices, _ = triangles_of(Heightmap(path=path, size=(10.0, 10.0, 2.0)))
    np.testing.assert_allclose(vertices[vertices[:, 2].argmax()], (-5, 5, 2), atol=1e-5)


def visual(shape, *, rgba=None, pose=None, transparency=0.0):
    return Visual(
        name="v",
        shape=shape,
        pose=pose or Pose(),
        material=Material(diffuse=rgba),
        transparency=transparency,
        origin=ORIGIN,
    )


def test_a_visual_stands_where_its_pose_puts_it_in_its_colour():
    pose = Pose.from_xyz_rpy((1, 2, 3), (0, 0, math.pi / 2))
    (surface,) = surfaces_of_visual(
        visual(Box(size=(0.2, 0.4, 0.6)), rgba=(1, 0, 0, 0.8), pose=pose, transparency=0.5)
    )
    assert surface.rgba == pytest.approx((1, 0, 0, 0.4))
    low, high = bounds_of([surface])
    np.testing.assert_allclose(low, (0.8, 1.9, 2.7), atol=1e-6)
    np.testing.assert_allclose(high, (1.2, 2.1, 3.3), atol=1e-6)


def test_what_states_no_colour_is_grey():
    (surface,) = surfaces_of_visual(visual(Sphere(radius=1.0)))
    assert surface.rgba == DEFAULT


def test_merging_gives_one_mesh_for_each_colour_and_loses_no_triangle():
    box = Box(size=(1.0, 1.0, 1.0))
    surfaces = [
        *surfaces_of_visual(visual(box, rgba=(1, 0, 0, 1))),
        *surfaces_of_visual(visual(box, rgba=(0, 0, 1, 1), pose=Pose((5, 0, 0)))),
        *surfaces_of_visual(visual(box, rgba=(1, 0, 0, 1), pose=Pose((9, 0, 0)))),
    ]
    merged = {surface.rgba: surface for surface in merge(surfaces)}
    assert set(merged) == {(1, 0, 0, 1), (0, 0, 1, 1)}
    red = merged[1, 0, 0, 1]
    assert volume(red.vertices, red.faces) == pytest.approx(2.0, rel=1e-5)
    np.testing.assert_allclose(bounds_of([red])[1], (9.5, 0.5, 0.5))


def test_a_mesh_that_is_missing_is_an_error_that_names_it():
    mesh = Mesh(uri="package://a/b.stl", path=Path("/nowhere/b.stl"))
    collision = Collision(name="c", shape=mesh, origin=ORIGIN)
    with raises(FILE_MISSING, name="/nowhere/b.stl"):
        surfaces_of_collision(collision, DEFAULT)
