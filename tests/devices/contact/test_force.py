"""Commanded forces on links."""

import pytest
from tests.devices.bodies import BOX

from cartwheel.messages import message_class


def test_a_push_accelerates_by_newton_and_ends_with_the_next(make):
    model = f"""<model name="unit">{BOX}<plugin name="p" filename="libgazebo_ros_force.so">
      <bodyName>link</bodyName><topicName>push</topicName></plugin></model>"""
    world = make.world(make.sdf(model), gravity=0.0, ground=None)
    wrench = message_class("geometry_msgs/msg/Wrench")
    three = message_class("geometry_msgs/msg/Vector3")
    none = three(0.0, 0.0, 0.0)
    data = world.session.simulation.data
    for force, speed in ((8.0, 2.0), (0.0, 2.0), (-4.0, 1.0)):
        world.graph.publish(
            "/push", "geometry_msgs/msg/Wrench", wrench(three(force, 0.0, 0.0), none)
        )
        world.run(1.0)
        assert data.joint("unit::link").qvel[0] == pytest.approx(speed, abs=1e-9)
