"""Calls that a world refuses at once."""

import pytest

from cartwheel.errors import GraphError, SimulationError
from cartwheel.messages import from_dict


def test_a_callback_cannot_run_its_world(make):
    world = make.world()
    world.subscribe("/clock", lambda _: world.run(0.1))
    with pytest.raises(SimulationError) as caught:
        world.run(0.5)
    assert caught.value.code.name == "run-nested"
    assert world.time < 0.1


@pytest.mark.parametrize("value", ["hi", 3, object()])
def test_a_value_that_is_no_message_is_refused_at_once(value, make, rosbots):
    world = make.world()
    cart = world.spawn(rosbots, z=0.1)
    topic = "/part2_cmr/cmd_vel"
    with pytest.raises(GraphError) as caught:
        world.publish(topic, value)
    assert caught.value.code.name == "field-value-invalid"
    assert caught.value.values["type"] == "geometry_msgs/msg/Twist"
    # The drive works as before.
    world.publish(topic, from_dict("geometry_msgs/msg/Twist", {}))
    cart.publish(topic, linear_x=0.4)
    world.run(2)
    assert cart.pose.x > 0.3


def test_a_message_of_another_type_is_refused_at_once(make, rosbots):
    world = make.world()
    world.spawn(rosbots, z=0.1)
    with pytest.raises(GraphError) as caught:
        world.publish("/part2_cmr/cmd_vel", from_dict("std_msgs/msg/String", {}))
    assert caught.value.values["given"] == "std_msgs/msg/String"
