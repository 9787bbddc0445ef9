"""How much drag slows down a multicopter with a proportional velocity controller."""

from __future__ import annotations

import contextlib
import math

import numpy as np

from cartwheel.description.kinematics import link_poses
from cartwheel.description.model import RobotDescription
from cartwheel.dialects.catalogue import plugin_named
from cartwheel.dialects.gz.vehicles.motor_model import GzMotorModel, GzMotorParameters
from cartwheel.dialects.gz.vehicles.multicopter_control import (
    MulticopterControl,
    MulticopterControlParameters,
)
from cartwheel.dialects.tags import read
from cartwheel.errors import PluginError

_GRAVITY = 9.8
"""m/s²."""


def climbs(robot: RobotDescription) -> bool:
    """Whether velocity commands let a robot fly, so that it must leave the ground first."""
    return any(plugin_named(tag.filename) is MulticopterControl for tag in robot.plugins)


def drag_errors(robot: RobotDescription) -> tuple[float, float]:
    """Relative errors of the forward speed and of the yaw rate that follow from the gains.

    A propeller at the angular speed w that moves at v is braked by a force of c w v, where c is its
    ``<rotorDragCoefficient>``. Against this force, gz-sim's MulticopterVelocityControl needs an
    error, because its velocity gain k has no integral part: c w / (k + c w) of the command.

    Returns:
        Positive numbers below 1; 0 for a robot without this controller.
    """
    poses = link_poses(robot, {})
    motors: list[GzMotorParameters] = []
    control: MulticopterControlParameters | None = None
    for tag in robot.plugins:
        plugin = plugin_named(tag.filename)
        with contextlib.suppress(PluginError):
            if plugin is GzMotorModel:
                motors.append(read(GzMotorParameters, tag.element)[0])
            elif plugin is MulticopterControl:
                control = read(MulticopterControlParameters, tag.element)[0]
    lift = sum(each.motor_constant for each in motors)
    if control is None or lift <= 0 or control.link.strip() not in poses:
        return 0.0, 0.0
    speed = math.sqrt(robot.mass * _GRAVITY / lift)
    centre = np.array(poses[control.link.strip()].position)
    along = turning = 0.0
    for each in motors:
        place = poses.get(each.link.strip())
        if place is not None:
            x, y, _ = np.array(place.position) - centre
            along += each.drag * speed
            turning += each.drag * speed * (x**2 + y**2)
    return (
        along / (control.velocity_gain[0] + along) if along else 0.0,
        turning / (control.rate_gain[2] + turning) if turning else 0.0,
    )
