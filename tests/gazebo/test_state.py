"""Poses and velocities: returned in any frame, and set without disturbing the physics."""

import math

import numpy as np
import pytest
from tests.coded import coded

from cartwheel.codes.graph import SERVICE_FAILED
from cartwheel.geometry import Pose, quat_from_rpy, rotate
from cartwheel.simulation.engine import Engine

from .conftest import CHAIN, notes, pose_fields, vec, xyz

TURNED = quat_from_rpy(0.3, -0.4, 1.1)
STEP = 0.005
CART_START = Pose((1.0, 2.0, 0.5), quat_from_rpy(0, 0, 0.7))


def quat(q):
    return np.array([q.x, q.y, q.z, q.w])


def twist_fields(linear=(0, 0, 0), angular=(0, 0, 0)):
    return {"linear": xyz(linear), "angular": xyz(angular)}


def same_turn(a, b):
    return abs(abs(float(np.dot(a, b))) - 1) < 1e-9


@pytest.fixture
def space(make, gazebo):
    """Weightless: a cube turned somehow, and a beacon."""
    return gazebo(
        make.world(
            make.box("cube", (0.5, 0.3, 0.2), pose=Pose((3.0, -1.0, 5.0), TURNED)),
            make.box("beacon", (0.1,) * 3, pose=Pose((1.0, 1.0, 1.0), quat_from_rpy(0, 0, 0.5))),
            ground=None,
            gravity=0.0,
        )
    )


def place(api, model="cube", position=(0, 0, 0), orientation=(0, 0, 0, 1), frame="", **twist):
    return api.done(
        "set_model_state",
        model_state={
            "model_name": model,
            "pose": pose_fields(position, orientation),
            "twist": twist_fields(**twist),
            "reference_frame": frame,
        },
    )


def where(api, model="cube", frame=""):
    return api.done("get_model_state", model_name=model, relative_entity_name=frame)


@pytest.mark.parametrize("frame", ["", "world", "map"])
def test_a_model_is_put_somewhere_with_a_speed(space, frame):
    """It is there, and a second later it is where that speed takes it."""
    place(space, position=(1, 2, 3), orientation=TURNED, frame=frame, linear=(0.5, -0.2, 0.1))
    state = where(space)
    assert vec(state.pose.position) == pytest.approx([1, 2, 3], abs=1e-12)
    assert same_turn(quat(state.pose.orientation), TURNED)
    assert vec(state.twist.linear) == pytest.approx([0.5, -0.2, 0.1], abs=1e-12)
    space.world.run(1.0)
    moved = vec(where(space).pose.position)
    assert moved == pytest.approx([1.5, 1.8, 3.1], abs=1e-9)


def test_a_turning_model_turns_about_the_worlds_axis(space):
    """0.6 rad/s about the world's z, of a body that is turned itself: its heading grows so."""
    place(space, orientation=TURNED, angular=(0, 0, 0.6))
    assert vec(where(space).twist.angular) == pytest.approx([0, 0, 0.6], abs=1e-12)
    space.world.run(STEP)
    x_before = np.array(rotate(TURNED, (1, 0, 0)))
    x_after = np.array(rotate(quat(where(space).pose.orientation), (1, 0, 0)))
    turned = quat_from_rpy(0, 0, 0.6 * STEP)
    # Its inertia differs by axis, which turns the axis by less than w^2 h in a step.
    assert x_after == pytest.approx(np.array(rotate(turned, x_before)), abs=0.36 * STEP**2)


def test_relative_to_a_link_or_model(space):
    """Set and returned in the beacon's frame; in the world, turned by it."""
    beacon = Pose((1.0, 1.0, 1.0), quat_from_rpy(0, 0, 0.5))
    for frame in ("beacon", "beacon::link"):
        place(
            space,
            position=(1, 2, 3),
            orientation=TURNED,
            frame=frame,
            linear=(0.5, 0, 0),
            angular=(0, 0.3, 0),
        )
        there = where(space, frame=frame)
        assert vec(there.pose.position) == pytest.approx([1, 2, 3], abs=1e-9)
        assert same_turn(quat(there.pose.orientation), TURNED)
        assert vec(there.twist.linear) == pytest.approx([0.5, 0, 0], abs=1e-9)
        assert vec(there.twist.angular) == pytest.approx([0, 0.3, 0], abs=1e-9)
        state = where(space)
        assert vec(state.pose.position) == pytest.approx(beacon.apply((1, 2, 3)), abs=1e-9)
        expected = rotate(beacon.orientation, (0.5, 0, 0))
        assert vec(state.twist.linear) == pytest.approx(expected, abs=1e-9)
        assert there.header.frame_id == frame


def test_seen_from_a_moving_frame_speeds_are_differences(space):
    place(space, "beacon", (1, 1, 1), quat_from_rpy(0, 0, 0.5), linear=(0.2, 0, 0))
    place(space, position=(4, 1, 1), linear=(0.5, 0.1, 0))
    seen = where(space, frame="beacon")
    assert vec(seen.twist.linear) == pytest.approx(
        rotate(quat_from_rpy(0, 0, -0.5), (0.3, 0.1, 0)), abs=1e-9
    )


def test_the_stamp_is_the_time(space):
    space.world.run(1.25)
    stamp = where(space).header.stamp
    assert (stamp.sec, stamp.nanosec) == (1, 250_000_000)


def test_an_orientation_of_zeros_is_none(space):
    """What a caller leaves out is zeros: Gazebo takes them so."""
    place(space, position=(1, 2, 3), orientation=(0, 0, 0, 0))
    assert quat(where(space).pose.orientation) == pytest.approx([0, 0, 0, 1])
    place(space, position=(1, 2, 3), orientation=(0, 0, 3, 0))
    assert quat(where(space).pose.orientation) == pytest.approx([0, 0, 1, 0])


# -- links


@pytest.fixture
def chain(make, gazebo):
    return gazebo(make.world(make.sdf(CHAIN), ground=None, gravity=0.0))


def link(api, name, frame=""):
    return api.done("get_link_state", link_name=name, reference_frame=frame).link_state


def configure(api, model, **joints):
    return api.done(
        "set_model_configuration",
        model_name=model,
        joint_names=list(joints),
        joint_positions=list(joints.values()),
    )


def test_configuration(chain):
    """The elbow is at (0.5, 0, 4); at 90 degrees the arm points along y."""
    configure(chain, "chain", elbow=math.pi / 2)
    assert vec(link(chain, "chain::arm").pose.position) == pytest.approx([0.5, 0.5, 4], abs=1e-12)
    assert vec(link(chain, "tip").pose.position) == pytest.approx([0.5, 1.0, 4], abs=1e-12)
    assert vec(link(chain, "body").pose.position) == pytest.approx([0, 0, 4], abs=1e-12)
    properties = chain.done("get_joint_properties", joint_name="elbow")
    assert properties.position == pytest.approx([math.pi / 2])
    assert properties.rate == pytest.approx([0.0])


def test_configuration_ends_at_the_limits_and_says_so(chain):
    answer = configure(chain, "chain", elbow=3.0)
    assert len(notes(answer)) == 1
    assert chain.done("get_joint_properties", joint_name="elbow").position == pytest.approx([2.0])


@pytest.mark.parametrize("running", [True, False])
def test_configuration_of_the_cart(make, gazebo, rosbots, running):
    world = make.world()
    world.session.spawn(rosbots, pose=Pose((0, 0, 0.05)))
    api = gazebo(world)
    if not running:
        api("pause_physics")
    configure(api, "rosbots", wheel_left_joint=12.5)
    assert world.model("rosbots").joint("wheel_left_joint") == pytest.approx(12.5)
    assert world.model("rosbots").joint("wheel_right_joint") == pytest.approx(0.0)


def test_mimicking_joints_go_along(make, gazebo):
    """Fingers of a gripper: b = 0.1 - 2 a, c follows b."""
    links = "".join(
        f"""<link name="{n}"><inertial><mass value="1"/><inertia ixx="1" iyy="1" izz="1"
        ixy="0" ixz="0" iyz="0"/></inertial></link>"""
        for n in "pabc"
    )
    mimics = {
        "a": "",
        "b": '<mimic joint="a" multiplier="-2" offset="0.1"/>',
        "c": '<mimic joint="b"/>',
    }
    joints = "".join(
        f"""<joint name="{n}" type="revolute"><parent link="p"/><child link="{n}"/>
        <axis xyz="0 0 1"/><limit lower="-3" upper="3" effort="1" velocity="1"/>{m}</joint>"""
        for n, m in mimics.items()
    )
    api = gazebo(make.world(ground=None, gravity=0.0))
    api.done(
        "spawn_urdf_model", model_name="g", model_xml=f'<robot name="g">{links}{joints}</robot>'
    )
    configure(api, "g", a=0.3)
    for name, position in (("a", 0.3), ("b", -0.5), ("c", -0.5)):
        found = api.done("get_joint_properties", joint_name=name).position
        assert found == pytest.approx([position]), name
    api.world.run(0.5)
    assert np.abs(api.simulation.data.qvel).max() < 1e-6, "nothing had to be pulled"


@pytest.mark.wording
def test_configuration_refusals(chain):
    call = {"model_name": "chain", "joint_names": ["elbow"], "joint_positions": [0.1]}
    message = chain.refused("set_model_configuration", **call | {"joint_names": ["elbo"]})
    assert 'Did you mean "elbow"?' in message
    message = chain.refused("set_model_configuration", **call | {"model_name": "chian"})
    assert 'Did you mean "chain"?' in message
    message = chain.refused("set_model_configuration", **call | {"joint_positions": []})
    assert "joint names (1) and positions (0) differ" in message
    message = chain.refused("set_model_configuration", **call | {"joint_positions": [math.nan]})
    assert '"elbow" must be a finite number (got nan)' in message


def test_link_state_of_a_turned_arm(chain):
    """With the body turning at w about z, every link moves at w x r, the fixed one too."""
    configure(chain, "chain", elbow=math.pi / 2)
    place(chain, "chain", (0, 0, 4), angular=(0, 0, 0.5))
    for name, arm in (("body", (0, 0)), ("arm", (0.5, 0.5)), ("tip", (0.5, 1.0))):
        twist = link(chain, f"chain::{name}").twist
        assert vec(twist.linear) == pytest.approx([-0.5 * arm[1], 0.5 * arm[0], 0], abs=1e-9), name
        assert vec(twist.angular) == pytest.approx([0, 0, 0.5], abs=1e-9)
    # Seen from the body, the tip stands where it is mounted.
    state = link(chain, "chain::tip", frame="chain::body")
    assert vec(state.pose.position) == pytest.approx([0.5, 1.0, 0], abs=1e-9)
    assert state.reference_frame == "chain::body"
    assert state.link_name == "chain::tip"


@pytest.mark.parametrize("name", ["body", "arm", "tip"])
def test_a_link_is_put_somewhere_and_the_model_comes_with_it(chain, name):
    """Pose and twist of the link are those asked for; the joint keeps its angle and stands."""
    configure(chain, "chain", elbow=1.0)
    mounted = {other: link(chain, other, frame=name).pose for other in ("body", "arm", "tip")}
    chain.done(
        "set_link_state",
        link_state={
            "link_name": f"chain::{name}",
            "pose": pose_fields((7, 8, 9), TURNED),
            "twist": twist_fields((0.1, 0.2, 0.3), (0.3, -0.2, 0.1)),
        },
    )
    state = link(chain, name)
    assert vec(state.pose.position) == pytest.approx([7, 8, 9], abs=1e-9)
    assert same_turn(quat(state.pose.orientation), TURNED)
    assert vec(state.twist.linear) == pytest.approx([0.1, 0.2, 0.3], abs=1e-9)
    assert vec(state.twist.angular) == pytest.approx([0.3, -0.2, 0.1], abs=1e-9)
    properties = chain.done("get_joint_properties", joint_name="elbow")
    assert properties.position == pytest.approx([1.0])
    assert properties.rate == pytest.approx([0.0])
    for other, pose in mounted.items():
        assert vec(link(chain, other, frame=name).pose.position) == pytest.approx(
            vec(pose.position), abs=1e-9
        )


def test_free_parts_of_a_model_stay_together(make, gazebo):
    """Two links that no joint holds are one model all the same."""
    pair = make.sdf(
        """<model name="pair"><link name="a"><inertial/></link>
        <link name="b"><pose>2 0 0 0 0 0</pose><inertial/></link></model>"""
    )
    api = gazebo(make.world(pair, ground=None, gravity=0.0))
    place(api, "pair", (0, 0, 5), quat_from_rpy(0, 0, math.pi / 2), angular=(0, 0, 1.0))
    assert vec(link(api, "pair::a").pose.position) == pytest.approx([0, 0, 5], abs=1e-9)
    state = link(api, "pair::b")
    assert vec(state.pose.position) == pytest.approx([0, 2, 5], abs=1e-9)
    assert vec(state.twist.linear) == pytest.approx([-2.0, 0, 0], abs=1e-9)


def test_a_model_frame_beside_its_canonical_link(make, gazebo):
    """Its link is 1 m ahead of the model's frame: set and returned by the frame."""
    ahead = make.sdf(
        """<model name="ahead"><link name="l"><pose>1 0 0 0 0 0</pose><inertial/></link></model>"""
    )
    api = gazebo(make.world(ahead, ground=None, gravity=0.0))
    place(api, "ahead", (0, 0, 5), quat_from_rpy(0, 0, math.pi / 2), angular=(0, 0, 1.0))
    assert vec(link(api, "ahead::l").pose.position) == pytest.approx([0, 1, 5], abs=1e-9)
    assert vec(link(api, "ahead::l").twist.linear) == pytest.approx([-1, 0, 0], abs=1e-9)
    state = where(api, "ahead")
    assert vec(state.pose.position) == pytest.approx([0, 0, 5], abs=1e-9)
    assert vec(state.twist.linear) == pytest.approx([0, 0, 0], abs=1e-9)


def test_a_driving_cart_is_put_down_standing(make, gazebo, rosbots):
    world = make.world()
    world.session.spawn(rosbots, pose=Pose((0, 0, 0.05)))
    api = gazebo(world)
    world.run(1.0)
    world.publish("/part2_cmr/cmd_vel", linear_x=0.5)
    world.run(3.0)
    world.publish("/part2_cmr/cmd_vel")
    world.run(0.01)
    height = world.model("rosbots").pose.z
    place(api, "rosbots", (5, 5, height))
    twist = where(api, "rosbots").twist
    assert np.abs([*vec(twist.linear), *vec(twist.angular)]).max() == 0.0
    for side in ("left", "right"):
        wheel = api.done("get_joint_properties", joint_name=f"wheel_{side}_joint")
        assert wheel.rate == pytest.approx([0.0])
    world.run(2.0)
    # Its ramp runs out: 1 m/s2 from 0.5 m/s, less the step before.
    assert math.hypot(world.model("rosbots").pose.x - 5, world.model("rosbots").pose.y - 5) < 0.15


def test_a_sleeping_box_that_is_lifted_falls(make, gazebo):
    world = make.world(make.box("cube", (0.5,) * 3, pose=Pose((0, 0, 0.25))))
    api = gazebo(world)
    world.run(5.0)
    assert (api.simulation.data.tree_asleep >= 0).all()
    place(api, position=(0, 0, 2.25))
    world.run(0.5)
    n = 100
    assert world.model("cube").pose.z == pytest.approx(2.25 - 9.8 * STEP**2 * n * (n + 1) / 2)


def test_a_sleeping_box_that_is_given_speed_goes(make, gazebo):
    world = make.world(make.box("cube", (0.5,) * 3, pose=Pose((0, 0, 0.25))))
    api = gazebo(world)
    world.run(5.0)
    there = vec(where(api).pose.position)
    place(api, position=there, linear=(0, 0, 4.9))
    world.run(0.5)
    assert world.model("cube").pose.z == pytest.approx(there[2] + 4.9 * 0.5 - 9.8 * 0.125, abs=0.02)


@pytest.mark.wording
def test_limits_and_fixed_models_are_said(chain, make, gazebo):
    assert "limit of 2" in configure(chain, "chain", elbow=3.0).status_message
    world = make.world(make.box("wall", (1, 1, 1), static=True, pose=Pose((0, 0, 0.5))))
    answer = place(gazebo(world), "wall", (3, 0, 0.5), linear=(1, 0, 0))
    assert "fixed to the world" in answer.status_message


def test_what_is_fixed_in_the_world_is_moved_and_returns(make, gazebo):
    wall = make.box("wall", (1, 1, 1), static=True, pose=Pose((0, 0, 0.5)))
    ball = make.box("ball", (0.2,) * 3, pose=Pose((3, 0, 2.0)))
    world = make.world(wall, ball)
    api = gazebo(world)
    answer = place(api, "wall", (3, 0, 0.5), linear=(1, 0, 0))
    assert len(notes(answer)) == 1
    world.run(2.0)
    assert world.model("ball").pose.z == pytest.approx(1.1, abs=0.01)
    assert vec(where(api, "wall").pose.position) == pytest.approx([3, 0, 0.5])
    api("reset_world")
    assert vec(where(api, "wall").pose.position) == pytest.approx([0, 0, 0.5])


@pytest.mark.wording
def test_refusals(space):
    def state(**more):
        return {"model_state": {"model_name": "cube"} | more}

    message = space.refused("get_model_state", model_name="cbe")
    assert message == 'GetModelState: model "cbe" does not exist. Did you mean "cube"?'
    message = space.refused("get_model_state", model_name="cube", relative_entity_name="beacn")
    assert 'Did you mean "beacon"?' in message
    message = space.refused("get_link_state", link_name="cube::lnk")
    assert 'Did you mean "cube::link"?' in message
    message = space.refused("get_link_state", link_name="link")
    assert "cube::link, beacon::link" in message
    message = space.refused("get_link_state", link_name="cube")
    assert "is a model, not a link" in message
    assert "cube::link" in message
    message = space.refused("set_model_state", **state(pose={"position": {"x": math.nan}}))
    assert "pose.position.x must be a finite number (got nan)" in message
    message = space.refused("set_model_state", **state(pose={"orientation": {"w": math.inf}}))
    assert "pose.orientation.w must be a finite number (got inf)" in message
    message = space.refused("set_model_state", **state(pose={"orientation": {"w": 1e-200}}))
    assert "not a rotation" in message
    message = space.refused("set_model_state", **state(twist={"angular": {"z": -math.inf}}))
    assert "twist.angular.z must be a finite number (got -inf)" in message
    message = space.refused("set_model_state", **state(pose={"position": {"x": 1e300}}))
    assert "must be between -1e+06 and 1e+06" in message
    message = space.refused("set_model_state", **state(reference_frame="nowhere"))
    assert 'reference frame "nowhere" does not exist' in message
    message = space.refused("set_link_state", link_state={"link_name": "cube::lik"})
    assert 'Did you mean "cube::link"?' in message


# -- topics


def test_model_states(make, gazebo, rosbots):
    """Every step, of all models in the order of spawning; the same as the service says."""
    world = make.world(make.box("post", (0.1, 0.1, 1), pose=Pose((3, 0, 0.5))))
    world.session.spawn(rosbots, pose=Pose((0, 0, 0.05)))
    api = gazebo(world)
    world.run(1.0)
    world.publish("/part2_cmr/cmd_vel", linear_x=0.4, angular_z=0.5)
    box = world.mailbox("/gazebo/model_states")
    world.run(2.0)
    reported = box.drain()
    assert len(reported) == 400
    last = reported[-1]
    assert last.name == ["ground_plane", "post", "rosbots"]
    # The last one is of now.
    speed = vec(last.twist[2].linear)
    state = where(api, "rosbots")
    assert vec(last.pose[2].position) == pytest.approx(vec(state.pose.position), abs=1e-12)
    assert np.linalg.norm(speed) == pytest.approx(0.4, rel=0.02)
    assert last.twist[2].angular.z == pytest.approx(0.5, rel=0.03)
    assert vec(last.pose[0].position) == pytest.approx([0, 0, 0])


def test_link_states_are_those_of_the_service(chain):
    configure(chain, "chain", elbow=0.7)
    place(chain, "chain", (1, 2, 3), TURNED, linear=(0.1, 0, 0), angular=(0.4, 0.3, 0.2))
    box = chain.world.mailbox("/gazebo/link_states")
    services = {name: link(chain, f"chain::{name}") for name in ("body", "arm", "tip")}
    chain.world.run(STEP)
    reported, _ = box.drain()
    assert reported.name == [f"chain::{name}" for name in ("body", "arm", "tip")]
    for row, state in enumerate(services.values()):
        assert vec(reported.pose[row].position) == pytest.approx(
            vec(state.pose.position), abs=1e-12
        )
        assert quat(reported.pose[row].orientation) == pytest.approx(quat(state.pose.orientation))
        assert vec(reported.twist[row].linear) == pytest.approx(vec(state.twist.linear), abs=1e-12)
        assert vec(reported.twist[row].angular) == pytest.approx(
            vec(state.twist.angular), abs=1e-12
        )


def test_a_model_that_is_spawned_joins_and_one_that_is_deleted_leaves(make, gazebo):
    world = make.world()
    gazebo(world)
    box = world.mailbox("/gazebo/link_states")
    models = world.mailbox("/gazebo/model_states")
    names = []
    for change in (lambda: world.session.spawn(make.box("b", (1, 1, 1))), lambda: None):
        change()
        world.run(STEP)
        names.append(box.drain()[-1].name)
    world.session.simulation.delete("b")
    world.run(STEP)
    assert names[0] == ["ground_plane::link", "b::link"]
    assert box.drain()[-1].name == ["ground_plane::link"]
    assert models.drain()[-1].name == ["ground_plane"]


def test_a_sleeping_box_stands_still(make, gazebo):
    world = make.world(make.box("cube", (0.5,) * 3, pose=Pose((0, 0, 0.5))))
    gazebo(world)
    world.run(6.0)
    assert (world.session.simulation.data.tree_asleep >= 0).all()
    box = world.mailbox("/gazebo/model_states")
    world.run(STEP)
    twist = box.drain()[-1].twist[1]
    assert np.abs([*vec(twist.linear), *vec(twist.angular)]).max() < 1e-6


def test_without_readers_nothing_is_computed(space, monkeypatch):
    # The schedule has the method itself, so what it computes with is counted.
    computed = []
    forward = Engine.forward

    def counted(engine):
        computed.append(engine.time_ns)
        forward(engine)

    monkeypatch.setattr(Engine, "forward", counted)
    space.world.run(0.1)
    box = space.world.mailbox("/gazebo/model_states")
    space.world.run(2 * STEP)
    assert len(box.drain()) == len(computed) == 2
    box.close()
    space.world.run(0.1)
    assert len(computed) == 2


def test_states_are_set_by_topic(space):
    space.world.publish(
        "/gazebo/set_model_state",
        {"model_name": "cube", "pose": pose_fields((1, 2, 3)), "twist": twist_fields((1, 0, 0))},
    )
    space.world.publish(
        "/gazebo/set_link_state", {"link_name": "beacon::link", "pose": pose_fields((4, 5, 6))}
    )
    space.world.run(1.0)
    assert vec(where(space).pose.position) == pytest.approx([2, 2, 3])
    assert vec(where(space, "beacon").pose.position) == pytest.approx([4, 5, 6])


def test_a_topics_failure_is_reported_once(space):
    for _ in range(5):
        space.world.publish("/gazebo/set_model_state", {"model_name": "cubee"})
        space.world.run(0.01)
    (failed,) = coded(space.world.diagnostics, SERVICE_FAILED)
    assert failed.values["service"] == "/gazebo/set_model_state"
    assert (failed.values["name"], failed.values["meant"]) == ("cubee", "cube")
