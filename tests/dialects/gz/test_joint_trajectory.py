"""Joints that follow the points of a trajectory: by PIDs, against their steady states."""

import math

import pytest
from tests.coded import coded

from cartwheel.codes import devices, running
from cartwheel.errors import PluginError
from cartwheel.messages import message_class

G = 9.8
ARM = 0.5
MASS = 2.0
TOPIC = "/model/arm/joint_trajectory"


def arm(make, tags, joints=("first",), gravity=0.0, axis="0 0 1"):
    links, made, parent = "", "", "base"
    for number, name in enumerate(joints):
        links += f"""<link name="l{number}"><inertial><pose>{ARM} 0 0 0 0 0</pose>
          <mass>{MASS}</mass><inertia><ixx>.01</ixx><iyy>.01</iyy><izz>.01</izz></inertia>
          </inertial></link>"""
        made += f"""<joint name="{name}" type="revolute"><parent>{parent}</parent>
          <child>l{number}</child><axis><xyz>{axis}</xyz></axis></joint>"""
    model = f"""<model name="arm"><link name="base"><inertial><mass>1</mass></inertial></link>
      {links}<joint name="bolt" type="fixed"><parent>world</parent><child>base</child></joint>{made}
      <plugin name="t" filename="gz-sim-joint-trajectory-controller-system">{tags}</plugin>
      </model>"""
    return make.world(make.sdf(model), ground=None, gravity=gravity, step=0.001)


def trajectory(names, points, stamp=0):
    """Points are (seconds, positions, velocities, efforts)."""
    kind = message_class
    made = []
    for seconds, positions, velocities, effort in points:
        due = kind("builtin_interfaces/msg/Duration")(
            int(seconds), round((seconds - int(seconds)) * 1e9)
        )
        made.append(
            kind("trajectory_msgs/msg/JointTrajectoryPoint")(positions, velocities, [], effort, due)
        )
    head = kind("std_msgs/msg/Header")(kind("builtin_interfaces/msg/Time")(stamp, 0), "")
    return kind("trajectory_msgs/msg/JointTrajectory")(head, list(names), made)


def position(world, joint="first"):
    return world.session.simulation.joint_position("arm", joint)


POSITION = "<position_p_gain>{p}</position_p_gain><position_d_gain>{d}</position_d_gain>"
INERTIA = 0.01 + MASS * ARM**2
CRITICAL = POSITION.format(p=100 * INERTIA, d=20 * INERTIA)
"""Critically damped at 10 /s."""


def test_each_point_is_held_until_the_next_one_s_turn_and_progress_is_published(make):
    world = arm(make, CRITICAL)
    reported = world.mailbox(f"{TOPIC}_progress")
    points = [(1.0, [0.5], [], []), (2.0, [-0.3], [], []), (3.0, [0.2], [], [])]
    world.publish(TOPIC, trajectory(["first"], points))
    world.run(1.0)
    # A step of 0.5, after 1 s: x = 0.5 (1 - (1 + w t) exp(-w t)).
    assert position(world) == pytest.approx(0.5 * (1 - 11 * math.exp(-10)), abs=1e-3)
    world.run(1.0)
    assert position(world) == pytest.approx(-0.3, abs=2e-3)
    world.run(2.0)
    assert position(world) == pytest.approx(0.2, abs=1e-3)
    assert [message.data for message in reported.drain()] == pytest.approx([1 / 3, 2 / 3, 1.0])


def test_a_load_bends_it_by_what_its_gain_allows(make):
    """Level, p (target - x) = m g r cos x."""
    gain = 200.0
    world = arm(make, POSITION.format(p=gain, d=20.0), gravity=G, axis="0 1 0")
    world.run(4.0)
    assert gain * -position(world) == pytest.approx(
        -MASS * G * ARM * math.cos(position(world)), rel=1e-3
    )


def test_an_integral_takes_the_load_and_its_bound_limits_that(make):
    free = "<position_i_gain>200</position_i_gain>"
    world = arm(make, POSITION.format(p=200.0, d=20.0) + free, gravity=G, axis="0 1 0")
    world.run(10.0)
    assert position(world) == pytest.approx(0, abs=1e-3)
    bound = free + "<position_i_min>-2</position_i_min><position_i_max>2</position_i_max>"
    world = arm(make, POSITION.format(p=200.0, d=20.0) + bound, gravity=G, axis="0 1 0")
    world.run(4.0)
    left = MASS * G * ARM * math.cos(position(world)) - 2
    assert 200 * position(world) == pytest.approx(left, rel=1e-3)


def test_velocities_and_efforts_of_a_point_add_up(make):
    """Free of gravity: p_v (u - v) + effort = 0 in the end."""
    world = arm(make, "<velocity_p_gain>4</velocity_p_gain>")
    world.publish(TOPIC, trajectory(["first"], [(1.0, [], [0.5], [1.0])]))
    world.run(2.0)
    before = position(world)
    world.run(1.0)
    assert position(world) - before == pytest.approx(0.5 + 1.0 / 4, rel=1e-3)


def test_a_force_is_no_more_than_its_bound(make):
    """From rest with 0.1 N m: x = M t² / 2 I."""
    tags = POSITION.format(p=100.0, d=0.0) + (
        "<position_cmd_min>-0.1</position_cmd_min><position_cmd_max>0.1</position_cmd_max>"
    )
    world = arm(make, tags)
    world.publish(TOPIC, trajectory(["first"], [(1.0, [3.0], [], [])]))
    world.run(1.0)
    assert position(world) == pytest.approx(0.1 / INERTIA / 2, rel=0.01)


def test_gains_and_first_positions_are_given_joint_by_joint(make):
    tags = f"""<joint_name>second</joint_name><joint_name>first</joint_name>
      <initial_position>0.4</initial_position><initial_position>-0.2</initial_position>
      {CRITICAL}{CRITICAL}"""
    world = arm(make, tags, joints=("first", "second"))
    world.run(2.0)
    assert position(world, "second") == pytest.approx(0.4, abs=1e-3)
    assert position(world, "first") == pytest.approx(-0.2, abs=1e-3)
    world.publish(TOPIC, trajectory(["first", "gone"], [(1.0, [0.1, 9.0], [], [])]))
    world.run(2.0)
    assert position(world, "first") == pytest.approx(0.1, abs=1e-3)
    assert position(world, "second") == pytest.approx(0.4, abs=1e-3)
    world.reset()
    world.run(2.0)
    assert position(world, "first") == pytest.approx(-0.2, abs=1e-3)


def test_times_can_count_from_the_header_s_stamp(make):
    tags = CRITICAL + "<use_header_start_time>1</use_header_start_time>"
    world = arm(make, tags)
    world.run(2.0)
    # Its first point was due at 1 s: the second one counts at once.
    points = [(1.0, [0.9], [], []), (5.0, [0.2], [], [])]
    world.publish(TOPIC, trajectory(["first"], points))
    world.run(1.5)
    assert position(world) == pytest.approx(0.2, abs=1e-3)


@pytest.mark.parametrize(
    ("names", "positions", "fault"),
    [
        (["gone"], [0.1], "joints"),
        (["first"], [0.1, 0.2], "positions"),
    ],
)
def test_a_trajectory_that_makes_no_sense_is_reported_and_left(make, names, positions, fault):
    world = arm(make, CRITICAL)
    world.publish(TOPIC, trajectory(names, [(1.0, positions, [], [])]))
    world.run(0.5)
    assert coded(world, running.TRAJECTORY_INVALID, fault=fault)
    assert position(world) == pytest.approx(0, abs=1e-6)


def test_without_gains_it_is_reported_and_without_joints_refused(make):
    world = arm(make, "")
    assert coded(world, devices.PLUGIN_IDLE)
    still = make.sdf("""<model name="m"><link name="l"/>
      <plugin name="t" filename="gz-sim-joint-trajectory-controller-system"/></model>""")
    with pytest.raises(PluginError) as caught:
        make.world().session.spawn(still)
    assert caught.value.code is devices.PLUGIN_IDLE
