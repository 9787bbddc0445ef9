"""The part of a solid below a surface, compared with formulas."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from cartwheel.description.model import Box, Cylinder, Sphere
from cartwheel.description.shapes.triangles import triangles_of
from cartwheel.devices.water.immersion import below
from cartwheel.geometry import matrix_from_quat, quat_from_rpy


def corners(shape, at=(0.0, 0.0, 0.0), rpy=(0.0, 0.0, 0.0)):
    vertices, faces = triangles_of(shape)
    return (vertices @ matrix_from_quat(quat_from_rpy(*rpy)).T + np.array(at))[faces]


@given(height=st.floats(-0.9, 0.9))
def test_a_box_is_cut_level(height):
    box = corners(Box(size=(2.0, 1.0, 2.0)), at=(3.0, 4.0, 0.1))
    volume, moment = below(box, height + 0.1)
    depth = height + 1.0
    assert volume == pytest.approx(2.0 * depth)
    assert moment / volume == pytest.approx([3.0, 4.0, 0.1 - 1.0 + depth / 2])


@given(height=st.floats(-0.45, 0.45))
def test_a_sphere_is_cut_to_a_cap(height):
    """The polyhedron of a sphere has 3 % less volume than the sphere."""
    volume, moment = below(corners(Sphere(radius=0.5)), height)
    depth = height + 0.5
    cap = math.pi * depth**2 * (3 * 0.5 - depth) / 3
    centre = -3 * (2 * 0.5 - depth) ** 2 / (4 * (3 * 0.5 - depth))
    assert volume == pytest.approx(cap, rel=0.04, abs=0.002)
    assert moment[2] / volume == pytest.approx(centre, abs=0.01)


@given(
    height=st.floats(-2.0, 2.0),
    rpy=st.tuples(*(st.floats(-3.0, 3.0),) * 3),
    shape=st.sampled_from([Box(size=(1.0, 0.5, 2.0)), Cylinder(radius=0.4, length=1.5)]),
)
def test_what_is_below_and_above_is_the_whole(height, rpy, shape):
    """The solid turned upside down has above the surface what it had below."""
    solid = corners(shape, rpy=rpy)
    whole, moment = below(solid, 10.0)
    lower, lower_moment = below(solid, height)
    mirrored = (solid * np.array([1.0, -1.0, -1.0])).copy()
    upper, upper_moment = below(mirrored, -height)
    assert lower + upper == pytest.approx(whole)
    total = lower_moment + upper_moment * np.array([1.0, -1.0, -1.0])
    assert total == pytest.approx(moment, abs=1e-9)


def test_nothing_is_below_the_solid():
    volume, moment = below(corners(Box(size=(1.0, 1.0, 1.0))), -0.6)
    assert volume == 0.0
    assert moment == pytest.approx([0.0, 0.0, 0.0])
