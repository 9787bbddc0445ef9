"""Poses as observations: the same numbers as those of `Model.pose`."""

from __future__ import annotations

import math

import numpy as np
import pytest
from tests.batch import duties
from tests.coded import raises

import cartwheel as cw
from cartwheel.batch import Batch, PoseOf
from cartwheel.codes.world import BATCH_INVALID, UNKNOWN_MODEL

BALL = """<sdf version="1.9"><model name="ball"><pose>0 0 1 0.2 0.3 0.4</pose>
  <link name="ball"><pose>0.1 0.2 0 0.3 0 0.5</pose>
    <inertial><mass>1</mass></inertial>
    <collision name="c"><geometry><box><size>0.2 0.3 0.4</size></box></geometry></collision>
  </link></model></sdf>"""
POST = """<sdf version="1.9"><model name="post"><static>true</static>
  <pose>2 1 0.5 0 0 1</pose><link name="post"><pose>0 0 0.1 0 0 0.2</pose></link></model></sdf>"""


def numbers(pose):
    """All fields of a pose."""
    x, y, z, w = pose.orientation
    return [*pose.position, *pose.rpy[:2], pose.yaw, x, y, z, w]


ALL = ("x", "y", "z", "roll", "pitch", "yaw", "qx", "qy", "qz", "qw")


@pytest.fixture(scope="module")
def built(tmp_path_factory):
    folder = tmp_path_factory.mktemp("models")
    for name, text in (("ball", BALL), ("post", POST)):
        (folder / f"{name}.sdf").write_text(text, encoding="utf-8")
    return cw.build("empty", ["rosbots.xacro", folder / "ball.sdf", folder / "post.sdf"])


@pytest.mark.parametrize("workers", [0, 1])
def test_it_is_the_pose_that_a_function_reads(built, workers):
    obs = {"own": PoseOf("rosbots"), "read": duties.pose}
    with Batch(built, 3, act=duties.ACT, obs=obs, workers=workers) as made:
        made.reset()
        for speed in (0.5, -0.2, 1.0):
            values = made.step(np.array([[speed, turn] for turn in (0.0, 1.0, -1.0)]))
            assert values["own"].dtype == float
            assert np.array_equal(values["own"], values["read"])
    assert len({*values["own"][:, 2].tolist()}) == 3


@pytest.mark.parametrize("model", ["ball", "post"])
def test_all_fields_have_the_bits_of_the_computed_pose(built, model):
    """A tumbling box whose link has a pose in its model, and one that stands."""
    with built.world() as world:
        simulation = world.session.simulation
        read = PoseOf(model, *ALL).reader(world)
        for _ in range(20):
            world.run(0.1)
            found = read()
            simulation.engine.locate()
            assert found == numbers(simulation.pose(model))
            assert found == numbers(world.model(model).pose)
    assert len(found) == len(ALL)


def test_a_pose_is_current_after_each_change(built):
    with built.world() as world:
        read = PoseOf("ball", "x", "z").reader(world)
        world.model("ball").pose = cw.Pose((3.0, 0.0, 2.0))
        assert read() == pytest.approx([3.0, 2.0])
        world.spawn("rosbots.xacro", name="other", x=5.0)
        assert read() == pytest.approx([3.0, 2.0])
        world.run(0.2)
        assert read()[1] == pytest.approx(2.0 - 0.2**2 / 2 * 9.8, abs=0.03)
        state = world.save()
        world.run(0.1)
        world.restore(state)
        assert read()[1] == pytest.approx(2.0 - 0.2**2 / 2 * 9.8, abs=0.03)


def test_a_quaternion_of_another_length_becomes_a_unit_quaternion(built):
    with built.world() as world:
        engine = world.session.simulation.engine
        joint = engine.free_joint("ball", "ball")
        first = int(engine.model.jnt_qposadr[joint])
        for factor in (0.5, 1.0 + 1e-9, 1.0 + 1e-15, 3.0):
            engine.data.qpos[first + 3 : first + 7] *= factor
            found = PoseOf("ball", *ALL).reader(world)()
            engine.locate()
            assert found == numbers(world.session.simulation.pose("ball"))
            assert math.hypot(*found[-4:]) == pytest.approx(1.0, abs=1e-14)


def test_a_field_that_does_not_exist_is_an_error():
    with raises(BATCH_INVALID, argument="obs", field="yaww", suggestion="yaw"):
        PoseOf("rosbots", "x", "yaww")


@pytest.mark.parametrize("workers", [0, 1])
def test_a_model_that_does_not_exist_is_an_error(built, workers):
    def observe():
        with Batch(
            built, 2, act=duties.ACT, obs={"pose": PoseOf("rosbot")}, workers=workers
        ) as made:
            made.reset()

    with raises(UNKNOWN_MODEL):
        observe()
