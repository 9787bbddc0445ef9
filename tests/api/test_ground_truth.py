"""The motion of links and joints, pushes and contacts, against closed forms."""

import hashlib
import math
import pickle
import threading

import numpy as np
import pytest
from tests.api.scenes import PENDULUM
from tests.coded import raises

import cartwheel as cw
from cartwheel.codes.running import UNKNOWN_LINK
from cartwheel.codes.world import (
    FIXED_TO_WORLD,
    NUMBER_OUT_OF_RANGE,
    SIMULATION_CLOSED,
    UNKNOWN_JOINT,
    UNKNOWN_MODEL,
    VALUE_INVALID,
)
from cartwheel.errors import SimulationError, UnknownNameError

G = 9.8
STEP = 0.005


@pytest.fixture
def falling(make):
    """A world with a box 50 m above nothing."""
    return make.world(make.box("box", (0.2, 0.3, 0.4), pose=cw.Pose((0, 0, 50))), ground=None)


@pytest.fixture
def resting(make):
    """A world with a box of 2 kg on the ground."""
    return make.world(make.box("box", (0.2, 0.2, 0.2), pose=cw.Pose((0, 0, 0.1))))


@pytest.fixture
def arm(make):
    return make.world(make.sdf(PENDULUM), ground=None, without=["chain-drag"])


# -- motion


def test_a_falling_body(falling):
    """v = -g t exactly; z = -g t²/2 up to the g h t / 2 of a step h of the integrator."""
    box = falling.model("box")
    link = box.link("link")
    assert link.acceleration.linear == pytest.approx((0, 0, -G), abs=1e-9)
    falling.run(1.0)
    assert box.velocity.linear == pytest.approx((0, 0, -G), abs=1e-9)
    assert link.velocity == box.velocity
    assert link.pose == box.pose
    assert box.pose.z == pytest.approx(50 - G / 2, abs=G * STEP / 2 + 1e-9)
    assert link.acceleration.linear == pytest.approx((0, 0, -G), abs=1e-9)


def test_a_body_at_rest_does_not_accelerate(resting):
    for _ in range(2):
        # After 6 s, it sleeps.
        resting.run(3.0)
        acceleration = resting.model("box").link("link").acceleration
        # A contact that settles exponentially, 3 s after a drop of a few µm.
        assert acceleration.linear == pytest.approx((0, 0, 0), abs=1e-3)
        assert resting.model("box").velocity.linear == pytest.approx((0, 0, 0), abs=1e-6)


def test_a_thrown_body(falling):
    """The range of a throw is v t, and it turns by w t about a principal axis."""
    box = falling.model("box")
    box.velocity = cw.Twist((3.0, 0.0, 0.0), (0.0, 0.0, 2.0))
    assert box.velocity.linear == pytest.approx((3, 0, 0), abs=1e-12)
    assert box.velocity.angular == pytest.approx((0, 0, 2), abs=1e-12)
    falling.run(0.5)
    assert box.pose.x == pytest.approx(1.5, abs=1e-9)
    assert box.pose.yaw == pytest.approx(1.0, abs=1e-9)


def test_a_velocity_is_in_world_axes(falling):
    box = falling.model("box")
    box.pose = cw.Pose.from_xyz_rpy((0, 0, 50), (0.3, -0.4, 1.2))
    box.velocity = cw.Twist((0.1, 0.2, 0.3), (0.4, 0.5, 0.6))
    assert box.velocity.linear == pytest.approx((0.1, 0.2, 0.3), abs=1e-12)
    assert box.velocity.angular == pytest.approx((0.4, 0.5, 0.6), abs=1e-12)
    assert box.pose.rpy == pytest.approx((0.3, -0.4, 1.2), abs=1e-12)


def test_a_body_thrown_while_it_sleeps_wakes(resting):
    resting.run(6.0)
    assert (resting.session.simulation.data.tree_asleep >= 0).any()
    resting.model("box").velocity = cw.Twist((0, 0, G / 2))
    resting.run(0.5)
    # The top of a throw, v²/2g above the start; half a step of g h t / 2 less or more.
    assert resting.model("box").pose.z == pytest.approx(0.1 + G / 8, abs=0.5 * G * STEP / 2 + 1e-3)


def test_links_move_with_their_joints(arm):
    """The end of an arm of 1 m that turns at 2 rad/s moves at 2 m/s, with 4 m/s² inwards."""
    robot = arm.model("pendulum")
    robot.joints.positions = {"hinge": math.pi / 2, "slider": 0.0}
    robot.joints.velocities["hinge"] = 2.0
    finger = robot.link("finger")
    # A turn by 90° about y moves the end from -z to -x.
    assert finger.pose.position == pytest.approx((-1, 0, 2), abs=1e-9)
    assert finger.velocity.linear == pytest.approx((0, 0, 2), abs=1e-9)
    assert finger.velocity.angular == pytest.approx((0, 2, 0), abs=1e-9)
    assert robot.link("arm").velocity.linear == pytest.approx((0, 0, 0), abs=1e-12)
    assert robot.link("base").velocity == cw.Twist()
    assert robot.link("arm").acceleration.linear == pytest.approx((0, 0, 0), abs=1e-9)
    # The pendulum's own equation of motion, with the slider free: only its direction is simple.
    assert robot.link("arm").acceleration.angular[1] < 0


def test_a_pendulum_accelerates_by_its_moment(make):
    """ω' = -m g l / (I + m l²) when it is horizontal."""
    world = make.world(
        make.sdf("""<model name="p"><link name="rod"><inertial><mass>2</mass>
        <pose>0.5 0 0 0 0 0</pose><inertia><ixx>0.1</ixx><iyy>0.1</iyy><izz>0.1</izz></inertia>
        </inertial></link><joint name="hinge" type="continuous"><parent>world</parent>
        <child>rod</child><axis><xyz>0 -1 0</xyz></axis></joint></model>"""),
        ground=None,
    )
    rod = world.model("p").link("rod")
    expected = 2 * G * 0.5 / (0.1 + 2 * 0.25)
    assert rod.acceleration.angular == pytest.approx((0, expected, 0), rel=1e-9)
    assert world.model("p").joints.names == ("hinge",)


def test_a_fixed_model_is_at_rest_and_cannot_be_pushed(make):
    """Until it gets a velocity; see test_moving_models.py."""
    world = make.world(make.box("wall", (1, 1, 1), static=True))
    wall = world.model("wall")
    assert wall.velocity == cw.Twist()
    assert wall.link("link").acceleration == cw.Acceleration()
    with raises(FIXED_TO_WORLD, SimulationError, model="wall", link="link"):
        wall.push((1, 0, 0))
    assert wall.joints.names == ()


# -- joints


def test_joints_by_name_and_as_arrays(arm):
    joints = arm.model("pendulum").joints
    assert joints.names == tuple(joints) == ("hinge", "slider")
    assert len(joints) == 2
    assert "hinge" in joints
    assert "anchor" not in joints
    joints.positions = {"hinge": 0.4}
    assert dict(joints.positions) == {"hinge": 0.4, "slider": 0.0}
    joints.positions["slider"] = 0.05
    np.testing.assert_array_equal(np.asarray(joints.positions), [0.4, 0.05])
    joints.positions = np.array([0.1, -0.05])
    assert joints["hinge"].position == arm.model("pendulum").joint("hinge") == 0.1
    joints.velocities = (0.3, 0.2)
    assert joints.velocities == {"hinge": 0.3, "slider": 0.2}
    joints["slider"].velocity = -0.1
    assert list(joints.velocities.values()) == [0.3, -0.1]
    assert joints["hinge"].limits == (-3, 3)
    joints.positions["hinge"] = 0.2
    assert joints.velocities["hinge"] == 0.0
    assert joints.velocities["slider"] == -0.1


def test_an_effort_holds_an_arm(arm):
    """The effort that balances gravity: the moment of both masses about the hinge."""
    joints = arm.model("pendulum").joints
    joints.positions = {"hinge": 0.5, "slider": 0.0}
    moment = (2 * 0.5 + 0.1 * 1.0) * G * math.sin(0.5)
    joints.efforts = {"hinge": moment, "slider": 0.1 * G * math.cos(0.5)}
    assert joints.efforts["hinge"] == pytest.approx(moment)
    arm.run(1.0)
    # An unstable balance: rounding errors of 1e-16 grow by no more than e^(ω t), with ω < 5/s.
    assert joints.positions["hinge"] == pytest.approx(0.5, abs=1e-12)
    assert joints["hinge"].effort == pytest.approx(moment)
    joints["hinge"].effort = 0.0
    arm.run(0.1)
    assert joints.efforts["hinge"] == 0.0
    assert joints.positions["hinge"] < 0.49


def test_the_effort_of_a_motor_is_measured(make, rosbots):
    world = make.world()
    cart = world.spawn(rosbots)
    cart.publish("/part2_cmr/cmd_vel", linear_x=0.5)
    world.run(0.2)
    assert all(cart.joints.efforts[name] > 0 for name in ("wheel_left_joint", "wheel_right_joint"))


def test_joints_that_follow_others(make):
    world = make.world(
        make.sdf("""<model name="hand"><static>false</static><link name="palm"><inertial>
        <mass>1</mass></inertial></link><joint name="fix" type="fixed"><parent>world</parent>
        <child>palm</child></joint>
        <link name="a"><inertial><mass>1</mass></inertial></link>
        <joint name="one" type="revolute"><parent>palm</parent><child>a</child><axis>
        <xyz>0 0 1</xyz></axis></joint>
        <link name="b"><inertial><mass>1</mass></inertial></link>
        <joint name="two" type="revolute"><parent>palm</parent><child>b</child><axis>
        <xyz>0 0 1</xyz><mimic joint="one"><multiplier>-2</multiplier><offset>0.1</offset>
        </mimic></axis></joint></model>"""),
        ground=None,
    )
    joints = world.model("hand").joints
    assert [joint.type for joint in map(joints.__getitem__, joints.names)] == ["revolute"] * 2
    joints.positions["one"] = 0.2
    assert joints.positions["two"] == pytest.approx(-0.3)
    joints.velocities["one"] = 0.5
    assert joints.velocities["two"] == pytest.approx(-1.0)


# -- pushes


@pytest.mark.parametrize("seconds", [0.0, 0.0175, 0.1])
def test_a_push_is_an_impulse(falling, seconds):
    """F t = m v, even if t is not a multiple of the step; 0 is one step."""
    box = falling.model("box")
    box.push(force=(4.0, 0.0, 2 * G), seconds=seconds)
    falling.run(0.2)
    lasted = seconds or STEP
    assert box.velocity.linear[0] == pytest.approx(4.0 * lasted / 2.0, rel=1e-9)
    assert box.velocity.linear[2] == pytest.approx(-G * (0.2 - lasted), rel=1e-9)
    assert box.velocity.angular == pytest.approx((0, 0, 0), abs=1e-12)


def test_a_push_beside_the_centre_turns_the_body(falling):
    """ω = F r t / I, with I = m (x² + y²) / 12 about z."""
    box = falling.model("box")
    box.push(force=(0, 0.01, 0), at=(0.1, 0, 50), seconds=0.1)
    falling.run(0.1)
    inertia = 2 * (0.2**2 + 0.3**2) / 12
    # It turns by 0.5 ω t meanwhile, which changes the other axes only to second order.
    assert box.velocity.angular[2] == pytest.approx(0.01 * 0.1 * 0.1 / inertia, rel=1e-6)
    assert box.velocity.linear[1] == pytest.approx(0.01 * 0.1 / 2, rel=1e-6)


def test_a_torque(falling):
    box = falling.model("box")
    box.link("link").push(torque=(0, 0, 0.02), seconds=0.1)
    assert box.link("link").acceleration.angular[2] == pytest.approx(
        0.02 / (2 * (0.2**2 + 0.3**2) / 12), rel=1e-9
    )
    falling.run(0.1)
    assert box.velocity.angular[2] == pytest.approx(0.002 / (2 * 0.13 / 12), rel=1e-6)


def test_a_push_without_end_ends_at_a_reset(falling):
    box = falling.model("box")
    box.push((0, 0, 2 * G), seconds=math.inf)
    falling.run(3.0)
    assert box.pose.z == pytest.approx(50, abs=1e-9)
    falling.reset()
    falling.run(1.0)
    assert box.velocity.linear[2] == pytest.approx(-G, rel=1e-9)


def test_a_push_is_ended(falling):
    box = falling.model("box")
    box.push((0, 0, 2 * G), seconds=math.inf)
    falling.run(0.5)
    box.end_pushes()
    falling.run(0.25)
    assert box.velocity.linear[2] == pytest.approx(-G * 0.25, rel=1e-9)
    box.end_pushes()
    box.link("link").push((0, 0, 2 * G), seconds=1.0)
    box.link("link").end_pushes()
    falling.run(0.25)
    assert box.velocity.linear[2] == pytest.approx(-G * 0.5, rel=1e-9)


def test_a_push_by_a_callback_is_a_whole_impulse(make, rosbots):
    """It acts in the step of the callback already, and ends within a longer run."""
    world = make.world(make.box("box", (0.2,) * 3, pose=cw.Pose((5, 5, 50))))
    world.spawn(rosbots)
    box = world.model("box")
    pushed = []

    def push(_):
        if not pushed:
            pushed.append(world.time)
            box.push((4.0, 0, 0), seconds=0.02)

    world.subscribe("/imu/data", push)
    world.run(0.5)
    assert pushed
    assert box.velocity.linear[0] == pytest.approx(4.0 * 0.02 / 2.0, rel=1e-9)


# -- contacts


def test_contacts_carry_the_weight(resting):
    """Four corners, m g upwards in sum, at the height of the ground: also while the box sleeps."""
    for _ in range(2):
        resting.run(3.0)
        contacts = resting.contacts(between=("box", "ground_plane"))
        assert len(contacts) == 4
        total = np.sum([each.force for each in contacts], axis=0)
        # The contact settles exponentially; 3 s are 300 time constants.
        assert total == pytest.approx((0, 0, 2 * G), abs=1e-2)
        for each in contacts:
            assert each.models == ("box", "ground_plane")
            assert each.links == ("link", "link")
            assert each.collisions == ("collision", "collision")
            assert each.normal == pytest.approx((0, 0, 1))
            assert each.point == pytest.approx(
                (math.copysign(0.1, each.point[0]), math.copysign(0.1, each.point[1]), 0), abs=1e-3
            )
            assert 0 < each.depth < 1e-3


def test_the_order_of_two_models(resting):
    resting.run(0.5)
    box, ground = resting.model("box"), resting.model("ground_plane")
    up = resting.contacts(between=(box, ground))
    down = resting.contacts(between=["ground_plane", box.link("link")])
    assert [each.point for each in up] == [each.point for each in down]
    for one, two in zip(up, down, strict=True):
        np.testing.assert_array_equal(np.negative(one.force), two.force)
        np.testing.assert_array_equal(np.negative(one.normal), two.normal)
        assert one.models == two.models[::-1]
    assert resting.contacts("box") == resting.contacts(box) == box.link("link").contacts() == up
    assert box.link("link").contacts("ground_plane") == up
    assert box.link("link").contacts(resting.model("ground_plane")) == up
    assert resting.contacts("box::link") == up
    assert len(resting.contacts()) == 4
    assert resting.contacts(between=("box", "box")) == ()


def test_a_sliding_body_is_held_by_friction(make):
    """Friction is mu times the normal force, against the motion, in every contact."""
    world = make.world(make.box("box", (0.2,) * 3, mu=0.5, pose=cw.Pose((0, 0, 0.1))))
    world.model("box").velocity = cw.Twist((2.0, 0, 0))
    seen = []
    while world.model("box").velocity.linear[0] > 0.5:
        world.run(STEP)
        seen += world.contacts("box")
    assert len(seen) > 10
    for each in seen:
        assert each.force[0] == pytest.approx(-0.5 * each.force[2], rel=1e-6)
        assert each.force[1] == pytest.approx(0, abs=1e-6 * each.force[2])


def test_no_contacts(falling):
    assert falling.contacts() == ()
    assert falling.contacts("box") == ()


# -- what reading costs and changes


def test_reading_changes_nothing(make, rosbots):
    """The bits of a drive into a stack of boxes do not depend on what is read at every step."""

    def drive(*, reads):
        boxes = [
            make.box(f"box{i}", (0.2,) * 3, mass=0.5, pose=cw.Pose((0.6, 0.02 * i, 0.1 + 0.25 * i)))
            for i in range(4)
        ]
        world = make.world(*boxes)
        cart = world.spawn(rosbots)
        world.publish("/part2_cmr/cmd_vel", linear_x=0.4, angular_z=0.1)
        found = hashlib.sha256()
        imu = world.mailbox("/imu/data")
        seen = 0
        for _ in range(400):
            world.run(STEP)
            if reads:
                seen += len(world.contacts())
                for name in cart.links:
                    link = cart.link(name)
                    assert link.pose and link.velocity and link.acceleration
                assert np.asarray(cart.joints.efforts).size == len(cart.joints)
                assert world.model("box0").velocity
            data = world.session.simulation.data
            for each in (data.qpos, data.qvel, data.qacc_warmstart):
                found.update(each.tobytes())
        assert bool(seen) == reads
        for message in imu.drain():
            found.update(np.array([message.linear_acceleration.x]).tobytes())
        return found.hexdigest()

    assert drive(reads=True) == drive(reads=False)


def test_a_state_is_computed_once(resting, monkeypatch):
    import mujoco

    resting.run(0.1)
    counts = []
    forward, kinematics = mujoco.mj_forward, mujoco.mj_kinematics
    monkeypatch.setattr(mujoco, "mj_forward", lambda *a: (counts.append("f"), forward(*a)))
    monkeypatch.setattr(mujoco, "mj_kinematics", lambda *a: (counts.append("k"), kinematics(*a)))
    box = resting.model("box")
    for _ in range(3):
        assert box.pose
        assert box.velocity
    assert counts == ["k"]
    for _ in range(3):
        assert box.pose
        assert resting.contacts()
        assert box.link("link").acceleration
    assert counts == ["k", "f"]
    resting.run(6.0)
    for _ in range(3):
        assert resting.contacts()
    # For the sleeping body, one more.
    assert counts == ["k", "f", "f", "f"]


def test_callbacks_read_the_step_that_called_them(make, rosbots):
    world = make.world()
    cart, read = world.spawn(rosbots), []

    def note(message):
        read.append((message, cart.link("base_footprint").acceleration.linear[2]))
        assert world.contacts("rosbots") or world.time < 0.1

    world.subscribe("/imu/data", note)
    world.run(1.0)
    assert len(read) == 31
    for message, exact in read[5:]:
        # The cart stands still in an upright position, so both frames have the same acceleration.
        assert message.linear_acceleration.z == pytest.approx(exact + G, abs=1e-6)


def test_other_threads_read_while_a_world_runs(resting):
    resting.run(1.0)
    found = []

    def read():
        for _ in range(20):
            found.append(len(resting.contacts("box")))
            found.append(round(resting.model("box").velocity.linear[2]))

    thread = threading.Thread(target=read)
    thread.start()
    while thread.is_alive():
        resting.spin(0.05, speed=None)
    thread.join(60)
    assert found == [4, 0] * 20


# -- mistakes


def test_unknown_names(arm):
    robot = arm.model("pendulum")
    with raises(UNKNOWN_LINK, UnknownNameError, name="wheel"):
        robot.link("wheel")
    with raises(UNKNOWN_LINK, name="fingr", meant="finger"):
        robot.link("fingr")
    with raises(UNKNOWN_JOINT, name="slidr", meant="slider"):
        robot.joints["slidr"]
    with raises(UNKNOWN_JOINT, name="slidr"):
        robot.joints.positions = {"slidr": 1.0}
    with raises(UNKNOWN_JOINT, name="anchor"):
        robot.joints.efforts["anchor"] = 1.0
    with raises(UNKNOWN_MODEL, name="pendulm", meant="pendulum"):
        arm.contacts("pendulm")
    with raises(UNKNOWN_LINK, name="am"):
        arm.contacts("pendulum::am")
    with pytest.raises(TypeError):
        arm.contacts(["pendulum"] * 3)
    with pytest.raises(TypeError):
        del robot.joints.positions["hinge"]


@pytest.mark.parametrize("value", [math.nan, math.inf, "x", None, (1.0,)])
def test_values_that_are_no_numbers(arm, value):
    joints = arm.model("pendulum").joints
    for name in ("positions", "velocities", "efforts"):
        with raises(VALUE_INVALID):
            getattr(joints, name)["hinge"] = value
        with raises(VALUE_INVALID):
            setattr(joints, name, [value, value])
    assert np.asarray(joints.positions).tolist() == [0, 0]


def test_values_of_the_wrong_size(arm, falling):
    with raises(VALUE_INVALID):
        arm.model("pendulum").joints.positions = [0.0]
    box = falling.model("box")
    for force in ((1.0, 2.0), (1, 2, math.nan), 3.0, "abc"):
        with raises(VALUE_INVALID):
            box.push(force)
        with raises(VALUE_INVALID):
            box.velocity = cw.Twist(force)
    for seconds in (-1.0, math.nan, -math.inf):
        with raises(NUMBER_OUT_OF_RANGE):
            box.push((1, 0, 0), seconds=seconds)
    with raises(NUMBER_OUT_OF_RANGE):
        box.push((1e12, 0, 0))
    falling.run(0.1)
    assert box.velocity.linear[:2] == (0, 0)


def test_a_deleted_model_and_a_closed_world(falling):
    box = falling.model("box")
    link, joints = box.link("link"), box.joints
    box.delete()
    for read in (
        lambda: box.pose,
        lambda: box.velocity,
        lambda: box.mass,
        lambda: box.links,
        lambda: link.pose,
        lambda: link.acceleration,
        lambda: joints.names,
        lambda: link.push((1, 0, 0)),
        lambda: box.push((1, 0, 0)),
    ):
        with raises(UNKNOWN_MODEL, name="box", deleted=True):
            read()
    with raises(UNKNOWN_MODEL, name="bax") as caught:
        falling.model("bax")
    assert "deleted" not in caught.value.values
    falling.close()
    with raises(SIMULATION_CLOSED):
        link.push((1, 0, 0))


def test_results_of_a_closed_world_can_be_read(resting):
    resting.run(1.0)
    box = resting.model("box")
    before = box.pose, box.velocity, resting.contacts()
    resting.close()
    assert (box.pose, box.velocity, resting.contacts()) == before
    with raises(SIMULATION_CLOSED):
        box.velocity = cw.Twist()
    with raises(SIMULATION_CLOSED):
        box.pose = cw.Pose()


def test_handles_stay_valid_when_models_are_spawned(make, falling):
    link = falling.model("box").link("link")
    first = link.pose
    for index in range(3):
        falling.spawn(make.box("more", (0.1,) * 3), name=f"more{index}", x=float(index))
    assert link.pose == first
    assert falling.model("box").links == ("link",)
    assert falling.model("box").mass == 2.0


def test_values_pickle(resting):
    resting.run(0.5)
    values = (resting.contacts(), resting.model("box").velocity)
    assert pickle.loads(pickle.dumps(values)) == values
