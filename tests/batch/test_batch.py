"""Worlds of a batch: each is the world that its seed makes alone."""

from __future__ import annotations

import os
import signal
import subprocess
import sys

import numpy as np
import pytest
from tests.batch import duties
from tests.coded import raises
from tests.dialects.ros_control.arms import beam, robot, ros2_joint, ros2_plugin, ros2_system

import cartwheel as cw
from cartwheel import arrays
from cartwheel.batch import Batch
from cartwheel.codes.graph import FIELD_UNKNOWN, FIELD_VALUE_INVALID, NO_MESSAGE, TOPIC_UNKNOWN
from cartwheel.codes.world import (
    BATCH_CLOSED,
    BATCH_INVALID,
    BATCH_PROCESS_ENDED,
)
from cartwheel.messages.making import expanded, maker

N = 5
ACTIONS = np.random.default_rng(0).uniform(-1.0, 1.0, (8, N, 2))
SOME = np.array([4, 1])


@pytest.fixture(scope="module")
def built():
    return cw.build("empty", ["rosbots.xacro"])


def batch(built, n=N, **options):
    given = {"act": duties.ACT, "obs": duties.OBS, "seed": 3, "workers": 0, **options}
    return Batch(built, n, **given)


def journey(made):
    """All observations of a journey with a reset of two worlds in the middle."""
    seen = [made.reset()]
    for index, actions in enumerate(ACTIONS):
        seen.append(made.step(actions))
        if index == 3:
            seen.append(made.reset(which=SOME, seeds=[70, 71]))
            seen.append(made.step(actions[:2], which=SOME))
    return seen


def alone(built, index):
    """The same journey of one world, without a batch."""
    with built.world(seed=3 + index) as world:
        imu, odometry = world.topic("/imu/data"), world.topic("/odom")

        def read():
            latest = imu.latest
            return {
                "/imu/data": [latest.angular_velocity.z, latest.linear_acceleration.x],
                "speed": odometry.latest.twist.twist.linear.x,
                "covariance": arrays.values([odometry.latest], "pose.covariance")[0],
                "pose": duties.pose(world),
            }

        def step(action):
            world.publish("/part2_cmr/cmd_vel", linear_x=action[0], angular_z=action[1])
            world.run(0.1)
            return read()

        world.reset()
        world.run(0.1)
        seen = [read()]
        for number, actions in enumerate(ACTIONS):
            seen.append(step(actions[index]))
            if number == 3 and index in SOME:
                row = SOME.tolist().index(index)
                world.reset(seed=70 + row)
                world.run(0.1)
                seen.append(read())
                seen.append(step(actions[row]))
        return seen


@pytest.mark.parametrize("workers", [0, 1, 2])
def test_each_world_is_that_of_its_seed(built, workers):
    with batch(built, workers=workers, vary=None) as made:
        seen = journey(made)
    assert {name: each.shape for name, each in seen[0].items()} == {
        "/imu/data": (N, 2), "speed": (N,), "covariance": (N, 36), "pose": (N, 3),
    }  # fmt: skip
    for index in range(N):
        rows = [
            {name: each[index if len(each) == N else SOME.tolist().index(index)] for name, each in
             moment.items()}
            for moment in seen
            if len(moment["speed"]) == N or index in SOME
        ]  # fmt: skip
        for row, expected in zip(rows, alone(built, index), strict=True):
            for name, value in expected.items():
                assert np.array_equal(row[name], value), (index, name)


GYRO = """<sdf version="1.7"><model name="gyro"><static>true</static><link name="link">
<sensor name="imu" type="imu"><update_rate>100</update_rate><imu><angular_velocity><z>
<noise type="gaussian"><mean>0</mean><stddev>0.1</stddev></noise></z></angular_velocity></imu>
<plugin name="gyro" filename="libgazebo_ros_imu_sensor.so"/></sensor></link></model></sdf>"""


def test_noise_differs_between_worlds(tmp_path):
    (tmp_path / "gyro.sdf").write_text(GYRO)
    noisy = cw.build("empty", [tmp_path / "gyro.sdf"])
    topic = "/imu_data"
    with batch(noisy, act={}, obs={topic: "angular_velocity.z"}) as made:
        first = made.reset()[topic]
        assert len(set(first.tolist())) == N
        assert made.seeds == tuple(range(3, 3 + N))
        assert not set(made.reset()[topic].tolist()) & set(first.tolist())
        other = made.reset(seed=4)[topic]
        assert np.array_equal(other[:-1], first[1:]) and other[-1] not in first
        assert made.step(np.zeros((N, 0)))[topic].shape == (N,)


@pytest.mark.parametrize("workers", [0, 1])
def test_a_reset_without_a_seed_goes_on_to_the_next_one(built, workers):
    """Each world has its own sequence, whatever the others do and how many there are."""

    def reset(made, **options):
        found = made.reset(**options)["pose"][:, 0]
        return made.seeds, found.tolist()

    with batch(built, workers=workers, vary=duties.placed) as made:
        (first, one), (second, two), (third, _) = (reset(made) for _ in range(3))
        assert first == tuple(range(3, 3 + N))
        assert len({*first, *second, *third}) == 3 * N and one != two
        assert reset(made, seed=3) == (first, one) and reset(made) == (second, two)
        reset(made, seed=3)
        partly, few = reset(made, which=[1])
        assert partly == (first[0], second[1], *first[2:]) and few == [two[1]]
        assert reset(made, seeds=second) == (second, two)
    with batch(built, 2, seed=4, vary=duties.placed) as made:
        assert [reset(made)[0], reset(made)[0]] == [first[1:3], second[1:3]]


DEPTH = """<sdf version="1.9"><model name="eye"><static>1</static><pose>0 5 0.3 0 0 1.5708</pose>
<link name="link"><sensor name="depth" type="depth_camera"><topic>/depth</topic>
<update_rate>10</update_rate><camera><image><width>32</width><height>24</height></image><clip>
<near>0.1</near><far>5</far></clip></camera></sensor></link>
<link name="wall"><pose>2 0 0.5 0 0 0</pose><collision name="c"><geometry><box>
<size>0.2 10 3</size></box></geometry></collision><visual name="v"><geometry><box>
<size>0.2 10 3</size></box></geometry></visual></link></model></sdf>"""


@pytest.mark.parametrize("workers", [0, 1])
def test_images_are_pictures(tmp_path, workers):
    (tmp_path / "eye.sdf").write_text(DEPTH)
    robots = ["rosbots.xacro", tmp_path / "eye.sdf"]
    seeing = cw.build("post", robots)
    with seeing.world(seed=4) as world:
        images = world.topic("/rosbots/camera1/image_raw")
        images.latest  # noqa: B018 - it subscribes
        world.run(0.1)
        expected = cw.image(images.latest)
    obs = {"/rosbots/camera1/image_raw": "data", "depth": ("/depth", "data")}
    with batch(seeing, 2, obs=obs, workers=workers) as made:
        values = made.reset()
    pictures, depths = values["/rosbots/camera1/image_raw"], values["depth"]
    assert pictures.shape == (2, *expected.shape) and pictures.dtype == np.uint8
    assert np.array_equal(pictures[1], expected) and expected.std() > 5
    assert depths.shape == (2, 24, 32) and depths.dtype == float
    assert depths[:, 12, 16] == pytest.approx(1.9, abs=0.01)


@pytest.mark.parametrize("workers", [0, 2])
def test_variations_depend_on_the_seed_of_the_world(built, workers):
    with batch(built, obs={"pose": duties.pose}, vary=duties.heavier, workers=workers) as made:
        made.reset()
        first = made.step(ACTIONS[0])["pose"]
        assert len(set(first[:, 2].tolist())) == N
        made.reset(which=[1], seeds=[3])
        assert np.array_equal(made.step(ACTIONS[0][:1], which=[1])["pose"][0], first[0])


def test_the_names_of_actions_are_in_order(built):
    with batch(built, 1) as made:
        assert made.action_names == (
            "/part2_cmr/cmd_vel linear.x", "/part2_cmr/cmd_vel angular.z",
        )  # fmt: skip
        assert made.world(0).models == ("ground_plane", "rosbots")


@pytest.mark.parametrize(
    ("options", "code"),
    [
        ({"n": 0}, BATCH_INVALID),
        ({"workers": -1}, BATCH_INVALID),
        ({"obs": {}}, BATCH_INVALID),
        ({"obs": {"/odom": 3}}, BATCH_INVALID),
        ({"obs": {"words": duties.words}}, BATCH_INVALID),
        ({"act": {"/part2_cmr/cmd_vel": "linear.x"}}, BATCH_INVALID),
        ({"act": {"/cmd_val": ["linear.x"]}}, TOPIC_UNKNOWN),
        ({"act": {"/part2_cmr/cmd_vel": ["linear.w"]}}, FIELD_UNKNOWN),
        ({"obs": {"/nothing": "x"}}, TOPIC_UNKNOWN),
        ({"obs": {"/part2_cmr/cmd_vel": "linear.x"}}, NO_MESSAGE),
        ({"obs": {"/odom": "pose.pose.position.w"}}, FIELD_UNKNOWN),
        ({"period": -1.0}, BATCH_INVALID),
        ({"period": 0.0}, BATCH_INVALID),
        ({"period": float("nan")}, BATCH_INVALID),
        ({"seed": "one"}, BATCH_INVALID),
        ({"seed": -1}, BATCH_INVALID),
        ({"vary": 3}, BATCH_INVALID),
    ],
)
@pytest.mark.parametrize("workers", [0, 1])
def test_mistakes_are_errors(built, options, code, workers):
    given = {"workers": workers, "n": 2, **options}
    with raises(code), batch(built, **given) as made:
        made.reset()
        made.step(np.zeros((2, len(made.action_names))))


def test_a_field_that_does_not_exist_is_an_error_at_once(built):
    for field in ("pose.pose.position.w", ["twist.twist.linear.x", "speed"], "pose.covariance[x]"):
        with raises(FIELD_UNKNOWN):
            batch(built, obs={"/odom": field})


def test_a_world_is_not_what_a_batch_is_made_of():
    with cw.World() as world, raises(BATCH_INVALID, argument="built"):
        Batch(world, 2, act={}, obs={"time": duties.words})


@pytest.mark.parametrize(
    "actions", [np.zeros((N, 1)), np.zeros(2), np.full((N, 2), np.nan), np.zeros((N - 1, 2))]
)
def test_actions_of_a_wrong_shape_are_errors(built, actions):
    with batch(built) as made:
        made.reset()
        with raises(BATCH_INVALID):
            made.step(actions)
        made.step(ACTIONS[0])


@pytest.mark.parametrize("which", [[], [0, 0], [N], [-1], np.zeros(N, bool)])
def test_wrong_worlds_are_errors(built, which):
    with batch(built) as made, raises(BATCH_INVALID):
        made.reset(which=which)


@pytest.mark.parametrize("workers", [0, 2])
def test_observations_of_different_sizes_are_errors(built, workers):
    with batch(built, obs={"many": duties.as_many_as_time}, workers=workers) as made:
        made.reset()
        actions = np.zeros((N, 2))
        actions[-1] = 1.0
        with raises(BATCH_INVALID):
            for _ in range(10):
                made.step(actions)


def test_a_process_that_ends_is_an_error(built):
    with batch(built, obs={"x": duties.dying}, workers=2) as made:
        made.reset()
        with raises(BATCH_PROCESS_ENDED):
            for _ in range(10):
                made.step(np.ones((N, 2)))


def test_a_script_without_a_guard_is_told_what_to_write(tmp_path):
    script = tmp_path / "script.py"
    script.write_text(
        "import cartwheel as cw\n"
        "from cartwheel.batch import Batch\n"
        'built = cw.build("empty", ["rosbots"])\n'
        'act = {"/part2_cmr/cmd_vel": ["linear.x"]}\n'
        'batch = Batch(built, 2, act=act, obs={"/imu/data": "orientation.w"}, workers=1)\n'
        "batch.reset()\n"
    )
    ended = subprocess.run(
        [sys.executable, script], cwd=tmp_path, capture_output=True, text=True, check=False
    )
    assert ended.returncode == 1
    assert 'below `if __name__ == "__main__":`' in ended.stderr.splitlines()[-1]


def test_processes_end_with_the_batch(built):
    made = batch(built, workers=2)
    made.reset()
    processes = [each._process for each in made._processes]
    os.kill(processes[0].pid, signal.SIGINT)  # Ctrl-C is for the parent process
    made.step(ACTIONS[0])
    made.close()
    assert [each.exitcode for each in processes] == [0, 0]
    with raises(BATCH_CLOSED):
        made.step(ACTIONS[0])
    with raises(BATCH_INVALID), batch(built, workers=1) as other:
        other.world(0)


def test_an_interrupted_step_leaves_no_answer_for_the_next(built, monkeypatch):
    with batch(built, workers=0) as made:
        expected = [made.reset(), made.step(ACTIONS[0]), made.step(ACTIONS[1])]
    with batch(built, workers=1) as made:
        made.reset()

        def interrupted() -> None:
            raise KeyboardInterrupt

        process = made._processes[0]
        with monkeypatch.context() as patched, pytest.raises(KeyboardInterrupt):
            patched.setattr(process, "answer", interrupted)
            made.step(ACTIONS[0])
        found = made.step(ACTIONS[1])
        for name, value in expected[2].items():
            assert np.array_equal(found[name], value), name


def test_a_function_acts_as_fields_do(built):
    applied = {"drive": (duties.drive, 2)}
    with batch(built, 2) as one, batch(built, 2, act=applied) as other:
        assert other.action_names == ("drive 0", "drive 1")
        one.reset()
        other.reset()
        for actions in ACTIONS[:3, :2]:
            expected, found = one.step(actions), other.step(actions)
            assert all(np.array_equal(expected[name], found[name]) for name in expected)


ARM = robot(
    beam("beam", "world") + beam("tip", "world")
    + ros2_system(ros2_joint("beam_joint", "position"), ros2_joint("tip_joint", "position")),
    ros2_plugin(),
)  # fmt: skip
GROUP = """
controller_manager:
  ros__parameters:
    arm: {type: position_controllers/JointGroupPositionController}
arm:
  ros__parameters: {joints: [beam_joint, tip_joint]}
"""


def test_parts_of_arrays_are_observations(built):
    obs = {
        "diagonal": ("/odom", "pose.covariance[::7]"),
        "/odom": ["pose.covariance[:2]", "pose.pose.position.x", "pose.covariance[-1]"],
    }
    with batch(built, 2, obs=obs) as made:
        values = made.reset()
        assert values["diagonal"].shape == (2, 6) and values["/odom"].shape == (2, 4)
        assert np.array_equal(values["diagonal"][:, -1], values["/odom"][:, -1])
        assert (values["diagonal"] > 0).all()
    with raises(FIELD_UNKNOWN, length=36), batch(built, 1, obs={"/odom": "pose.covariance[36]"}):
        pass


def joints(world):
    arm = world.models[-1]
    return [world.model(arm).joint(each) for each in ("beam_joint", "tip_joint")]


@pytest.mark.parametrize("fields", [["data[:2]"], ["data[0]", "data[1]"], ["data[1]", "data[0]"]])
def test_elements_of_an_array_are_columns(tmp_path, fields):
    (tmp_path / "group.yaml").write_text(GROUP)
    arm = cw.build("empty", [{"robot": ARM, "controllers": tmp_path / "group.yaml"}])
    with Batch(arm, 1, act={"/arm/commands": fields}, obs={"q": joints}, workers=0) as made:
        swapped = fields[0] == "data[1]"
        assert made.action_names[0] == f"/arm/commands data[{int(swapped)}]"
        made.reset()
        for _ in range(10):
            ((first, second),) = made.step(np.array([[0.3, -0.2]]))["q"]
        expected = (-0.2, 0.3) if swapped else (0.3, -0.2)
        assert (first, second) == pytest.approx(expected, abs=0.01)


@pytest.mark.parametrize(
    ("field", "code"),
    [
        ("data", FIELD_UNKNOWN), ("data[:0]", FIELD_UNKNOWN), ("data[99999]", FIELD_UNKNOWN),
        ("data[x]", FIELD_UNKNOWN), ("date[0]", FIELD_UNKNOWN), ("data[0].x", FIELD_VALUE_INVALID),
    ],
)  # fmt: skip
def test_what_is_no_element_is_refused(field, code):
    with raises(code):
        maker("std_msgs/msg/Float64MultiArray", expanded(field))


def test_elements_within_messages_are_set():
    make = maker("trajectory_msgs/msg/JointTrajectory", ["points[1].positions[2]"])
    message = make([0.5])
    assert message.points[0].positions.tolist() == []
    assert message.points[1].positions.tolist() == [0.0, 0.0, 0.5]
    covariance = maker("geometry_msgs/msg/PoseWithCovariance", ["covariance[7]"])([2.0]).covariance
    assert len(covariance) == 36 and covariance[7] == covariance.sum() == 2.0
    with raises(FIELD_UNKNOWN):
        maker("geometry_msgs/msg/PoseWithCovariance", ["covariance[36]"])
