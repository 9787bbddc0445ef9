"""Environments: what Gymnasium requires, and the worlds behind them."""

from __future__ import annotations

import dataclasses
import warnings

import numpy as np
import pytest
from tests.coded import raises

from cartwheel.codes.graph import SERVICE_TAKEN
from cartwheel.codes.world import BATCH_INVALID

pytest.importorskip("gymnasium")

from gymnasium.utils.env_checker import check_env
from gymnasium.vector import AutoresetMode
from tests.gym.duties import FORWARD, pose, progress, relative, task

from cartwheel.gym import Env, VectorEnv, vary


@pytest.fixture(scope="module")
def job():
    return task()


def test_the_checker_of_gymnasium_passes(job):
    env = Env(job, render_mode="rgb_array")
    with warnings.catch_warnings():
        # It advises against observations without limits.
        warnings.filterwarnings("ignore", message=".*Box observation space.*")
        # And it tests other ways of rendering only for registered environments.
        warnings.filterwarnings("ignore", message=".*alternative render modes.*")
        check_env(env)
    assert env.observation_space.contains(env.reset(seed=1)[0])
    env.close()


def test_a_picture_is_an_image_space(job):
    topic = "/rosbots/camera1/image_raw"
    seeing = dataclasses.replace(job, obs={topic: "data", "pose": pose})
    vector = VectorEnv(seeing, 2, workers=0)
    space = vector.single_observation_space[topic]
    assert space.dtype == np.uint8 and len(space.shape) == 3 and space.shape[2] == 3
    assert (space.low.min(), space.high.max()) == (0, 255)
    values, _ = vector.reset(seed=1)
    assert vector.observation_space.contains(values)
    values = vector.step(np.tile(FORWARD, (2, 1)))[0]
    assert vector.observation_space.contains(values) and values[topic].std() > 5
    vector.close()


def test_an_episode_ends_by_success_or_time(job):
    env = Env(job)
    env.reset(seed=3)
    count, rewards = 0, 0.0
    while True:
        values, reward, ended, late, _ = env.step(FORWARD)
        count, rewards = count + 1, rewards + reward
        if ended or late:
            break
    assert ended and not late and values["pose"][0] > 0.2
    assert rewards == pytest.approx(values["pose"][0], abs=1e-3)
    env.reset()
    steps = [env.step(np.zeros(2, np.float32))[2:4] for _ in range(10)]
    assert steps == [(False, False)] * 9 + [(False, True)]
    env.close()


def test_seeds_repeat_episodes(job):
    env = Env(job)

    def drive(seed):
        values = [env.reset(seed=seed)[0]["pose"]]
        values += [env.step(FORWARD)[0]["pose"] for _ in range(5)]
        return np.array(values)

    first, other, again = drive(1), drive(2), drive(1)
    assert np.array_equal(first, again) and not np.array_equal(first, other)
    # Each episode has variations of its own.
    assert not np.array_equal(drive(None), drive(None))
    env.close()


@pytest.mark.parametrize("workers", [0, 2])
def test_a_vector_repeats_single_environments(job, workers):
    """Also after the ends of episodes: an environment starts anew in the step after."""
    n, count = 3, 16
    actions = np.random.default_rng(2).uniform(0.2, 1.0, (count, n, 2)).astype(np.float32)
    vector = VectorEnv(job, n, workers=workers)
    assert vector.metadata["autoreset_mode"] is AutoresetMode.NEXT_STEP
    values, _ = vector.reset(seed=7)
    assert vector.observation_space.contains(values) and vector.action_space.contains(actions[0])
    seen = [(values["pose"], np.zeros(n), np.zeros(n, bool), np.zeros(n, bool))]
    for each in actions:
        values, *rest, _ = vector.step(each)
        seen.append((values["pose"], *rest))
    vector.close()
    over = np.zeros(n, bool)
    for index in range(n):
        env = Env(job)
        values, _ = env.reset(seed=7 + index)
        assert np.array_equal(seen[0][0][index], values["pose"])
        ended = late = False
        for number, each in enumerate(actions):
            if ended or late:
                values, _ = env.reset()
                reward, ended, late = 0.0, False, False
                over[index] = True
            else:
                values, reward, ended, late, _ = env.step(each[index])
            got = [part[index] for part in seen[number + 1]]
            assert np.array_equal(got[0], values["pose"])
            assert got[1:] == [reward, ended, late]
        env.close()
    assert over.all()


@pytest.mark.parametrize("mode", [AutoresetMode.SAME_STEP, AutoresetMode.DISABLED])
def test_other_ways_to_start_the_next_episode(job, mode):
    """The observations of the next episode come one step earlier, or on demand."""
    n, actions = 2, np.tile(FORWARD, (2, 1))
    usual, other = (VectorEnv(job, n, workers=0, autoreset=each) for each in
                    (AutoresetMode.NEXT_STEP, mode))  # fmt: skip
    for vector in (usual, other):
        vector.reset(seed=4)
    episodes = 0
    for _ in range(24):
        values, *rest, _ = usual.step(actions)
        same, *other_rest, infos = other.step(actions)
        over = rest[1] | rest[2]
        for one, two in zip(rest, other_rest, strict=True):
            assert np.array_equal(one, two)
        if over.any() and mode is AutoresetMode.SAME_STEP:
            assert np.array_equal(infos["_final_obs"], over)
            for index in np.flatnonzero(over):
                assert np.array_equal(infos["final_obs"][index]["pose"], values["pose"][index])
            assert not (over & ~np.any(same["pose"] != values["pose"], axis=1)).any()
        elif over.any():
            assert np.array_equal(same["pose"], values["pose"])
            other.reset(options={"reset_mask": over})
        episodes += int(over.sum())
        if over.any():
            # All start together, so that both are at the same step again.
            for vector in (usual, other):
                vector.reset(seed=10 + episodes)
    assert episodes >= 4
    for vector in (usual, other):
        vector.close()


def test_the_gymnasium_wrappers_accept_a_vector(job):
    from gymnasium.wrappers.vector import RecordEpisodeStatistics

    vector = RecordEpisodeStatistics(VectorEnv(job, 2, workers=0))
    vector.reset(seed=0)
    lengths = []
    for _ in range(12):
        *_, infos = vector.step(np.zeros((2, 2), np.float32))
        if "episode" in infos:
            lengths += infos["episode"]["l"][infos["_episode"]].tolist()
    assert lengths == [10, 10]
    vector.close()


def test_limits_are_those_of_the_space():
    env = Env(task(limits={"pose": (-0.05, 0.05)}, ended=None, vary=None))
    space = env.observation_space["pose"]
    assert (space.low == np.float32(-0.05)).all() and (space.high == np.float32(0.05)).all()
    env.reset(seed=0)
    for _ in range(9):
        values = env.step(FORWARD)[0]
    assert values["pose"][0] == np.float32(0.05)
    env.close()


def far(world):
    return [float("inf")]


@pytest.mark.parametrize(
    "options",
    [
        {"act": {"/part2_cmr/cmd_vel": {"linear.x": (1.0, 1.0)}}},
        {"act": {"/part2_cmr/cmd_vel": ["linear.x"]}},
        {"limits": {"pos": (0.0, 1.0)}},
        {"obs": {"far": far}},
        {"reward": lambda before, action, after: 0.0},
        {"ended": lambda after: np.zeros((1, 2))},
    ],
)  # fmt: skip
def test_mistakes_are_errors(options):
    with raises(BATCH_INVALID):
        env = Env(task(**options))
        env.reset()
        env.step(FORWARD)


def test_variations_start_from_the_values_of_the_file(job):
    from cartwheel.batch import Batch

    change = vary("rosbots", mass=(2.0, 2.0), friction=(0.3, 0.3), light=(0.5, 0.5),
                  damping=(3.0, 3.0), effort=(0.5, 0.5), pose={"x": (1.0, 1.0)})  # fmt: skip
    batch = Batch(job.built, 1, act={}, obs={"pose": pose}, vary=change, workers=0)
    world = batch.world(0)
    cart = world.model("rosbots")
    mass, damping = cart.link("base_link").mass, cart.joints["wheel_left_joint"].damping
    light = world.light("sun").intensity
    for _ in range(3):
        batch.reset()
        assert cart.link("base_link").mass == 2 * mass
        assert cart.link("wheel_left_link").friction == (0.3, 0.3)
        assert cart.joints["wheel_left_joint"].damping == 3 * damping
        assert world.light("sun").intensity == 0.5 * light
        assert cart.joints["wheel_left_joint"].effort_limit == 10.0
        assert cart.pose.x == pytest.approx(1.0, abs=0.01)
    batch.close()
    assert progress({"pose": np.zeros((1, 3))}, None, {"pose": np.ones((1, 3))}).tolist() == [1.0]


def test_relative_changes_do_not_accumulate(job):
    """An episode depends on its seed, and not on the episodes before it."""
    env = Env(dataclasses.replace(job, vary=relative))
    world = env._batch.world(0)

    def drive(made, seed):
        values = [made.reset(seed=seed)[0]]
        values += [made.step(FORWARD)[0] for _ in range(4)]
        return [{name: each.tolist() for name, each in value.items()} for value in values]

    seen, masses = [], []
    for seed in (7, 7, 8, 7):
        seen.append(drive(env, seed))
        masses.append(world.model("rosbots").link("base_link").mass)
        assert len(world.faults) == 1 and world.models[-1] == "box"
        left_out = world.save().left_out
        assert left_out.count("subscriber of /odom") == 1
        assert sum(each.startswith("action at") for each in left_out) == 1
    env.close()
    assert masses[0] == masses[1] == masses[3] != masses[2]
    assert seen[0] == seen[1] == seen[3] != seen[2]
    other = Env(dataclasses.replace(job, vary=relative))
    assert drive(other, 8) == seen[2]
    other.close()


def test_the_checker_of_gymnasium_passes_with_relative_changes(job):
    env = Env(dataclasses.replace(job, vary=relative))
    with warnings.catch_warnings():
        warnings.filterwarnings("ignore", message=".*Box observation space.*")
        warnings.filterwarnings("ignore", message=".*render.*")
        check_env(env, skip_render_check=True)
    env.close()


def offers(world, random):
    world.serve("/lamp", "std_srvs/srv/Trigger", lambda request: {"success": True})


def test_what_cannot_be_restored_is_refused_by_name(job):
    """The service of the first episode would call a function of that episode."""
    env = None
    with raises(SERVICE_TAKEN) as caught:
        env = Env(dataclasses.replace(job, vary=offers))
        env.reset()
    assert "/lamp" in str(caught.value)
    if env is not None:
        env.close()


def drive(world, action):
    speed, turn = action.tolist()
    world.publish("/part2_cmr/cmd_vel", linear_x=speed, angular_z=turn)


def test_a_function_and_elements_of_arrays_act(job):
    applied = dataclasses.replace(job, act={"drive": (drive, [(-1.0, 1.0), (-2.0, 2.0)])})
    one, other = Env(job), Env(applied)
    assert other.action_space.high.tolist() == [1.0, 2.0]
    one.reset(seed=4)
    other.reset(seed=4)
    expected, found = one.step(FORWARD)[0], other.step(FORWARD)[0]
    assert all(np.array_equal(expected[name], found[name]) for name in expected)
    one.close()
    other.close()
    group = dataclasses.replace(job, act={"/arm/commands": {"data[:3]": (-0.5, 1.5)}})
    assert group.action_space().low.tolist() == [-0.5] * 3
    with raises(BATCH_INVALID):
        Env(dataclasses.replace(job, act={"drive": (drive, [(1.0, 1.0)])}))


@pytest.mark.wording
def test_an_action_of_another_shape_is_refused(job):
    env = Env(job)
    env.reset(seed=1)
    for shape in ((7,), (), (1, *env.action_space.shape)):
        with raises(BATCH_INVALID) as caught:
            env.step(np.zeros(shape))
        assert str(env.action_space.shape) in caught.value.message
    env.close()
