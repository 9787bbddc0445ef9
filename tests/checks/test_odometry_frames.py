"""Odometry frames that are links of the robot."""

import pytest
from tests.corpus.carts import cart, plugin, written

import cartwheel
from cartwheel.codes.devices import ODOMETRY_FRAME_IS_LINK

LINK = (
    '<link name="{name}"/><joint name="o" type="{kind}"><parent link="{name}"/>'
    '<child link="base"/></joint>'
)
ODOM = LINK.format(name="odom", kind="fixed")
FRAME = "<odometryFrame>{}</odometryFrame>"


@pytest.mark.parametrize(
    ("more", "tags", "found"),
    [
        (ODOM, FRAME.format("odom"), "odom"),
        (ODOM, FRAME.format("/odom"), "odom"),
        # The default
        (ODOM, "", "odom"),
        (LINK.format(name="start", kind="fixed"), FRAME.format("start"), "start"),
        ("", FRAME.format("odom"), ""),
        (ODOM, FRAME.format("odom_1"), ""),
        # robot_state_publisher does not publish the transform of such a joint.
        (LINK.format(name="odom", kind="floating"), FRAME.format("odom"), ""),
        (ODOM, "<publishOdomTF>false</publishOdomTF>", ""),
        (ODOM, "<publishTf>0</publishTf>", ""),
        # In ROS 2, it is published only on request.
        (ODOM, "<ros/>", ""),
        (ODOM, "<ros/><publish_odom_tf>true</publish_odom_tf>", "odom"),
    ],
)
def test_a_link_with_the_name_of_the_odometry_frame_is_reported(tmp_path, more, tags, found):
    path = written(tmp_path, cart(), more, plugin(more=tags))
    reported = [e for e in cartwheel.check(path).findings if e.code is ODOMETRY_FRAME_IS_LINK]
    assert [each.values["link"] for each in reported] == ([found] if found else [])
