"""Point clouds of a scan, without a simulation."""

import math

import numpy as np
import pytest

from cartwheel.devices.rays.outputs import XYZI, PointCloud2Output

RINGS = np.dtype([*((name, "<f4") for name in ("x", "y", "z", "intensity")), ("ring", "<u2")])
# Two rows of three rays along +x, +y and +z, of which one is too near and one hits nothing.
DIRECTIONS = np.broadcast_to(np.eye(3), (2, 3, 3))
RANGES = np.array([[1.0, 2.0, -math.inf], [4.0, math.inf, 6.0]])
INTENSITIES = np.array([[0.5, 1.5, 2.5], [3.5, 4.5, 5.5]])
HIT = [[True, True, False], [True, False, True]]


def cloud(**options):
    output = PointCloud2Output(topic="points", **options)
    return output.cloud(DIRECTIONS, RANGES, INTENSITIES, output.hits(RANGES))


def test_missing_points_are_omitted_row_by_row():
    points = cloud()
    assert points.dtype == XYZI
    assert points.tolist() == [(1, 0, 0, 0.5), (0, 2, 0, 1.5), (4, 0, 0, 3.5), (0, 0, 6, 5.5)]


def test_columns_come_first_if_the_points_are_ordered_by_columns():
    points = cloud(layout=RINGS, by_column=True)
    assert points["ring"].tolist() == [0, 1, 0, 1]
    assert points["intensity"].tolist() == [0.5, 3.5, 1.5, 5.5]


@pytest.mark.parametrize(("missing", "value"), [("nan", math.nan), ("inf", math.inf)])
def test_an_organised_cloud_has_a_point_for_each_ray(missing, value):
    points = cloud(layout=RINGS, missing=missing)
    assert points.shape == (2, 3)
    assert points["ring"].tolist() == [[0, 0, 0], [1, 1, 1]]
    for axis, name in enumerate("xyz"):
        expected = np.where(HIT, DIRECTIONS[..., axis] * np.where(HIT, RANGES, 0.0), value)
        np.testing.assert_array_equal(points[name], expected)
    # Only NaN marks the intensity too.
    kept = np.where(HIT, INTENSITIES, math.nan) if missing == "nan" else INTENSITIES
    np.testing.assert_array_equal(points["intensity"], kept)


def test_the_points_are_transposed_for_an_organised_cloud_by_columns():
    rows, columns = cloud(missing="nan"), cloud(missing="nan", by_column=True)
    assert columns.shape == (3, 2)
    np.testing.assert_array_equal(columns["intensity"], rows["intensity"].T)


def test_the_limits_are_exclusive():
    output = PointCloud2Output(topic="points", nearest=1.0, furthest=6.0)
    assert output.hits(RANGES).tolist() == [[False, True, False], [True, False, False]]


def test_low_intensities_are_raised_to_the_floor():
    assert cloud(intensity_floor=3.0)["intensity"].tolist() == [3.0, 3.0, 3.5, 5.5]
