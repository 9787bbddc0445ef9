"""The view of a logical camera: a truncated pyramid."""

import pytest

from cartwheel.devices.cameras.logical_camera import in_view


@pytest.mark.parametrize(
    ("position", "expected"),
    [
        ((1.0, 0.0, 0.0), True),
        ((3.0, 0.0, 0.0), True),
        ((0.99, 0.0, 0.0), False),
        ((3.01, 0.0, 0.0), False),
        ((-2.0, 0.0, 0.0), False),
        ((2.0, 1.0, -0.5), True),
        ((2.0, -1.0, 0.5), True),
        ((2.0, 1.01, 0.0), False),
        ((2.0, 0.0, -0.51), False),
    ],
)
def test_a_point_is_in_view_within_the_pyramid(position, expected):
    view = {"near": 1.0, "far": 3.0, "half_width": 0.5, "half_height": 0.25}
    assert in_view(position, **view) is expected
