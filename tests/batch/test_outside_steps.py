"""Steps that another engine computes: with the same steps, all states and messages are the same.

The engine is a stand-in for MuJoCo Warp's device that computes with MuJoCo itself.
"""

from __future__ import annotations

import builtins

import mujoco
import numpy as np
import pytest
from tests.batch import duties
from tests.batch.standin import without_warp  # noqa: F401 - a fixture
from tests.batch.test_batch import ACTIONS, batch, journey
from tests.coded import raises
from tests.dialects.gz.test_tracks import vehicle
from tests.golden.adapter import World, controller_files, load_robot
from tests.golden.commanding import PERIOD, Commands
from tests.golden.subjects import ROBOTS
from tests.golden.trial import Ears, resting_height, state
from tests.world import test_mimics as mimics

import cartwheel as cw
from cartwheel.batch import abreast
from cartwheel.batch.abreast import run_abreast
from cartwheel.batch.warp import WarpPhysics
from cartwheel.codes.world import BATCH_INVALID, WARP_MISSING, WARP_UNSUPPORTED
from cartwheel.simulation.outside_steps import keep_awake
from cartwheel.simulation.simulation import Simulation

ROOM = ROBOTS.parent / "robots"
# What they read before a step: link poses (lift and drag, multicopter), efforts (controllers),
# positions only (drive, trajectories); contacts and loads are read after it.
DRIVEN = [
    "gz-sim-lift-drag-system.urdf",
    "gz-sim-multicopter-motor-model-system.urdf",
    "libgazebo_ros2_control.urdf",
    "gz-sim-joint-position-controller-system.urdf",
    "gz-sim-joint-trajectory-controller-system.urdf",
    "gz-sim-mecanum-drive-system.urdf",
    "libgazebo_ros_bumper.urdf",
    "force_torque-sensor.urdf",
]


@pytest.fixture(scope="module")
def built():
    return cw.build("empty", ["rosbots.xacro"])


def world_of(name):
    made = World("empty", lenient=True)
    robot = load_robot(ROOM / name)
    made.spawn(robot, name=robot.name, z=resting_height(robot), controllers=controller_files(robot))
    return made


def lived(name, *, outside):
    """All messages and the last state of 0.8 s with commands."""
    with world_of(name) as world:
        physics = WarpPhysics([world.session.simulation], "cpu") if outside else None
        keep_awake(world.session.simulation.engine)
        ears, commands = Ears(world), Commands(world)
        for step in range(16):
            ears.listen()
            commands.give(step * PERIOD)
            run_abreast([world], PERIOD, physics)
        return ears.heard(), state(world)


@pytest.mark.parametrize("name", DRIVEN)
def test_all_messages_have_the_same_bits(without_warp, name):  # noqa: F811
    assert lived(name, outside=True) == lived(name, outside=False)


def test_what_reads_poses_needs_those_of_the_last_step(without_warp, monkeypatch):  # noqa: F811
    name = "libgazebo_ros2_control.urdf"
    right = lived(name, outside=False)
    monkeypatch.setattr(Simulation, "looks_back", lambda self, count: False)
    monkeypatch.setattr(abreast.Run, "ends", False)
    assert lived(name, outside=True) != right


def awake(world, random):
    """Changes a mass, and lets nothing sleep."""
    duties.heavier(world, random)
    keep_awake(world.session.simulation.engine)


def test_worlds_at_different_times_and_with_their_own_masses(built, without_warp):  # noqa: F811
    with batch(built, vary=awake) as one, batch(built, vary=awake, backend="warp") as other:
        for here, there in zip(journey(one), journey(other), strict=True):
            for name, values in here.items():
                assert np.array_equal(there[name], values), name


def test_few_steps_are_computed_for_many_worlds(built, without_warp):  # noqa: F811
    with batch(built, backend="warp", obs={"pose": duties.pose}) as made:
        made.reset()
        device = made._here._physics._device
        before = device.steps, device.parameters.checks
        made.step(ACTIONS[0])
        # 0.1 s of 5 ms for all worlds together, whose models have not changed
        assert (device.steps - before[0], device.parameters.checks - before[1]) == (20, 0)


def test_an_error_in_one_world_leaves_the_others_complete(built, without_warp):  # noqa: F811
    with batch(built, n=3, backend="warp") as made:
        made.reset()
        data = made.world(1).session.simulation.data
        data.qvel[:] = np.nan
        with pytest.raises(cw.CartwheelError):
            made.step(ACTIONS[0][:3])
        assert [made.world(index).time for index in (0, 2)] == [0.2, 0.2]
        assert np.isfinite(made.step(ACTIONS[0][:2], which=[0, 2])["pose"]).all()
        inputs = made._here._physics._device.inputs
        assert np.isfinite(inputs["qvel"]).all() and np.isfinite(inputs["qpos"]).all()


BALL = """<sdf version="1.7"><model name="ball"><link name="link"><collision name="c"><geometry>
<sphere><radius>0.1</radius></sphere></geometry><surface>{}</surface></collision></link></model></sdf>
"""
BOUNCES = (
    "<bounce><restitution_coefficient>0.5</restitution_coefficient><threshold>0.01</threshold>"
    "</bounce>"
)
SLIDES = "<friction><ode><mu>0.9</mu><mu2>0.1</mu2><fdir1>1 0 0</fdir1></ode></friction>"
STATIC = BALL.format("").replace("<link", "<static>1</static><link", 1)


@pytest.mark.parametrize(
    ("text", "feature"),
    [
        (BALL.format(BOUNCES), "restitution"),
        (BALL.format(SLIDES), "friction that depends on the direction"),
        (STATIC, "a world in which nothing can move"),
    ],
)
def test_physics_of_cartwheel_is_refused(tmp_path, without_warp, text, feature):  # noqa: F811
    (tmp_path / "ball.sdf").write_text(text)
    file = tmp_path / "ball.sdf"
    built = cw.build(
        "empty", [{"robot": file, "name": name, "x": x} for name, x in (("a", 0), ("b", 1))]
    )
    with raises(WARP_UNSUPPORTED, feature=feature):
        batch(built, n=1, act={}, obs={"time": lambda world: world.time}, backend="warp")


def test_followers_that_leave_their_limits_are_refused(without_warp):  # noqa: F811
    with (
        mimics.world(mimics.follower('lower="0" upper="1"', 'multiplier="-1"')) as world,
        raises(WARP_UNSUPPORTED, feature="joints that follow others beyond their own limits"),
    ):
        WarpPhysics([world.session.simulation], "cpu")


@pytest.mark.parametrize(
    ("name", "feature"),
    [
        ("gz-sim-detachable-joint-system.urdf", "that plugins attach to others"),
        ("libgazebo_ros_wheel_slip.urdf", "with slip"),
    ],
)
def test_plugins_that_change_the_model_are_refused(without_warp, name, feature):  # noqa: F811
    with world_of(name) as world, pytest.raises(cw.CartwheelError) as caught:
        WarpPhysics([world.session.simulation], "cpu")
    assert caught.value.code is WARP_UNSUPPORTED
    assert feature in caught.value.values["feature"]


def test_tracks_are_refused(tmp_path, without_warp):  # noqa: F811
    (tmp_path / "crawler.sdf").write_text(vehicle())
    built = cw.build("empty", [tmp_path / "crawler.sdf"])
    with raises(WARP_UNSUPPORTED, feature="moving surfaces, such as tracks"):
        batch(built, n=1, act={}, obs={"time": lambda world: world.time}, backend="warp")


def test_callbacks_of_mujoco_are_refused(built, without_warp):  # noqa: F811
    mujoco.set_mjcb_passive(lambda model, data: None)
    try:
        with raises(WARP_UNSUPPORTED, feature="the MuJoCo callback mjcb_passive"):
            batch(built, n=1, backend="warp")
    finally:
        mujoco.set_mjcb_passive(None)


def test_worlds_with_a_pace_are_refused(built, without_warp):  # noqa: F811
    with batch(built, n=2, backend="warp") as made:
        made.world(1).pace = 1.0
        with raises(WARP_UNSUPPORTED, feature="worlds with connections or a pace"):
            made.reset()


def test_the_package_is_required(built, monkeypatch):
    found = builtins.__import__

    def absent(name, *rest):
        if name in ("warp", "mujoco_warp"):
            raise ImportError(f"No module named '{name}'")
        return found(name, *rest)

    monkeypatch.setattr(builtins, "__import__", absent)
    for workers in (None, 0):
        with raises(WARP_MISSING):
            batch(built, n=1, backend="warp", workers=workers)


@pytest.mark.parametrize(
    "options", [{"backend": "cuda"}, {"backend": "warp", "workers": 2, "start_method": "fork"}]
)
def test_wrong_arguments_are_errors(built, options):
    with raises(BATCH_INVALID):
        batch(built, **options)
