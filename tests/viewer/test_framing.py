"""From where the page looks at a robot first."""

import math

import numpy as np
import pytest

import cartwheel.viewer
from cartwheel.description import load_robot, load_text, load_world
from cartwheel.description.files.package_folders import share
from cartwheel.geometry import Pose
from cartwheel.session import Session
from cartwheel.simulation.pacing import Pacer
from cartwheel.viewer.framing import views

from .conftest import eventually

CART = share() / "robots/rosbots_description/urdf/rosbots.xacro"
WALL = """<sdf version="1.7"><model name="wall"><static>true</static><link name="wall">
  <visual name="wall"><geometry><box><size>0.1 1 3</size></box></geometry></visual>
</link></model></sdf>"""


@pytest.fixture(scope="module")
def cart():
    return load_robot(CART)


def test_the_view_turns_with_the_robot_and_grows_with_it(cart):
    target, eyes = views(cart, Pose())
    turned = Pose.from_xyz_rpy((5.0, -2.0, 0.3), (0, 0, math.pi / 2))
    other, moved = views(cart, turned)
    assert other == pytest.approx(turned.apply(target))
    for eye, expected in zip(moved, eyes, strict=True):
        assert eye == pytest.approx(turned.apply(expected))
    reach = math.dist(eyes[0], target)
    # Its largest side, the way over both wheels, is 1.2 m; it fills a third of the picture.
    assert 2 * 1.2 < reach < 4 * 1.2
    assert all(math.dist(eye, target) == pytest.approx(reach) for eye in eyes)
    # Behind it and to its right, from above.
    assert eyes[0][0] < -1 and eyes[0][1] < -1 and eyes[0][2] > 1


def first_view(session):
    """The camera that the first browser gets."""
    viewer = cartwheel.viewer.Viewer(session, port=0)
    pacer = Pacer(session.simulation)
    viewer.start(pacer)
    assert viewer.url
    camera = viewer._page.server.initial_camera
    before = np.array(camera.position)
    simulation = session.simulation

    def aimed():
        simulation.drain()
        for frames in pacer._frames:
            frames.listener(simulation.snapshot())
        return not np.array_equal(camera.position, before)

    eventually(aimed, what="the first view")
    viewer.close()
    return np.array(camera.position), np.array(camera.look_at)


def test_the_first_view_is_past_what_stands_in_the_way(cart):
    pose = Pose.from_xyz_rpy((3.0, 4.0, 0.1), (0, 0, 1.0))
    session = Session(load_world(share() / "worlds/empty.world"))
    session.spawn(cart, pose=pose)
    target, eyes = views(cart, pose)
    position, look_at = first_view(session)
    assert position == pytest.approx(np.array(eyes[0]), abs=1e-6)
    assert look_at == pytest.approx(np.array(target), abs=1e-6)

    # A wall half way to that eye, square to the view: a metre wide, it hides only this view.
    way = np.subtract(eyes[0], target)
    middle = (np.array(target) + 0.5 * way).tolist()
    heading = math.atan2(way[1], way[0])
    session.spawn(load_text(WALL), pose=Pose.from_xyz_rpy(middle, (0, 0, heading)))
    position, _ = first_view(session)
    assert position == pytest.approx(np.array(eyes[1]), abs=1e-6)
    session.close()
