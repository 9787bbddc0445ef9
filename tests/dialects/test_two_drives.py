"""Two robots of a kind: namespaces and frame prefixes keep their drives apart."""

import pytest
from tests.devices.drives.carts import (
    CAR,
    FOUR,
    FRONT,
    PLANAR,
    ackermann,
    skid,
)

from cartwheel.geometry import Pose


@pytest.mark.parametrize(
    ("wheels", "plugin", "forks"),
    [
        (FOUR, skid("<broadcastTF>true</broadcastTF>"), ()),
        (FOUR, PLANAR.format(""), ()),
        (CAR, ackermann("<publish_odom_tf>true</publish_odom_tf>"), FRONT),
    ],
)
def test_a_namespace_and_a_prefix_keep_two_apart(make, cart, wheels, plugin, forks):
    world = make.world()
    model = cart(wheels, plugin, forks=forks)
    for name, y in (("one", 0.0), ("two", 3.0)):
        world.session.spawn(
            model, name=name, pose=Pose((0, y, 0.002)), namespace=name, frame_prefix=name
        )
    boxes = {
        topic: world.graph.mailbox(topic, size=1000) for topic in ("/one/odom", "/two/odom", "/tf")
    }
    world.run(0.5)
    world.publish("/one/cmd_vel", linear_x=0.3)
    world.run(2.0)
    one, two = (boxes[f"/{name}/odom"].drain()[-1] for name in ("one", "two"))
    assert (one.header.frame_id, one.child_frame_id) == ("one/odom", "one/base_link")
    assert (two.header.frame_id, two.child_frame_id) == ("two/odom", "two/base_link")
    assert one.pose.pose.position.x > 0.4
    assert abs(two.pose.pose.position.x) < 0.01
    children = {t.child_frame_id for m in boxes["/tf"].drain() for t in m.transforms}
    assert children == {"one/base_link", "two/base_link"}
