"""Principal moments against numpy's solver; what no body can have."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from cartwheel.description.inertia import impossibility, made_possible, principal_moments

values = st.floats(-10, 10, allow_nan=False).map(lambda x: round(x, 6))


@settings(max_examples=200)
@given(st.tuples(*[values] * 6))
def test_moments_are_the_eigenvalues(entries):
    xx, yy, zz, xy, xz, yz = entries
    expected = np.linalg.eigvalsh([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])
    # The closed form loses half of the digits where two moments are alike.
    assert principal_moments((xx, yy, zz), (xy, xz, yz)) == pytest.approx(expected, abs=1e-6)


@given(
    st.lists(st.tuples(values, values, values), min_size=5, max_size=8),
    st.lists(st.floats(0.1, 5), min_size=8, max_size=8),
)
def test_any_cloud_of_masses_is_possible(points, masses):
    # I = sum m (|p|² 1 - p pᵀ), rounded as files round it.
    tensor = 1e-3 * np.eye(3)
    for point, mass in zip(np.array(points), masses, strict=False):
        tensor += mass * (point @ point * np.eye(3) - np.outer(point, point))
    moments = principal_moments(tuple(np.diag(tensor)), tuple(tensor[[0, 0, 1], [1, 2, 2]]))
    assert impossibility(moments) is None


def test_a_thin_plate_lies_on_the_edge():
    assert impossibility((1.0, 1.0, 2.0)) is None
    assert impossibility((1.0, 1.0, 2.001)) is None
    assert impossibility((1.0, 1.0, 2.1)) is not None


@pytest.mark.parametrize("moments", [(0, 0, 0), (0, 1, 1), (-1, 1, 1), (1e-20, 1, 1)])
def test_not_positive_definite(moments):
    assert impossibility(moments) is not None


@pytest.mark.wording
def test_an_impossible_inertia_says_why():
    assert "no rigid body can have this inertia" in impossibility((1.0, 1.0, 2.1))[0]
    assert "not positive definite" in impossibility((0, 1, 1))[0]


def test_moments_beyond_all_measure_are_no_crash():
    """1e308 is a finite number whose square is none."""
    assert principal_moments((1.0, 1e308, 1.0), (0.5, 0.0, 0.0)) == (1.0, 1.0, 1e308)


@given(st.tuples(*[st.floats(0, 10)] * 3), st.tuples(*[st.floats(-3, 3)] * 3))
def test_what_no_body_has_is_made_possible_about_the_same_axes(moments, turn):
    if max(moments) < 1e-3:
        return
    axes, _ = np.linalg.qr(np.eye(3) + np.cross(np.eye(3), turn))
    tensor = (axes * np.array(moments)) @ axes.T
    made, products = made_possible(tuple(np.diag(tensor)), tuple(tensor[[0, 0, 1], [1, 2, 2]]))
    found = principal_moments(made, products)
    assert impossibility(found) is None
    assert found[2] == pytest.approx(max(moments), rel=1e-6)
    small, middle, large = sorted(moments)
    missing = max(0.0, large - small - middle)
    raised = sorted((small + missing / 2, middle + missing / 2))
    assert found[:2] == pytest.approx(raised, rel=1e-4, abs=1e-5 * large)
