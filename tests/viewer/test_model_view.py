"""What is sent of a moving model, and the figures drawn of its masses."""

import math

import numpy as np
import pytest

from cartwheel.description.model import (
    Box,
    Collision,
    Inertial,
    Link,
    RobotDescription,
)
from cartwheel.errors import Origin
from cartwheel.geometry import Pose, quat_from_rpy, to_wxyz
from cartwheel.viewer.model_view import ModelView, footprint, inertia_box

ORIGIN = Origin(file="<test>")


class Node:
    """Stands for a node of the scene; counts what would be sent."""

    def __init__(self, name, sent):
        self.__dict__.update(name=name, sent=sent, show_axes=False, visible=True)

    def __setattr__(self, key, value):
        self.sent.append((self.name, key))
        self.__dict__[key] = value


class Stage:
    def __init__(self):
        self.sent = []
        self.nodes = {}

    def add_frame(self, name, **_):
        self.nodes[name] = Node(name, self.sent)
        return self.nodes[name]


def robot(*links):
    return RobotDescription(name="r", links=links, canonical_link="base", origin=ORIGIN)


def link(name, *, at=None, size=None):
    collisions = ()
    if size:
        collisions = (Collision(name=f"{name}_c", shape=Box(size=size), origin=ORIGIN),)
    return Link(name=name, pose=at or Pose(), collisions=collisions, origin=ORIGIN)


@pytest.fixture
def view():
    stage = Stage()
    made = ModelView(stage, "r", robot(link("base"), link("arm"), link("tip")))
    made.stage = stage
    return made


def state(base, arm, tip):
    poses = (base, base @ arm, base @ tip)
    return (
        np.array([pose.position for pose in poses]),
        np.array([to_wxyz(pose.orientation) for pose in poses]),
    )


ARM = Pose((0.3, 0.0, 0.1), quat_from_rpy(0.1, 0.2, 0.3))
TIP = Pose((0.5, 0.1, 0.2))


def test_links_are_given_in_the_canonical_one(view):
    base = Pose((1.0, 2.0, 0.5), quat_from_rpy(0.0, 0.0, 1.0))
    view.move(*state(base, ARM, TIP))
    nodes = view.stage.nodes
    np.testing.assert_allclose(nodes["/models/r"].position, base.position, atol=1e-12)
    np.testing.assert_allclose(nodes["/models/r/arm"].position, ARM.position, atol=1e-12)
    np.testing.assert_allclose(nodes["/models/r/arm"].wxyz, to_wxyz(ARM.orientation), atol=1e-12)


def test_a_driving_robot_sends_its_base_alone(view):
    view.move(*state(Pose(), ARM, TIP))
    view.stage.sent.clear()
    # A full turn, past the place where a quaternion and its negative change over.
    for i in range(1, 60):
        angle = 2 * math.pi * i / 60
        assert view.move(*state(Pose((0.1 * i, 0, 0), quat_from_rpy(0, 0, angle)), ARM, TIP))
    assert {name for name, _ in view.stage.sent} == {"/models/r"}


def test_a_turning_joint_sends_that_link_alone(view):
    view.move(*state(Pose(), ARM, TIP))
    view.stage.sent.clear()
    assert view.move(*state(Pose(), Pose(ARM.position, quat_from_rpy(0, 0, 0.2)), TIP))
    assert {name for name, _ in view.stage.sent} == {"/models/r/arm"}


def test_nothing_is_sent_of_what_rests_or_shivers(view):
    view.move(*state(Pose(), ARM, TIP))
    view.stage.sent.clear()
    for i in range(10):
        assert not view.move(*state(Pose((1e-7 * (i % 2), 0, -1e-7)), ARM, TIP))
    assert view.stage.sent == []


def test_slow_creeping_is_sent_in_the_end(view):
    """Stillness is judged from what was last sent, not from the frame before."""
    view.move(*state(Pose(), ARM, TIP))
    moved = [view.move(*state(Pose((4e-6 * i, 0, 0)), ARM, TIP)) for i in range(1, 10)]
    assert any(moved)


def test_the_box_of_an_inertia_is_the_box_it_came_from():
    # m (b² + c²) / 12 of a box of 0.2 x 0.4 x 0.6 m and 12 kg
    inertial = Inertial(
        mass=12.0, pose=Pose((0.1, 0, 0)), ixx=0.52, iyy=0.40, izz=0.20, origin=ORIGIN
    )
    pose, size = inertia_box(inertial)
    assert sorted(size) == pytest.approx([0.2, 0.4, 0.6])
    assert pose.position == (0.1, 0, 0)
    # The longest edge, about which the moment is least, must lie along z.
    axis = np.array(size).argmax()
    direction = [0.0, 0.0, 0.0]
    direction[axis] = 1.0
    assert abs(pose.apply(direction)[2]) == pytest.approx(1.0)


def test_the_footprint_is_the_circle_around_the_collisions():
    model = robot(
        link("base", size=(0.6, 0.8, 0.2)), link("mast", at=Pose((0, 0, 0.5)), size=(0.1, 0.1, 1))
    )
    reach, below = footprint(model)
    assert reach == pytest.approx(0.5)
    assert below == pytest.approx(0.1)
