"""Positions at which a dock is seen, and at which a base is docked."""

import math

import pytest

from cartwheel.devices.bases.dock import Sighting, buoys, is_docked, sighting
from cartwheel.geometry import Pose


def test_receiver_and_emitter_see_each_other_in_their_own_frames():
    receiver = Pose.from_xyz_rpy((1, 0, 0), (0, 0, math.pi / 2))
    emitter = Pose.from_xyz_rpy((1, 2, 0.5), (0, 0, math.pi))
    assert sighting(receiver, emitter) == pytest.approx((2.0, 0.0, math.pi / 2))


@pytest.mark.parametrize(
    ("degrees", "seen"),
    [
        (-20, (True, False)),
        (0, (True, True)),
        (20, (False, True)),
        (26, (False, False)),
        (-26, (False, False)),
    ],
)
def test_the_buoys_overlap_in_the_middle(degrees, seen):
    assert buoys(math.radians(degrees)) == seen


@pytest.mark.parametrize(
    ("seen", "docked"),
    [
        (Sighting(0.07, 0.1, -0.1), True),
        (Sighting(0.08, 0.0, 0.0), False),
        (Sighting(0.0, 0.11, 0.0), False),
        (Sighting(0.0, 0.0, -0.11), False),
    ],
)
def test_a_base_is_docked_near_and_ahead(seen, docked):
    assert is_docked(seen) is docked
