"""Principal moments against numpy's solver; what no body can have."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from cartwheel.description.inertia import impossibility, principal_moments

values = st.floats(-10, 10, allow_nan=False).map(lambda x: round(x, 6))


@settings(derandomize=True, max_examples=200, deadline=None)
@given(st.tuples(*[values] * 6))
def test_moments_are_the_eigenvalues(entries):
    xx, yy, zz, xy, xz, yz = entries
    expected = np.linalg.eigvalsh([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])
    # The closed form loses half of the digits where two moments are alike.
    assert principal_moments((xx, yy, zz), (xy, xz, yz)) == pytest.approx(expected, abs=1e-6)


@settings(derandomize=True, max_examples=100, deadline=None)
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
    assert "no body has this inertia" in impossibility((1.0, 1.0, 2.1))[0]


@pytest.mark.parametrize("moments", [(0, 0, 0), (0, 1, 1), (-1, 1, 1), (1e-20, 1, 1)])
def test_not_positive_definite(moments):
    assert "not positive definite" in impossibility(moments)[0]
