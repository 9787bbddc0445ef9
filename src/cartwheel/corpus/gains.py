"""Gains of controllers that yield to a load, because their integral is slow or absent."""

from __future__ import annotations

import contextlib
import math
from collections.abc import Sequence

from cartwheel.corpus import commands, motion
from cartwheel.description.model import RobotDescription
from cartwheel.dialects.catalogue import plugin_named, short_name
from cartwheel.dialects.gz.joint_controller import (
    JointController,
    JointPositionController,
    JointPositionParameters,
    JointVelocityParameters,
)
from cartwheel.dialects.ros_control.controller import Controller
from cartwheel.dialects.tags import read
from cartwheel.errors import PluginError

_COMPLETE = 50.0
"""Exponent of a factor that is as good as infinite."""


def weak_gains(robot: RobotDescription, started: Sequence[Controller]) -> dict[str, float]:
    """Proportional gains of PIDs with an effort output and a slow or no integral, by joint."""
    found = _hardware_gains(started)
    ros1 = any(short_name(tag.filename) == "gazebo_ros_control" for tag in robot.plugins)
    for controller in started:
        values = controller.settings.flat()
        for joint, interface in controller.interfaces.items():
            path = next(
                (
                    each
                    for each in ("pid", f"gains.{joint}", f"{joint}.pid")
                    if f"{each}.p" in values
                ),
                None,
            )
            if interface == "effort" and path is not None:
                gain, integral = (values.get(f"{path}.{name}") or 0.0 for name in ("p", "i"))
                clamps = ("i_clamp", "i_clamp_min", "i_clamp_max")
                if ros1 and not any(values.get(f"{path}.{name}") for name in clamps):
                    # ros_control limits the integral to 0 if no limit is stated.
                    integral = 0.0
                if motion.yields(float(gain), float(integral)):
                    found[joint] = float(gain)
    for tag in robot.plugins:
        if plugin_named(tag.filename) is JointPositionController:
            with contextlib.suppress(PluginError):
                config, _ = read(JointPositionParameters, tag.element)
                if not config.velocity and motion.yields(config.p, config.i):
                    found |= dict.fromkeys(config.joints, config.p)
        if plugin_named(tag.filename) is JointController:
            with contextlib.suppress(PluginError):
                speed, _ = read(JointVelocityParameters, tag.element)
                weak = motion.yields(speed.p, speed.i) or speed.i_max < speed.p
                if speed.force and weak:
                    found |= dict.fromkeys(speed.joints, speed.p)
    return found


def _hardware_gains(started: Sequence[Controller]) -> dict[str, float]:
    """The gains of PIDs in the hardware, to which controllers forward their commands."""
    found: dict[str, float] = {}
    for controller in started:
        for joint, hardware in controller.claims.items():
            interface = controller.interfaces[joint]
            pid = hardware.pids.get(interface)
            if pid is None or pid.gains.p <= 0:
                continue
            gain, integral = pid.gains.p, pid.gains.i if pid.gains.i_max > 0 else 0.0
            if interface == "velocity":
                # The integral reduces the error by this factor before the velocity is measured.
                found[joint] = gain * math.exp(min(integral / gain * commands.SPEEDING, _COMPLETE))
            elif motion.yields(gain, integral):
                found[joint] = gain
    return found
