"""Noise on orientations."""

import math

import numpy as np
import pytest

from cartwheel.devices.air.pose_sensor import tilted
from cartwheel.geometry import quat_from_rpy


def test_an_orientation_is_rotated_about_its_own_axes():
    level = quat_from_rpy(0.0, 0.0, math.pi / 2)
    assert tilted(level, np.zeros(3)) is level
    expected = quat_from_rpy(1e-3, 0.0, math.pi / 2)
    assert tilted(level, np.array([1e-3, 0.0, 0.0])) == pytest.approx(expected, abs=1e-8)
