"""Trajectories for plugins that set the positions of joints without forces."""

from __future__ import annotations

from collections.abc import Iterator

from cartwheel.api import Model, World
from cartwheel.corpus.motion import target_of
from cartwheel.corpus.verdict import Reach
from cartwheel.description.model import RobotDescription
from cartwheel.dialects.catalogue import plugin_named, short_name
from cartwheel.dialects.classic.mechanisms.joint_pose_trajectory import JointPoseTrajectory

_TYPE = "trajectory_msgs/msg/JointTrajectory"
_WAITING = 1.0
"""Time for the plugin to set the positions at its own rate, s."""
_MOVABLE = ("revolute", "continuous", "prismatic")


def posed(world: World, model: Model, robot: RobotDescription) -> Iterator[Reach]:
    """Commands each such plugin and measures how close the joints come to their positions.

    Nothing holds the joints afterwards.
    """
    tags = [tag for tag in robot.plugins if plugin_named(tag.filename) is JointPoseTrajectory]
    joints = {
        each.name: each for each in robot.joints if each.type in _MOVABLE and each.mimic is None
    }
    if not tags or not joints:
        return
    nodes = {f"{model.name}/{tag.name}" for tag in tags}
    step = world.session.simulation.model.opt.timestep
    for info in world.graph.topics():
        if info.type != _TYPE or nodes.isdisjoint(info.subscribers):
            continue
        world.reset()
        world.run(step)
        targets = {name: target_of(joint, model.joint(name)) for name, joint in joints.items()}
        world.publish(
            info.name,
            {
                "joint_names": list(targets),
                "points": [{"positions": list(targets.values()), "time_from_start": {"sec": 0}}],
            },
        )
        start = {name: model.joint(name) for name in targets}
        nearest = dict(start)
        for _ in range(round(_WAITING / step)):
            world.run(step)
            for name, target in targets.items():
                position = model.joint(name)
                if abs(position - target) < abs(nearest[name] - target):
                    nearest[name] = position
        for name, target in targets.items():
            yield Reach(
                controller=short_name(tags[0].filename),
                joint=name,
                start=start[name],
                target=target,
                reached=nearest[name],
                angular=joints[name].type != "prismatic",
            )
