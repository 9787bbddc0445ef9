"""The arithmetic of depth cameras, without a simulation."""

import math

import numpy as np
import pytest

from cartwheel.devices.cameras.depth_camera import clip, points, to_millimetres

DEPTHS = np.array([[0.1, 0.4, 1.0, 5.0, math.inf]], dtype=np.float32)


@pytest.mark.parametrize(
    ("beyond", "furthest", "expected"),
    [
        ("nan", 5.0, [math.nan, math.nan, 1.0, math.nan, math.nan]),
        ("inf", 5.0, [-math.inf, -math.inf, 1.0, math.inf, math.inf]),
        ("nan", math.inf, [math.nan, math.nan, 1.0, 5.0, math.nan]),
        ("inf", math.inf, [-math.inf, -math.inf, 1.0, 5.0, math.inf]),
    ],
)
def test_depths_at_the_limits_and_beyond_are_marked(beyond, furthest, expected):
    # 0.4 is slightly larger as float32 than as float64.
    clipped = clip(DEPTHS, float(np.float32(0.4)), furthest, beyond=beyond)
    assert clipped.dtype == np.float32
    np.testing.assert_array_equal(clipped, [expected])


def test_depths_in_millimetres_fit_into_16_bits():
    depths = np.array([0.0, 1.2345, 65.5, 65.6, math.nan, math.inf, -math.inf], dtype=np.float32)
    whole = to_millimetres(depths)
    assert whole.dtype == np.uint16
    # Fractions of a millimetre are cut off.
    assert whole.tolist() == [0, 1234, 65500, 0, 0, 0, 0]


@pytest.mark.parametrize("optical", [True, False])
def test_a_point_is_its_direction_times_its_depth(optical):
    depths = np.array([2.0, 4.0], dtype=np.float32)
    right = np.array([0.5, -0.25], dtype=np.float32)
    down = np.array([-1.0, 0.5], dtype=np.float32)
    x, y, z = points(depths, right, down, infinite=False, optical=optical)
    if optical:
        assert (x.tolist(), y.tolist(), z.tolist()) == ([1.0, -1.0], [-2.0, 2.0], [2.0, 4.0])
    else:
        assert (x.tolist(), y.tolist(), z.tolist()) == ([2.0, 4.0], [-1.0, 1.0], [2.0, -2.0])


@pytest.mark.parametrize("optical", [True, False])
@pytest.mark.parametrize("depth", [math.inf, -math.inf])
def test_a_point_at_an_infinite_depth_has_three_equal_coordinates(optical, depth):
    depths = np.full(3, depth, dtype=np.float32)
    slopes = np.array([-0.5, 0.0, 0.5], dtype=np.float32)
    for values in points(depths, slopes, -slopes, infinite=True, optical=optical):
        assert values.tolist() == [depth] * 3
