"""Where inserted things go, and what they are called."""

import math

import pytest

from cartwheel.description.packages import share
from cartwheel.geometry import Pose, quat_from_rpy
from cartwheel.simulation.naming import free_name
from cartwheel.viewer.panels.insert import free_place, palette


def test_straight_ahead_on_the_ground_facing_as_the_robot():
    start = Pose((2.0, 1.0, 0.3), quat_from_rpy(0.0, 0.1, math.pi / 2))
    place = free_place(start, [(2.0, 1.0, 0.4)], reach=0.3, below=0.25)
    assert place.x == pytest.approx(2.0)
    assert place.y > 1.0 + 0.4 + 0.3
    assert place.z == pytest.approx(0.251)
    assert place.yaw == pytest.approx(math.pi / 2)


def test_never_where_something_stands():
    taken = [(0.0, 0.0, 0.4)]
    for _ in range(12):
        place = free_place(Pose(), taken, reach=0.3, below=0.0)
        assert all(math.hypot(place.x - x, place.y - y) > r + 0.3 for x, y, r in taken)
        taken.append((place.x, place.y, 0.3))


def test_beyond_everything_when_nothing_near_is_free():
    place = free_place(Pose(), [(5.0, 0.0, 30.0)], reach=0.3, below=0.0)
    assert place.x == pytest.approx(21.0)


def test_names_get_the_first_free_number():
    assert free_name("box", ("post",)) == "box"
    assert free_name("box", ("box", "box_1")) == "box_2"


def test_the_palette_offers_things_and_no_scenery():
    names = palette(share() / "models")
    assert {"barrel", "box_small", "object", "ramp", "traffic_cone", "wall"} <= set(names)
    assert not {"sun", "ground_plane"} & set(names)
    assert all(path.is_file() for path in names.values())
