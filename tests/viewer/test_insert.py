"""Where inserted things go, and what they are called."""

import math
import queue
import threading
from functools import partial

import numpy as np
import pytest

from cartwheel.description.files.package_folders import share
from cartwheel.description.model import WorldDescription
from cartwheel.geometry import Pose, quat_from_rpy
from cartwheel.session import Session
from cartwheel.simulation.models.occupied_space import Space
from cartwheel.simulation.models.unique_names import free_name
from cartwheel.viewer import Viewer
from cartwheel.viewer.panels.insert import InsertPanel, Size, free_place, palette


def space(*boxes, fixed=False):
    """Boxes: low and high corners, m."""
    corners = np.array(boxes, dtype=float).reshape(-1, 2, 3)
    return Space(low=corners[:, 0], high=corners[:, 1], fixed=np.full(len(corners), fixed))


def around(x, y, half):
    return ((x - half, y - half, 0.0), (x + half, y + half, 1.0))


SMALL = Size(reach=0.3, below=0.25, above=0.25)


def test_straight_ahead_on_the_ground_facing_as_the_robot():
    start = Pose((2.0, 1.0, 0.3), quat_from_rpy(0.0, 0.1, math.pi / 2))
    place = free_place(start, space(around(2.0, 1.0, 0.4)), SMALL)
    assert place.x == pytest.approx(2.0)
    assert place.y > 1.0 + 0.4 + 0.3
    assert place.z == pytest.approx(0.251)
    assert place.yaw == pytest.approx(math.pi / 2)


def test_never_where_something_stands():
    taken = [around(0.0, 0.0, 0.4)]
    for _ in range(12):
        place = free_place(Pose(), space(*taken), SMALL)
        for low, high in taken:
            gap = [max(0, low[i] - place.position[i], place.position[i] - high[i]) for i in (0, 1)]
            assert math.hypot(*gap) > 0.3
        taken.append(around(place.x, place.y, 0.3))


def test_not_below_what_can_fall_but_under_a_roof():
    above = ((-1.0, -1.0, 3.0), (9.0, 1.0, 3.1))
    assert abs(free_place(Pose(), space(above), SMALL).y) > 1.3
    roof = ((0.5, -1.0, 3.0), (9.0, 1.0, 3.1))
    assert free_place(Pose(), space(roof, fixed=True), SMALL).x == pytest.approx(1.0)


def test_the_floor_and_the_house_around_the_robot_take_no_place():
    floor = ((-9.0, -9.0, -0.1), (9.0, 9.0, 0.0))
    house = ((-9.0, -9.0, 0.0), (9.0, 9.0, 3.0))
    assert free_place(Pose(), space(floor, house, fixed=True), SMALL).x == pytest.approx(1.0)


def test_beyond_everything_when_nothing_near_is_free():
    place = free_place(Pose(), space(around(5.0, 0.0, 30.0)), SMALL)
    assert place.x == pytest.approx(35.6)


@pytest.fixture
def running(make):
    """A session that runs on a thread of its own, with the viewer."""
    session = Session(WorldDescription(name="test", models=(make.ground(),)))
    viewer = Viewer(session, port=0)
    pacer = session.pacer()
    viewer.start(pacer)
    thread = threading.Thread(target=pacer.run)
    thread.start()
    assert viewer.url
    yield session, viewer
    viewer.close()
    session.simulation.post(session.simulation.stop)
    thread.join(60)
    session.close()


def test_four_inserts_at_once_stand_apart_and_stay(running):
    """Each is placed against those before it, which no picture has shown yet."""
    session, viewer = running
    simulation = session.simulation
    panel = viewer._desk.panel(InsertPanel)
    names = ("barrel", "box_small", "traffic_cone", "barrel")
    done = queue.Queue()
    panel._inserted = done.put
    for name in names:
        viewer._page.post(partial(panel.insert, palette(share() / "models")[name]))
    inserted = [done.get(timeout=60) for _ in names]

    def places():
        return {name: simulation.pose(name).position for name in inserted}

    before = simulation.call(places).result(60)
    due = threading.Event()
    simulation.call(lambda: simulation.schedule(1, after=due.set)).result(60)
    assert due.wait(60)
    after = simulation.call(places).result(60)
    assert len(after) == 4
    for name in inserted:
        assert math.dist(before[name][:2], after[name][:2]) < 0.02, name
        others = [after[other][:2] for other in inserted if other != name]
        assert all(math.dist(after[name][:2], other) > 0.3 for other in others)


def test_names_get_the_first_free_number():
    assert free_name("box", ("post",)) == "box"
    assert free_name("box", ("box", "box_1")) == "box_2"


def test_the_palette_offers_things_and_no_scenery():
    names = palette(share() / "models")
    assert {"barrel", "box_small", "object", "ramp", "traffic_cone", "wall"} <= set(names)
    assert not {"sun", "ground_plane"} & set(names)
    assert all(path.is_file() for path in names.values())
