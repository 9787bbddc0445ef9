"""A description alone: sliders move its links."""

import math
import socket

import pytest
from tests.coded import raises

from cartwheel.codes.wires import ADDRESS_UNAVAILABLE
from cartwheel.description.model import Axis, Joint, Link, RobotDescription
from cartwheel.errors import ControlError, Origin
from cartwheel.geometry import Pose
from cartwheel.viewer import DescriptionViewer
from cartwheel.viewer.panels.joints import limits_of

from .conftest import eventually

ORIGIN = Origin(file="<test>")


def joint(kind="revolute", **axis):
    return Joint(
        name="elbow", type=kind, parent="base", child="arm", axis=Axis(**axis), origin=ORIGIN
    )


def arm(elbow):
    return RobotDescription(
        name="arm",
        links=(
            Link(name="base", origin=ORIGIN),
            Link(name="arm", pose=Pose((0.5, 0.0, 0.0)), origin=ORIGIN),
        ),
        joints=(elbow,),
        canonical_link="base",
        origin=ORIGIN,
    )


@pytest.fixture
def viewer():
    made = DescriptionViewer(arm(joint(lower=-1.0, upper=2.0)), port=0)
    made.start()
    yield made
    made.close()


def test_a_slider_turns_the_link_about_its_joint(viewer):
    viewer._sliders["elbow"].value = 1.0
    node = viewer._model._frames[1]
    # About z by 1 rad: (cos 1/2, 0, 0, sin 1/2), at the place of the joint.
    expected = (math.cos(0.5), 0.0, 0.0, math.sin(0.5))
    eventually(lambda: tuple(node.wxyz) == pytest.approx(expected, abs=1e-6), what="the turn")
    assert tuple(node.position) == pytest.approx((0.5, 0.0, 0.0))


def test_zero_takes_it_back(viewer):
    viewer._sliders["elbow"].value = 1.5
    viewer._page.post(viewer._zero)
    node = viewer._model._frames[1]
    eventually(lambda: viewer._sliders["elbow"].value == 0.0, what="zero")
    eventually(lambda: tuple(node.wxyz) == pytest.approx((1, 0, 0, 0)), what="the way back")


def test_sliders_reach_from_limit_to_limit_or_a_turn_or_a_metre():
    assert limits_of(joint(lower=-1.0, upper=2.0)) == (-1.0, 2.0)
    assert limits_of(joint("continuous")) == (-math.pi, math.pi)
    assert limits_of(joint("prismatic")) == (-1.0, 1.0)
    low, high = limits_of(joint(lower=0.0, upper=0.0))
    assert low < high, "a slider without length could not be drawn"


def test_a_port_in_use_is_refused():
    with socket.create_server(("127.0.0.1", 0)) as taken:
        port = taken.getsockname()[1]
        with raises(ADDRESS_UNAVAILABLE, ControlError, port=port):
            DescriptionViewer(arm(joint()), port=port)
