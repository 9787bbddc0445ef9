"""A robot learns to reach goals among pillars by its laser.

$ pip install "cartwheel[gym]" stable-baselines3
$ python reach.py --steps 150000
"""

from __future__ import annotations

import argparse
import math
from pathlib import Path
from typing import Any

import numpy as np

import cartwheel as cw
from cartwheel.gym import Env, Task, VectorEnv

FOLDER = Path(__file__).parent
REACH = 4.0
"""Maximum range of the laser, m."""
ARRIVED, TOUCHED = 0.35, 0.23
"""Distances from the goal, and from a wall, that end an episode, m."""


def place(world: cw.World, random: np.random.Generator) -> None:
    """Puts the robot and the goal at free places that are at least 1 m apart."""
    pillars = [world.model("room").link(f"pillar_{index}").pose for index in range(5)]

    def free() -> tuple[float, float]:
        while True:
            x, y = random.uniform(-2.5, 2.5, 2)
            if all(math.hypot(x - each.x, y - each.y) > 0.6 for each in pillars):
                return float(x), float(y)

    robot, goal = free(), free()
    while math.dist(robot, goal) < 1.0:
        goal = free()
    world.model("scout").pose = cw.Pose.from_xyz_rpy(
        (*robot, 0.0), (0.0, 0.0, random.uniform(-math.pi, math.pi))
    )
    world.model("goal").pose = cw.Pose((*goal, 0.01))


def to_goal(world: cw.World) -> list[float]:
    """Distance to the goal in m, and the cosine and sine of its direction from the robot."""
    robot, goal = world.model("scout").pose, world.model("goal").pose
    x, y = goal.x - robot.x, goal.y - robot.y
    angle = math.atan2(y, x) - robot.yaw
    return [math.hypot(x, y), math.cos(angle), math.sin(angle)]


def arrived(values: Any) -> Any:
    """Whether each robot is at its goal."""
    return values["goal"][:, 0] < ARRIVED


def touched(values: Any) -> Any:
    """Whether each robot is close to a wall or a pillar."""
    return values["/scan"].min(axis=1) < TOUCHED


def ended(values: Any) -> Any:
    """Whether each episode ends."""
    return arrived(values) | touched(values)


def reward(before: Any, actions: Any, after: Any) -> Any:  # noqa: ARG001
    """The progress in m, with a bonus at the goal and a penalty at a wall."""
    progress = before["goal"][:, 0] - after["goal"][:, 0]
    return progress + 2.0 * arrived(after) - 1.0 * touched(after) - 0.02


def task() -> Task:
    """Goals in a room."""
    built = cw.build(FOLDER / "room.world", [FOLDER / "scout.urdf"])
    return Task(
        built=built,
        act={"/cmd_vel": {"linear.x": (0.0, 0.6), "angular.z": (-1.5, 1.5)}},
        obs={"/scan": "ranges", "goal": to_goal},
        limits={"/scan": (0.0, REACH), "goal": (-9.0, 9.0)},
        reward=reward,
        ended=ended,
        vary=place,
        period=0.2,
        seconds=30.0,
    )


def successes(job: Task, act: Any, episodes: int = 100) -> float:
    """The share of episodes that end at the goal."""
    env = Env(job)
    found = 0
    for episode in range(episodes):
        values, _ = env.reset(seed=100_000 + episode)
        while True:
            values, _, over, late, _ = env.step(act(values))
            if over or late:
                break
        found += bool(arrived({name: each[None] for name, each in values.items()})[0])
    env.close()
    return found / episodes


def main() -> None:
    """Trains, and prints the share of goals that were reached."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--steps", type=int, default=150_000)
    parser.add_argument("--worlds", type=int, default=16)
    parser.add_argument("--curve", type=Path, help="write the curve to this CSV file")
    options = parser.parse_args()
    from gymnasium.vector import AutoresetMode
    from learner import Worlds
    from stable_baselines3 import PPO

    job = task()
    worlds = Worlds(VectorEnv(job, options.worlds, autoreset=AutoresetMode.SAME_STEP))
    model = PPO(
        "MultiInputPolicy", worlds, n_steps=128, batch_size=256, n_epochs=6, gamma=0.98,
        learning_rate=5e-4, ent_coef=0.005, seed=1, device="cpu",
    )  # fmt: skip
    rows = ["steps,reached"]
    before = 0
    while before < options.steps:
        model.learn(min(options.steps - before, 25_000), reset_num_timesteps=False)
        before = model.num_timesteps
        share = successes(job, lambda values: model.predict(values, deterministic=True)[0])
        rows.append(f"{before},{share:.2f}")
        print(f"{before} steps: {share:.0%} of the goals reached", flush=True)
    worlds.close()
    if options.curve is not None:
        options.curve.write_text("\n".join(rows) + "\n")


if __name__ == "__main__":
    main()
