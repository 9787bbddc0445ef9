"""Gains of controllers that yield to a load, because their integral is slow or absent."""

from __future__ import annotations

import contextlib
import math
from collections.abc import Container, Iterable, Iterator, Mapping, Sequence
from typing import Any

import numpy as np

from cartwheel.checks.gains import gain_too_low
from cartwheel.checks.robot import Robot
from cartwheel.checks.wheels import axle_of, wheel_links, wheel_radius, wheel_tread
from cartwheel.codes import devices
from cartwheel.corpus import commands, motion
from cartwheel.corpus.verdict import Reach
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
from cartwheel.errors import Diagnostic, Origin, PluginError

_GRAVITY = 9.8
"""m/s²."""
_COMPLETE = 50.0
"""Exponent of a factor that is as good as infinite."""


def weak_gains(robot: RobotDescription, started: Sequence[Controller]) -> dict[str, float]:
    """Proportional gains of PIDs with an effort output and a slow or no integral, by joint."""
    found = _hardware_gains(started)
    ros1 = any(short_name(tag.filename) == "gazebo_ros_control" for tag in robot.plugins)
    for controller in started:
        values = controller.settings.flat()
        for joint, interface in controller.interfaces.items():
            path = _path_of_gains(joint, values)
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


def too_weak(
    robot: RobotDescription,
    started: Sequence[Controller],
    gains: Mapping[str, float],
    joints: Iterable[str],
) -> Iterator[Diagnostic]:
    """Joints whose proportional gain is too low for their friction or the weight on them.

    Args:
        robot: The description.
        started: The controllers that run.
        gains: The gains that `weak_gains` returns.
        joints: The joints of interest.
    """
    places = _places(robot, started)
    described = Robot(robot, None)
    fast = motion.commanded_speeds(started)
    for name in joints:
        joint = robot.joint(name)
        if joint is not None and name in gains:
            place = places.get(name, joint.origin)
            yield from gain_too_low(described, joint, gains[name], place, of_velocity=name in fast)


def sagged(
    robot: RobotDescription,
    started: Sequence[Controller],
    gains: Mapping[str, float],
    reached: Iterable[Reach],
) -> Iterator[Diagnostic]:
    """Joints that sag far from their targets, because their proportional gains are low.

    Args:
        robot: The description.
        started: The controllers that run.
        gains: The gains that `weak_gains` returns.
        reached: Where the joints ended.
    """
    places = _places(robot, started)
    for reach in reached:
        if not reach.sags or reach.joint not in gains:
            continue
        joint, gain = robot.joint(reach.joint), gains[reach.joint]
        unit, effort = ("rad", "N m") if reach.angular else ("m", "N")
        yield devices.CONTROLLER_GAIN_TOO_LOW.diagnostic(
            f"with the proportional gain of {gain:g} {effort}/{unit}, joint "
            f'"{reach.joint}" ends at {reach.reached:.3g} {unit} instead of {reach.target:.3g} '
            f"{unit}, because of its load and its friction",
            values={"joint": reach.joint, "gain": gain, "error": reach.error},
            origin=places.get(reach.joint, robot.origin if joint is None else joint.origin),
            hint="Use a higher proportional gain, or an integral gain.",
        )


def _places(robot: RobotDescription, started: Sequence[Controller]) -> dict[str, Origin]:
    """Where the gains of joints are stated, by joint."""
    places = {
        name: Origin(file=controller.settings.source)
        for controller in started
        if controller.settings.source
        for name in controller.interfaces
    }
    for tag in robot.plugins:
        if plugin_named(tag.filename) is JointPositionController:
            named = {each.text.strip() for each in tag.element.find_all("joint_name")}
            places |= dict.fromkeys(named, tag.origin)
    return places


def undamped(
    robot: RobotDescription, started: Sequence[Controller], joints: Container[str]
) -> Iterator[Diagnostic]:
    """Joints that a PID moves like a spring, because nothing damps it.

    Args:
        robot: The description.
        started: The controllers that run.
        joints: The joints of interest.
    """
    axes = {joint.name: joint.axis for joint in robot.joints}
    for controller in started:
        values = controller.settings.flat()
        for joint, interface in controller.interfaces.items():
            axis = axes.get(joint)
            if joint not in joints or axis is None or axis.damping or axis.friction:
                continue
            gains = _position_gains(controller, joint, interface, values)
            if gains is not None and gains[0] > 0 and gains[1] == 0:
                yield devices.CONTROLLER_UNDAMPED.diagnostic(
                    f'the PID controller of joint "{joint}" has no derivative gain, and the joint '
                    "no damping, so it oscillates around its target",
                    severity="info",
                    origin=Origin(file=controller.settings.source)
                    if controller.settings.source
                    else robot.origin,
                    values={"joint": joint, "controller": controller.name, "p": gains[0]},
                    hint="Set a derivative gain, or the damping of the joint.",
                )


def too_weak_to_turn(
    robot: Robot, started: Sequence[Controller], turn: float
) -> Iterator[Diagnostic]:
    """Bases whose wheels cannot slide in a turn, because the gains of their velocities are too low.

    A proportional gain turns a wheel with at most the gain times the commanded speed. A wheel with
    radius r that carries the load N slides from the torque mu N r.

    Args:
        robot: The robot, with the wheels of its controllers.
        started: The controllers that run.
        turn: The commanded turn rate, rad/s.
    """
    gains = _hardware_gains(started)
    for left, right in robot.controlled:
        joints = [robot.joints[name] for name in (*left, *right)]
        radii = [wheel_radius(robot, joint) for joint in joints]
        links = [name for joint in joints for name in wheel_links(robot, joint)]
        if not gains.keys() >= {*left, *right} or not robot.placed.issuperset(links):
            continue
        radius = min((each for each in radii if each), default=0.0)
        grips = [each.surface.mu1 for name in links for each in robot.links[name].collisions]
        if not radius or not all(radii) or not grips:
            continue
        axle = axle_of(robot, left, right, beside=True)
        first, second = (
            np.mean([wheel_tread(robot, robot.joints[name]) for name in side], axis=0)
            for side in (left, right)
        )
        speed = turn * abs(float((first - second) @ axle)) / 2 / radius
        gain = max(gains[joint.name] for joint in joints)
        mu = min(1.0 if each is None else each for each in grips)
        friction = mu * _GRAVITY * robot.description.mass / len(joints) * radius
        if gain * speed < friction:
            yield devices.CONTROLLER_GAIN_TOO_LOW.diagnostic(
                f"the velocity gain of {gain:.3g} N m s/rad turns the wheels with at most "
                f"{gain * speed:.3g} N m at the commanded {speed:.3g} rad/s, but they slide in a "
                f"turn only from {friction:.3g} N m",
                origin=robot.description.origin,
                values={"joints": (*left, *right), "gain": gain, "sliding": friction},
                hint=f"Use a gain well above {friction / speed:.3g} N m s/rad." if speed else "",
            )


def _position_gains(
    controller: Controller, joint: str, interface: str, values: Mapping[str, Any]
) -> tuple[float, float] | None:
    """Proportional and derivative gain of the PID of a joint's position; None if there is none."""
    if interface == "effort":
        path = _path_of_gains(joint, values)
        if path is None:
            return None
        return float(values.get(f"{path}.p") or 0.0), float(values.get(f"{path}.d") or 0.0)
    hardware = controller.claims.get(joint)
    pid = hardware.pids.get("position") if hardware is not None else None
    if interface != "position" or pid is None:
        return None
    return pid.gains.p, pid.gains.d


def _path_of_gains(joint: str, values: Mapping[str, Any]) -> str | None:
    """Path of a controller's gains for a joint with an effort interface."""
    paths = ("pid", f"gains.{joint}", f"{joint}.pid")
    return next((each for each in paths if f"{each}.p" in values), None)


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
