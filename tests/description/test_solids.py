"""What rays meet and whether bodies overlap, against boxes whose answer is plain."""

import math

import numpy as np
import pytest

from cartwheel.description.model import (
    Box,
    Capsule,
    Collision,
    Cone,
    Cylinder,
    Ellipsoid,
    Plane,
    Sphere,
)
from cartwheel.description.solids import first_hits, overlap, solid_of
from cartwheel.errors import Origin
from cartwheel.geometry import Pose

HERE = Origin(file="test", line=1)
CORNERS = np.array([[x, y, z] for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)]) / 2


def solid(shape, pose=Pose()):  # noqa: B008
    return solid_of(Collision(name="c", shape=shape, pose=pose, origin=HERE), "link")


@pytest.mark.parametrize(
    ("shape", "size"),
    [
        (Box(size=(1, 2, 3)), (1, 2, 3)),
        (Sphere(radius=1), (2, 2, 2)),
        (Ellipsoid(radii=(1, 2, 3)), (2, 4, 6)),
        (Cylinder(radius=1, length=3), (2, 2, 3)),
        (Capsule(radius=1, length=3), (2, 2, 5)),
        (Cone(radius=1, length=3), (2, 2, 3)),
    ],
)
def test_a_shape_has_its_size_about_its_middle(shape, size):
    vertices = solid(shape).vertices
    assert np.ptp(vertices, axis=0) == pytest.approx(size, rel=0.01)
    assert (vertices.max(axis=0) + vertices.min(axis=0)) / 2 == pytest.approx(0, abs=0.02)


def test_a_plane_is_no_solid():
    assert solid(Plane()) is None


def test_rays_meet_a_box_where_it_is():
    box = solid(Box(size=(1, 1, 1)), Pose((2.0, 0.0, 0.0)))
    angle = math.radians(10)
    rays = np.array([[1.0, 0, 0], [-1.0, 0, 0], [math.cos(angle), math.sin(angle), 0]])
    hits = first_hits(np.zeros(3), rays, box)
    assert hits[0] == pytest.approx(1.5)
    assert hits[1] == math.inf
    assert hits[2] == pytest.approx(1.5 / math.cos(angle))
    # Begun within, a ray meets the far side, which is not seen from behind.
    assert first_hits(np.zeros(3), rays[:1], box, beyond=2.0)[0] == pytest.approx(2.5)
    assert first_hits(np.zeros(3), rays[:1], box, beyond=2.0, front_only=True)[0] == math.inf


def test_boxes_overlap_where_they_do_in_all_three_axes():
    rng = np.random.default_rng(1)
    found = {True: 0, False: 0}
    for _ in range(400):
        one, other = rng.uniform(0.05, 1, 3), rng.uniform(0.05, 1, 3)
        centre = rng.uniform(-0.7, 0.7, 3)
        depth = min((one + other) / 2 - abs(centre))
        if abs(depth - 0.002) < 1e-6:
            continue
        assert overlap(CORNERS * one, CORNERS * other + centre, 0.002) == (depth > 0.002)
        found[bool(depth > 0.002)] += 1
    assert min(found.values()) > 50


def test_one_within_the_other_overlaps():
    assert overlap(CORNERS, CORNERS * 0.1, 0.002)
    assert overlap(CORNERS, CORNERS, 0.002)
