"""Commands to the thrusters of a boat, an underwater vehicle or a spacecraft."""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import TypeVar

from cartwheel.api import Model, World
from cartwheel.corpus.flying.flights import MOST_ACTUATORS
from cartwheel.corpus.verdict import Spin
from cartwheel.description.model import Joint, RobotDescription
from cartwheel.dialects.catalogue import plugin_named
from cartwheel.dialects.gz.fluids.thruster import ThrusterParameters, ThrusterSystem, topics
from cartwheel.dialects.gz.forces.spacecraft_thruster import (
    SpacecraftThrusterParameters,
    SpacecraftThrusterSystem,
    valve_topic,
)
from cartwheel.dialects.plugin import Plugin
from cartwheel.dialects.tags import read
from cartwheel.errors import PluginError
from cartwheel.geometry import rotate

C = TypeVar("C")
_ACCELERATION = 0.5
"""Acceleration of the robot's own mass by the commanded thrust, m/s²."""
_SECONDS = 0.1
"""Before the robot has turned or drifted much."""
_OTHERS = 64
"""Number of valves that stay closed after the opened one in a command."""


def is_in_space(robot: RobotDescription) -> bool:
    """Whether a robot moves without weight."""
    return any(plugin_named(tag.filename) is SpacecraftThrusterSystem for tag in robot.plugins)


def bursts(world: World, model: Model, robot: RobotDescription) -> Iterator[Spin]:
    """Opens each valve of a spacecraft alone.

    The velocity is that of the nozzle's link along the thrust.
    """
    live = _live(world)
    for config in _stated(robot, SpacecraftThrusterSystem, SpacecraftThrusterParameters):
        topic = valve_topic(model.name, model.namespace, config)
        is_commanded = topic in live and config.number < MOST_ACTUATORS
        if not is_commanded or robot.link(config.link.strip()) is None:
            continue
        world.reset()
        world.publish(topic, {"normalized": [0.0] * config.number + [1.0] + [0.0] * _OTHERS})
        world.run(_SECONDS)
        link = model.link(config.link.strip())
        axis = rotate(link.pose.orientation, (0.0, 0.0, 1.0))
        yield Spin(
            topic=topic,
            joint=link.name,
            commanded=config.thrust,
            measured=sum(a * b for a, b in zip(axis, link.velocity.linear, strict=True)),
            effort=True,
        )


def thrusts(world: World, model: Model, robot: RobotDescription) -> Iterator[Spin]:
    """Commands each thruster alone, in both directions.

    The velocity is that of the propeller along its axis: half of the difference between both
    directions, so that weight and buoyancy have no influence.
    """
    for topic, joint, config in _thrusters(world, model, robot):
        command = min(_command(config, robot.mass), config.most, -config.least)
        if command <= 0:
            # It works in one direction only.
            command = config.most if config.most > 0 else config.least
        sense = -1.0 if config.by_speed and _coefficient(config) < 0 else 1.0
        speeds = [
            _pushed(world, model, joint, topic, sign * sense * command) for sign in (1.0, -1.0)
        ]
        yield Spin(
            topic=topic,
            joint=joint.name,
            commanded=command,
            measured=(speeds[0] - speeds[1]) / 2,
            effort=True,
        )


def thruster_topics(world: World, model: Model, robot: RobotDescription) -> set[str]:
    """The topics of the commands to thrusters."""
    return {topic for topic, _, _ in _thrusters(world, model, robot)}


def _thrusters(
    world: World, model: Model, robot: RobotDescription
) -> Iterator[tuple[str, Joint, ThrusterParameters]]:
    """The topic, the joint and the tags of each thruster that was loaded."""
    live = _live(world)
    for config in _stated(robot, ThrusterSystem, ThrusterParameters):
        joint = robot.joint(config.joint.strip())
        topic, _, _ = topics(model.name, model.namespace, config)
        if joint is not None and topic in live:
            yield topic, joint, config


def _live(world: World) -> set[str]:
    """The topics that have subscribers."""
    return {info.name for info in world.graph.topics() if info.subscribers}


def _stated(robot: RobotDescription, plugin: type[Plugin[C]], tags: type[C]) -> Iterator[C]:
    """The valid tags of each plugin of a class."""
    for tag in robot.plugins:
        if plugin_named(tag.filename) is plugin:
            try:
                config, _ = read(tags, tag.element)
            except PluginError:
                continue
            yield config


def _command(config: ThrusterParameters, mass: float) -> float:
    """A force in N, or the speed in rad/s that causes it."""
    force = _ACCELERATION * mass
    if not config.by_speed:
        return force
    factor = abs(config.density * _coefficient(config)) * config.diameter**4
    return math.sqrt(force / factor) if factor else 0.0


def _coefficient(config: ThrusterParameters) -> float:
    return config.alpha_1 if config.coefficient is None else config.coefficient


def _pushed(world: World, model: Model, joint: Joint, topic: str, command: float) -> float:
    """Velocity of a propeller along its axis after a constant command from rest, m/s."""
    world.reset()
    world.publish(topic, {"data": command})
    world.run(_SECONDS)
    link = model.link(joint.child)
    axis = rotate(link.pose.orientation, rotate(joint.pose.orientation, joint.axis.xyz))
    velocity = link.velocity.linear
    return sum(a * b for a, b in zip(axis, velocity, strict=True))
