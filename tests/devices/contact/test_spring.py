"""A link that is pulled to a frame, as a critically damped spring does."""

import dataclasses
import math

import numpy as np
import pytest

from cartwheel.codes import running
from cartwheel.devices.contact.force import half_rotation, spring_force
from cartwheel.errors import PluginError
from cartwheel.geometry import Pose, quat_from_rpy
from cartwheel.messages import message_class

MASS = 3.0
TURNED = 0.02


def body(make, plugin, *, pose="0 0 0.1 0 0 0", shape=""):
    return make.sdf(f"""<model name="body"><pose>{pose}</pose><link name="link">
      <inertial><mass>{MASS}</mass><inertia><ixx>{TURNED}</ixx><iyy>{TURNED}</iyy>
      <izz>{TURNED}</izz></inertia></inertial>{shape}</link>{plugin}</model>""")


def vector(message):
    return np.array([message.x, message.y, message.z])


HAND = """<plugin name="h" filename="libgazebo_ros_hand_of_god.so"><linkName>link</linkName>
  <frameId>hog</frameId>{}</plugin>"""


def wish(world, pose, *, parent="world", child="hog_desired"):
    """Publishes the transform of a frame."""
    kind = message_class
    place = kind("geometry_msgs/msg/Vector3")(*pose.position)
    turn = kind("geometry_msgs/msg/Quaternion")(*pose.orientation)
    sent = kind("geometry_msgs/msg/TransformStamped")(
        kind("std_msgs/msg/Header")(kind("builtin_interfaces/msg/Time")(0, 0), parent),
        child,
        kind("geometry_msgs/msg/Transform")(place, turn),
    )
    world.publish("/tf", kind("tf2_msgs/msg/TFMessage")([sent]))


def test_it_hangs_in_the_air_until_it_is_commanded_where_to(make):
    world = make.world(body(make, HAND.format(""), pose="0 0 2 0 0 0"), ground=None)
    world.run(2.0)
    assert world.model("body").pose.z == pytest.approx(2.0, abs=1e-6)


def test_it_nears_its_frame_as_a_critically_damped_spring_does(make, read):
    """x = 1 - (1 + w t) exp(-w t), with w² = kl / m."""
    step = 1e-3
    world = make.world(body(make, HAND.format("")), ground=None, step=step)
    wish(world, Pose((1.0, 0, 0.1)))
    world.run(0.3)
    omega = math.sqrt(200 / MASS)
    wanted = 1 - (1 + omega * 0.3) * math.exp(-omega * 0.3)
    # An implicit step lags by half of one and less.
    assert world.model("body").pose.x == pytest.approx(wanted, abs=omega * step)
    world.run(2.0)
    assert world.model("body").pose.position == pytest.approx((1, 0, 0.1), abs=1e-3)


def test_it_turns_to_its_frame_through_a_chain_of_frames(make):
    world = make.world(body(make, HAND.format("")), ground=None)
    wish(world, Pose((0, 0, 1), quat_from_rpy(0, 0, math.pi / 2)), child="table")
    wish(world, Pose((0.5, 0, 0), quat_from_rpy(0.3, 0, 0)), parent="table")
    world.run(4.0)
    pose = world.model("body").pose
    assert pose.position == pytest.approx((0, 0.5, 1), abs=1e-3)
    # Fixed axes: first about x, then about z.
    assert pose.orientation == pytest.approx(quat_from_rpy(0.3, 0, math.pi / 2), abs=1e-3)


def test_it_publishes_where_it_is(make):
    world = make.world(body(make, HAND.format(""), pose="1 2 3 0 0 0"), ground=None)
    box = world.mailbox("/tf")
    world.run(0.1)
    reported = [each for message in box.drain() for each in message.transforms]
    assert {(each.header.frame_id, each.child_frame_id) for each in reported} == {
        ("world", "hog_actual")
    }
    assert vector(reported[-1].transform.translation) == pytest.approx([1, 2, 3], abs=1e-6)


def test_a_stiff_pull_on_a_light_link_is_stable(make):
    stiff = "<kl>1e6</kl><ka>1e5</ka>"
    world = make.world(body(make, HAND.format(stiff)), ground=None, step=0.005)
    wish(world, Pose((0.2, 0.1, 0.3)))
    world.run(1.0)
    assert world.model("body").pose.position == pytest.approx((0.2, 0.1, 0.3), abs=1e-3)


def test_ros_2_s_spelling_has_the_world_s_frames(make):
    plugin = """<plugin name="h" filename="libgazebo_ros_hand_of_god.so"><ros/>
      <link_name>link</link_name></plugin>"""
    world = make.world(body(make, plugin), ground=None)
    wish(world, Pose((0.5, 0, 1)), child="world_desired")
    world.run(3.0)
    assert world.model("body").pose.position == pytest.approx((0.5, 0, 1), abs=1e-3)


def test_a_link_without_mass_is_refused(make):
    model = make.sdf("""<model name="m"><link name="a"><inertial><mass>1</mass></inertial></link>
      </model>""")
    link = dataclasses.replace(model.links[0], inertial=None)
    plugin = body(make, HAND.format("").replace(">link<", ">a<")).plugins
    bare = dataclasses.replace(model, links=(link,), plugins=plugin, static=True)
    with pytest.raises(PluginError) as caught:
        make.world().session.spawn(bare)
    assert caught.value.code is running.MODEL_NOT_MOVABLE


def test_a_critically_damped_spring_stops_at_its_target():
    """x = x0 (1 + w t) exp(-w t) with w² = k / m; an implicit step is wrong by order dt."""
    stiffness, mass, seconds = 50.0, 2.0, 1e-4
    omega = math.sqrt(stiffness / mass)
    x, speed = 1.0, 0.0
    for _ in range(5000):
        speed += spring_force(-x, speed, stiffness, mass, seconds) / mass * seconds
        x += speed * seconds
    assert x == pytest.approx((1 + omega * 0.5) * math.exp(-omega * 0.5), abs=10 * seconds)


def test_a_stiff_spring_does_not_overshoot_in_one_step():
    for stiffness in (1e3, 1e6, 1e9):
        speed = spring_force(0.1, 0.0, stiffness, 1e-3, 0.005) / 1e-3 * 0.005
        assert 0.0 < speed * 0.005 < 0.1


def test_springs_of_arrays_have_the_bits_of_those_of_floats():
    numbers = np.random.default_rng(2).uniform(0.1, 9.0, (4, 50))
    together = spring_force(*numbers, 0.005).tolist()
    assert together == [spring_force(*each, 0.005) for each in numbers.T.tolist()]


def test_half_a_rotation_is_that_of_the_shorter_way():
    turn = quat_from_rpy(0, 0, 0.6)
    assert half_rotation(turn) == pytest.approx([0, 0, 0.3])
    assert half_rotation([-each for each in turn]) == pytest.approx([0, 0, 0.3])
    assert half_rotation((0.0, 0.0, 0.0, 1.0)).tolist() == [0.0, 0.0, 0.0]
