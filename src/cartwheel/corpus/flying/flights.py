"""Commands to the propellers of an aircraft."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping, Sequence
from typing import Any

import numpy as np

from cartwheel.api import Model, World
from cartwheel.corpus.verdict import RISEN, Flight
from cartwheel.description.kinematics import link_poses
from cartwheel.description.model import PluginTag, RobotDescription
from cartwheel.dialects.catalogue import short_name
from cartwheel.geometry import Vec3, rotate

_ACTUATORS = {
    "mav_msgs/msg/Actuators": "angular_velocities",
    "actuator_msgs/msg/Actuators": "velocity",
    "hector_uav_msgs/msg/MotorPWM": "pwm",
}
"""Fields with the propellers' speeds, or duty cycles, by message type."""
_DUTY = 255
"""The duty cycle of a motor at its full voltage."""
_PROPELLERS = 4
"""Number of propellers of a plugin for all of them."""
_STEPS = 20
"""Number of propeller speeds to try."""
_CLIMBING = 1.0
"""Time at each propeller speed, s."""
_LOOKING = 0.1
"""Interval at which the height is measured, s."""
MOST_ACTUATORS = 1000
"""Number of values in a message of type Actuators. Files may state larger indices, for which the
message would not fit into memory.
"""
_FASTEST = 838.0
"""rad/s; the default of gz-sim's motor model."""
_LIFTS = 0.3
"""Minimum cosine of the angle between the vertical and the thrust of a propeller that lifts."""
_UP = (0.0, 0.0, 1.0)
_MOTOR = re.compile(r"motor_model|multicopter-motor")
_MOTORS = re.compile(r"quadrotor_propulsion")


def flights(world: World, model: Model, robot: RobotDescription) -> Iterator[Flight]:
    """Tries increasing speeds of the propellers, each from standstill, until the aircraft rises.

    Nothing stabilises it, so it tips over if the thrust hardly exceeds its weight for a while. Only
    the propellers with an upward thrust turn. Without one, the propellers must move the robot in
    the direction of their thrust, such as that of an aeroplane.
    """
    tags = [tag for tag in robot.plugins if _MOTOR.search(short_name(tag.filename))]
    together = [tag for tag in robot.plugins if _MOTORS.search(short_name(tag.filename))]
    if not tags and not together:
        return
    thrusts = (
        _thrusts(robot, tags) if tags else dict.fromkeys(range(_PROPELLERS * len(together)), _UP)
    )
    lifting = {number for number, thrust in thrusts.items() if thrust[2] >= _LIFTS}
    turning = lifting or set(thrusts)
    way = _UP if lifting else _mean([thrusts[number] for number in turning])
    stated = [tag.element.find("maxRotVelocity") for tag in tags]
    fastest = max([float(each.text) for each in stated if each is not None], default=_FASTEST)
    for info in world.graph.topics():
        field = _ACTUATORS.get(info.type)
        if field is None or not info.subscribers:
            continue
        speed = rose = 0.0
        for step in range(1, _STEPS + 1):
            speed = fastest * step / _STEPS if field != "pwm" else _DUTY * step // _STEPS
            speeds = [speed if n in turning else type(speed)(0) for n in range(max(thrusts) + 1)]
            rose = _moved(world, model, info.name, {field: speeds}, way)
            if rose >= RISEN:
                break
        yield Flight(topic=info.name, motors=len(turning), command=speed, rose=rose)


def _thrusts(robot: RobotDescription, tags: Sequence[PluginTag]) -> dict[int, Vec3]:
    """The directions of the propellers' thrusts in the robot's frame, by their numbers."""
    poses = link_poses(robot, {})
    found: dict[int, Vec3] = {}
    for index, tag in enumerate(tags):
        number, link = (
            next((each.text.strip() for name in names if (each := tag.element.find(name))), "")
            for names in (("actuator_number", "motorNumber"), ("linkName",))
        )
        pose = poses.get(link)
        thrust = _UP if pose is None else rotate(pose.orientation, _UP)
        is_index = number.isdecimal() and len(number) < 10 and int(number) < MOST_ACTUATORS
        found[int(number) if is_index else index] = thrust
    return found


def _mean(thrusts: Sequence[Vec3]) -> Vec3:
    """The direction of the sum; up if there is none."""
    total = np.sum(thrusts, axis=0)
    length = float(np.linalg.norm(total))
    if length < _LIFTS:
        return _UP
    x, y, z = (total / length).tolist()
    return x, y, z


def _moved(world: World, model: Model, topic: str, command: Mapping[str, Any], way: Vec3) -> float:
    """Longest way in a direction of the initial frame, after a command from standstill, m."""
    world.reset()
    world.run(0.5)
    start, moved = model.pose, 0.0
    toward = way if way == _UP else rotate(start.orientation, way)
    world.publish(topic, command)
    for _ in range(round(_CLIMBING / _LOOKING)):
        world.run(_LOOKING)
        moved = max(moved, float(np.dot(toward, np.subtract(model.pose.position, start.position))))
    return moved
