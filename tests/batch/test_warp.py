"""Batches on MuJoCo Warp's CPU device, compared with MuJoCo."""

from __future__ import annotations

from importlib.util import find_spec

import numpy as np
import pytest
from tests.batch.warp_models import ARM, BALL
from tests.coded import raises

import cartwheel as cw
from cartwheel.batch import Batch
from cartwheel.codes.world import WARP_DEVICE_UNUSABLE, WARP_UNSUPPORTED

_ABSENT = "MuJoCo Warp is not installed. It has packages for Linux on x86-64 and ARM."
# Imported only when the tests run: each process of a run of all tests imports this file, and the
# package takes a sixth of the time of all imports.
pytestmark = pytest.mark.skipif(find_spec("mujoco_warp") is None, reason=_ABSENT)

ACT = {
    "/part2_cmr/cmd_vel": ["linear.x", "angular.z"],
    "/shoulder": ["data"],
    "/elbow": ["data"],
}
ACTIONS = np.array([[0.4, 0.5, 0.8, -0.5], [0.2, 0.0, -0.5, 0.5]])
CART, ARM_JOINTS, FALL = 1e-5, 1e-3, 1e-4
"""Differences after 1 s: m and rad of the cart, rad of the arm, and m of the ball, which has fallen
by 5 m. About ten times those measured: single precision is 6e-8 of each number and each step."""


@pytest.fixture(scope="module")
def built(tmp_path_factory):
    import warp

    # Compiling takes a third less, and running somewhat more.
    warp.config.optimization_level = 0
    folder = tmp_path_factory.mktemp("models")
    (folder / "arm.urdf").write_text(ARM)
    (folder / "ball.sdf").write_text(BALL)
    return cw.build("empty", ["rosbots.xacro", folder / "arm.urdf", folder / "ball.sdf"])


def places(world):
    """The pose of the cart, the angles of the arm, and the height of the ball."""
    cart, joints = world.model("rosbots").pose, world.model("arm").joints
    return [
        cart.x, cart.y, cart.yaw, joints["shoulder"].position, joints["elbow"].position,
        world.model("ball").pose.z,
    ]  # fmt: skip


def speed(world):
    """The speed of the arm."""
    joints = world.model("arm").joints
    return [joints[name].velocity for name in ("shoulder", "elbow")]


OBS = {
    "places": places,
    "speed": speed,
    "gyro": ("/imu/data", "angular_velocity.z"),
    "odometry": ("/odom", "pose.pose.position.x"),
}


def batch(built, **options):
    given = {"act": ACT, "obs": OBS, "seed": 3, "workers": 0, **options}
    return Batch(built, 2, **given)


@pytest.fixture(scope="module")
def on_warp(built):
    with batch(built, backend="warp", device="cpu") as made:
        yield made


def agree(one, other):
    difference = np.abs(one["places"] - other["places"]).max(axis=0)
    assert (difference[:3] < CART).all(), difference
    assert (difference[3:5] < ARM_JOINTS).all(), difference
    assert difference[5] < FALL, difference
    assert np.abs(one["gyro"] - other["gyro"]).max() < 1e-2
    assert np.abs(one["odometry"] - other["odometry"]).max() < CART


def test_a_fall_a_drive_and_an_arm_agree_with_mujoco(built, on_warp):
    with batch(built) as alone:
        agree(alone.reset(), on_warp.reset())
        for _ in range(10):
            here, there = alone.step(ACTIONS), on_warp.step(ACTIONS)
        agree(here, there)
    assert there["places"][0, 0] > 0.25 and abs(there["places"][0, 3] - 0.8) < 0.01
    # 1.1 s of free fall from 10 m; steps of 5 ms add 0.5 g h t.
    fall = 10.0 - 0.5 * 9.8 * 1.1**2 - 0.5 * 9.8 * 0.005 * 1.1
    assert there["places"][:, 5] == pytest.approx(fall, abs=2e-2)


def test_the_same_actions_give_the_same_bits(on_warp):
    def run(which):
        on_warp.reset(which=which)
        on_warp.step(ACTIONS[which], which=which)
        return on_warp.step(ACTIONS[which], which=which)

    first, again, alone = run([0, 1]), run([0, 1]), run([1])
    for name, values in first.items():
        assert np.array_equal(values, again[name]), name
        assert np.array_equal(values[1:], alone[name]), name


def change(world, random):
    """Changes masses, damping, friction and gravity."""
    arm = world.model("arm")
    arm.link("lower").mass = random.uniform(0.2, 1.0)
    arm.joints["elbow"].damping = random.uniform(0.0, 2.0)
    world.model("rosbots").link("wheel_left_link").friction = random.uniform(0.2, 0.3)
    world.gravity = (0.0, 0.0, -random.uniform(5.0, 15.0))


def test_each_world_has_its_own_parameters(built):
    with (
        batch(built, vary=change) as alone,
        batch(built, vary=change, backend="warp", device="cpu") as other,
    ):
        agree(alone.reset(), other.reset())
        here, there = alone.step(ACTIONS), other.step(ACTIONS)
        agree(here, there)
    # The targets of the arm are equal and opposite.
    for name, index, sign in (("places", 5, -1), ("speed", 1, 1)):
        wrong = np.abs(here[name] - there[name])[:, index].max()
        assert abs(here[name][0, index] + sign * here[name][1, index]) > 20 * wrong


def test_worlds_with_different_orders_of_friction_are_refused(built):
    with batch(built, backend="warp", device="cpu") as made:
        made.reset()
        made.world(1).model("rosbots").link("wheel_left_link").friction = 0.1
        with raises(WARP_UNSUPPORTED):
            made.step(ACTIONS)
        made.world(0).model("rosbots").link("wheel_left_link").friction = 0.15
        assert np.isfinite(made.step(ACTIONS)["places"]).all()


def test_space_for_contacts_grows(on_warp):
    on_warp.reset()
    right = on_warp.step(ACTIONS)
    device = on_warp._here._physics._device
    with device._library.used():
        device._sizes = {"naconmax": 1, "naccdmax": 1, "njmax": 1, "njmax_nnz": 1}
        device._allocate()
    on_warp.reset()
    there = on_warp.step(ACTIONS)
    assert device._sizes["njmax"] > 1 and device._sizes["naconmax"] > 1
    agree(right, there)


def test_other_models_are_refused(built):
    with batch(built, backend="warp", device="cpu") as made:
        made.reset()
        made.world(1).spawn(BALL, name="more", x=2.0)
        with raises(WARP_UNSUPPORTED):
            made.step(ACTIONS)


def test_a_device_that_does_not_exist_is_named(built):
    with raises(WARP_DEVICE_UNUSABLE, device="cuda:99"):
        batch(built, backend="warp", device="cuda:99")


def test_environments(built):
    pytest.importorskip("gymnasium")
    from cartwheel.gym import Task, VectorEnv

    limits = (-1.0, 1.0)
    task = Task(
        built=built,
        act={topic: dict.fromkeys(fields, limits) for topic, fields in ACT.items()},
        obs={"places": places},
        reward=lambda before, actions, after: after["places"][:, 0] - before["places"][:, 0],
        seconds=0.2,
    )
    worlds = VectorEnv(task, 2, backend="warp", device="cpu")
    worlds.reset(seed=1)
    for _ in range(3):
        _, rewards, _, late, _ = worlds.step(ACTIONS)
    assert rewards.shape == (2,) and not late.any()
    worlds.close()
