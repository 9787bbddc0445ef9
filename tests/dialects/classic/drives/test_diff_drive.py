"""Odometry, TF and joint states of the cart, against its true motion and Gazebo's own messages."""

import math

import numpy as np
import pytest
from tests.coded import coded, raises

from cartwheel.codes import devices, running
from cartwheel.geometry import Pose, rotate
from cartwheel.messages import to_dict
from cartwheel.world.build import DEFAULT_STEP

COMMAND = "/part2_cmr/cmd_vel"
RADIUS, SEPARATION = 0.26, 1.1
PLUGIN = "differential_drive_controller"
JOINTS = {"right": "wheel_right_joint", "left": "wheel_left_joint"}

START = Pose((0, 0, 0.05))


def stamp(message):
    return message.header.stamp.sec * 1_000_000_000 + message.header.stamp.nanosec


def pose_of(message):
    place, turn = message.pose.pose.position, message.pose.pose.orientation
    return Pose((place.x, place.y, place.z), (turn.x, turn.y, turn.z, turn.w))


def place(make, robot, pose=START, **more):
    world = make.world(**more)
    world.session.spawn(robot, pose=pose)
    world.run(1.0)
    return world


def collect(world, topics, seconds):
    """What each topic carried over the next seconds."""
    boxes = {topic: world.graph.mailbox(topic, size=100_000) for topic in topics}
    world.run(seconds)
    for box in boxes.values():
        box.close()
    return {topic: box.drain() for topic, box in boxes.items()}


def test_world_odometry_is_the_truth(make, rosbots):
    """Pose of the base at the stamp, and its velocity in the base's own axes."""
    world = place(make, rosbots, Pose.from_xyz_rpy((1, 2, 0.05), (0, 0, 0.7)))
    simulation = world.session.simulation
    truth = {}

    def note(message):
        linear = simulation.data.joint("rosbots::base_footprint").qvel[:3].copy()
        angular = simulation.data.joint("rosbots::base_footprint").qvel[3:].copy()
        truth[stamp(message)] = (simulation.time_ns, simulation.pose("rosbots"), linear, angular)

    world.subscribe("/odom", note)
    world.publish(COMMAND, linear_x=0.5, angular_z=-0.4)
    messages = collect(world, ["/odom"], 3.0)["/odom"]
    assert len(messages) == len(truth) == 300
    for message in messages:
        time_ns, pose, linear, angular = truth[stamp(message)]
        assert stamp(message) == time_ns
        reported = pose_of(message)
        assert reported.position == pytest.approx(pose.position, abs=1e-9)
        assert reported.orientation == pytest.approx(pose.orientation, abs=1e-9)
        twist = message.twist.twist
        cos, sin = math.cos(pose.yaw), math.sin(pose.yaw)
        assert twist.linear.x == pytest.approx(cos * linear[0] + sin * linear[1], abs=1e-9)
        assert twist.linear.y == pytest.approx(cos * linear[1] - sin * linear[0], abs=1e-9)
        # qvel turns in the body's axes; it leans by less than a milliradian.
        assert twist.angular.z == pytest.approx(angular[2], abs=1e-6)
    last = messages[-1].twist.twist
    assert last.linear.x == pytest.approx(0.5, rel=0.02)
    assert last.angular.z == pytest.approx(-0.4, rel=0.02)


def test_encoder_odometry_is_the_wheels_turning(make, rosbots):
    """x' = v cos θ, y' = v sin θ, θ' = r (ω_r - ω_l) / s, summed here from joint_states."""
    robot = make.with_parameters(rosbots, PLUGIN, odometrySource="encoder")
    # Set down at its own height: what the wheels turn while it settles counts as well.
    world = make.world()
    world.session.spawn(robot)
    odometry, wheels = (
        world.mailbox("/odom", size=10_000),
        world.mailbox("/joint_states", size=10_000),
    )
    for forward, turn in ((0.5, 0.0), (0.5, 0.6), (-0.3, -0.2), (0.0, 0.5)):
        world.publish(COMMAND, linear_x=forward, angular_z=turn)
        world.run(2.0)
    messages, states = odometry.drain(), wheels.drain()
    assert [stamp(m) for m in messages] == [stamp(s) for s in states]
    x = y = heading = 0.0
    for message, before, after in zip(messages[1:], states[:-1], states[1:], strict=True):
        right, left = (
            RADIUS * (b - a) for a, b in zip(before.position, after.position, strict=True)
        )
        forward, turn = (left + right) / 2, (right - left) / SEPARATION
        if abs(turn) > 1e-12:
            # Along the arc: exact where both wheels turn steadily.
            x += forward / turn * (math.sin(heading + turn) - math.sin(heading))
            y -= forward / turn * (math.cos(heading + turn) - math.cos(heading))
        else:
            x, y = x + forward * math.cos(heading), y + forward * math.sin(heading)
        heading += turn
        reported = pose_of(message)
        # Near zero turning the arc's own formula loses digits: 1e-16 / 1e-12 a step at worst.
        assert (reported.x, reported.y, reported.z) == pytest.approx((x, y, 0), abs=1e-6)
        assert math.remainder(reported.yaw - heading, 2 * math.pi) == pytest.approx(0, abs=1e-9)
        assert message.twist.twist.linear.x == pytest.approx(forward / 0.01, abs=1e-9)
        assert message.twist.twist.angular.z == pytest.approx(turn / 0.01, abs=1e-9)


def test_encoder_odometry_is_true_where_wheels_roll(make, rosbots):
    world = place(make, make.with_parameters(rosbots, PLUGIN, odometrySource="encoder"))
    start = world.model("rosbots").pose
    reported_start = pose_of(collect(world, ["/odom"], 0.01)["/odom"][-1])
    world.publish(COMMAND, linear_x=0.5)
    reported = pose_of(collect(world, ["/odom"], 10.0)["/odom"][-1])
    way = world.model("rosbots").pose.x - start.x
    # Half a percent: tyres creep under the load of the ramp and give way by 0.05 mm of 260.
    assert reported.x - reported_start.x == pytest.approx(way, rel=5e-3)
    assert way > 4.5


def test_encoder_odometry_runs_ahead_where_wheels_slip(make, rosbots):
    """On ice of 0.02 the cart gains at most 0.02 g; its wheels, driven at 1 m/s², do not know."""
    robot = make.with_parameters(rosbots, PLUGIN, odometrySource="encoder")
    world = place(make, robot, ground=0.02)
    reported_start = pose_of(collect(world, ["/odom"], 0.01)["/odom"][-1])
    start = world.model("rosbots").pose
    world.publish(COMMAND, linear_x=2.0)
    reported = pose_of(collect(world, ["/odom"], 2.0)["/odom"][-1])
    way = world.model("rosbots").pose.x - start.x
    assert reported.x - reported_start.x > 1.5
    assert way < 0.02 * 9.8 * 2.0**2 / 2 * 1.05


def test_messages_are_as_gazebo_prints_them(make, rosbots):
    world = place(make, rosbots)
    reported = collect(world, ["/odom", "/joint_states", "/tf", "/tf_static"], 0.1)
    odometry = reported["/odom"][0]
    assert (odometry.header.frame_id, odometry.child_frame_id) == ("odom", "base_link")
    assert odometry.pose.covariance == pytest.approx(
        np.diag([1e-5, 1e-5, 1e12, 1e12, 1e12, 1e-3]).ravel()
    )
    assert not np.any(odometry.twist.covariance)
    state = to_dict(reported["/joint_states"][0])
    assert state["name"] == ["wheel_right_joint", "wheel_left_joint"]
    assert len(state["position"]) == 2
    assert (state["velocity"], state["effort"], state["header"]["frame_id"]) == ([], [], "")
    transforms = reported["/tf"][0].transforms
    # The root, so that robot_state_publisher's transforms below it leave one tree.
    assert [(t.header.frame_id, t.child_frame_id) for t in transforms] == [
        ("odom", "base_footprint"),
        ("base_link", "wheel_left_link"),
        ("base_link", "wheel_right_link"),
    ]
    (fixed,) = reported["/tf_static"][0].transforms
    assert (fixed.header.frame_id, fixed.child_frame_id) == ("base_footprint", "base_link")


def test_joint_states_are_the_wheels_angles(make, rosbots):
    world = place(make, rosbots)
    model = world.model("rosbots")
    seen = []
    world.subscribe(
        "/joint_states",
        lambda message: seen.append(
            (list(message.position), [model.joint(JOINTS[side]) for side in ("right", "left")])
        ),
    )
    world.publish(COMMAND, linear_x=0.3, angular_z=0.5)
    world.run(2.0)
    assert len(seen) == 200
    for reported, true in seen:
        assert reported == true
    right, left = seen[-1][0]
    assert right > left > 0 or left < 0 < right


def test_tf_is_the_odometry_and_the_wheels(make, rosbots):
    world = place(make, rosbots)
    world.publish(COMMAND, linear_x=0.5, angular_z=0.5)
    reported = collect(world, ["/odom", "/tf", "/joint_states"], 2.0)
    assert len(reported["/odom"]) == len(reported["/tf"]) == 200
    for odometry, tf, state in zip(
        reported["/odom"], reported["/tf"], reported["/joint_states"], strict=True
    ):
        base, left, right = tf.transforms
        assert stamp(base) == stamp(odometry) == stamp(state)
        # tf drops a transform of a child and stamp that it has, and robot_state_publisher
        # stamps the wheels' as their joint states are.
        assert stamp(left) == stamp(right) == stamp(state) + 1
        expected = pose_of(odometry)
        move, turn = base.transform.translation, base.transform.rotation
        assert (move.x, move.y, move.z) == expected.position
        assert (turn.x, turn.y, turn.z, turn.w) == expected.orientation
        for wheel, side, angle in (
            (left, 1, state.position[1]),
            (right, -1, state.position[0]),
        ):
            move, turn = wheel.transform.translation, wheel.transform.rotation
            assert (move.x, move.y, move.z) == pytest.approx(
                (0, side * SEPARATION / 2, RADIUS), abs=1e-9
            )
            # A wheel turned by its joint's angle about y.
            point = rotate((turn.x, turn.y, turn.z, turn.w), (0, 0, 1))
            assert point == pytest.approx((math.sin(angle), 0, math.cos(angle)), abs=1e-9)


def test_rates_are_exact_and_stamps_rise(make, rosbots):
    """100, 50 and 30 Hz over 10 s: 1000, 500 and 300 messages, 30 Hz on the steps that follow."""
    world = place(make, rosbots)
    reported = collect(
        world, ["/odom", "/tf", "/joint_states", "/bumpers", "/imu/data", "/clock"], 10.0
    )
    counts = {topic: len(messages) for topic, messages in reported.items()}
    assert counts == {
        "/odom": 1000,
        "/tf": 1000,
        "/joint_states": 1000,
        "/bumpers": 500,
        "/imu/data": 300,
        "/clock": counts["/clock"],
    }
    for topic in ("/odom", "/joint_states", "/bumpers", "/imu/data"):
        times = np.array([stamp(message) for message in reported[topic]])
        assert (np.diff(times) > 0).all()
    step = round(DEFAULT_STEP * 1e9)
    start = 1_000_000_000
    for topic, rate in (("/odom", 100), ("/bumpers", 50), ("/imu/data", 30)):
        for index, message in enumerate(reported[topic], 1):
            due = start + index * 1e9 / rate
            # At its due time or at the step after it, never a whole step late.
            assert 0 <= stamp(message) - due < step
    clock = [m.clock.sec * 10**9 + m.clock.nanosec for m in reported["/clock"]]
    assert (np.diff(clock) > 0).all()


def test_command_holds_until_the_next_and_stop_brakes(make, rosbots):
    world = place(make, rosbots)
    world.publish(COMMAND, linear_x=0.5)
    world.run(20.0)
    speed = collect(world, ["/odom"], 0.01)["/odom"][0].twist.twist.linear.x
    assert speed == pytest.approx(0.5, rel=0.02)
    before = world.model("rosbots").pose.x
    world.publish(COMMAND)
    world.run(2.0)
    # The ramp brakes as it drives: v²/2a, and what the ramp's stairs and the servo add.
    assert world.model("rosbots").pose.x - before == pytest.approx(0.5**2 / 2, abs=0.01)
    assert collect(world, ["/odom"], 0.01)["/odom"][0].twist.twist.linear.x == pytest.approx(
        0.0, abs=1e-3
    )


def test_a_command_that_is_no_number_is_reported_and_ignored(make, rosbots):
    world = place(make, rosbots)
    world.publish(COMMAND, linear_x=float("nan"))
    world.run(1.0)
    assert abs(world.model("rosbots").pose.x) < 1e-3
    assert coded(world, running.COMMAND_NOT_SIMULATED)


@pytest.mark.parametrize("stated", ["20", "0.1"])
def test_torque_under_its_older_name_is_ignored_as_in_gazebo(make, rosbots, stated):
    import dataclasses

    rosbots = make.with_parameters(rosbots, PLUGIN, torque=stated)
    (tag,) = (tag for tag in rosbots.plugins if tag.name == PLUGIN)
    kept = tuple(c for c in tag.element.children if c.tag != "wheelTorque")
    old = dataclasses.replace(tag, element=dataclasses.replace(tag.element, children=kept))
    plugins = tuple(old if other is tag else other for other in rosbots.plugins)
    world = place(make, dataclasses.replace(rosbots, plugins=plugins))
    assert world.session.simulation.model.tendon_frictionloss.tolist() == [5, 5]
    (note,) = coded(world, devices.PLUGIN_PARAMETER_OBSOLETE, parameter="torque", torque=5.0)
    assert note.severity == "info"


@pytest.mark.wording
def test_a_wheel_joint_that_is_fixed_is_said_to_be_so(make, rosbots):
    from cartwheel.errors import UnknownNameError

    fixed = next(joint.name for joint in rosbots.joints if joint.type == "fixed")
    wrong = make.with_parameters(rosbots, PLUGIN, leftJoint=fixed)
    with raises(devices.PLUGIN_JOINT_UNKNOWN, UnknownNameError, name=fixed) as caught:
        make.world().session.spawn(wrong)
    assert caught.value.message == f'joint "{fixed}" has the type fixed, so it cannot be driven'


def test_unknown_joint_names_the_likely_one(make, rosbots):
    from cartwheel.errors import UnknownNameError

    world = make.world()
    wrong = make.with_parameters(rosbots, PLUGIN, leftJoint="wheel_lft_joint")
    with pytest.raises(UnknownNameError) as caught:
        world.session.spawn(wrong)
    assert caught.value.code is devices.PLUGIN_JOINT_UNKNOWN
    assert caught.value.values["name"] == "wheel_lft_joint"
    assert caught.value.values["meant"] == "wheel_left_joint"
    assert world.models == ("ground_plane",)
    assert [topic.name for topic in world.graph.topics()] == ["/clock"]
