"""The projection matrix P of a CameraInfo."""

import pytest

from cartwheel.devices.cameras.info import UNCHANGED, Rectified, projection


def test_by_default_it_has_the_entries_of_k():
    p = projection(UNCHANGED, 500.0, 320.5, 240.5, 0.0).reshape(3, 4)
    assert p.tolist() == [[500.0, 0, 320.5, 0], [0, 500.0, 240.5, 0], [0, 0, 1, 0]]


def test_the_right_camera_of_a_stereo_pair_has_the_baseline_in_tx():
    """Tx = -fx B. Source: sensor_msgs/CameraInfo."""
    assert projection(UNCHANGED, 500.0, 320.5, 240.5, 0.07)[3] == pytest.approx(-35.0)


def test_stated_entries_replace_those_of_k():
    rectified = Rectified(fx=1.0, fy=2.0, cx=0.0, cy=4.0, tx=5.0, ty=6.0)
    p = projection(rectified, 500.0, 320.5, 240.5, 0.07).reshape(3, 4)
    assert p.tolist() == [[1.0, 0, 0.0, 5.0], [0, 2.0, 4.0, 6.0], [0, 0, 1, 0]]
