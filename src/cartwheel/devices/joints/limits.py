"""Limits of joints: functions of limits, state and command, for floats or arrays."""

from __future__ import annotations

import math
from dataclasses import dataclass

from cartwheel.description.model import Joint, SoftLimits
from cartwheel.devices.elementwise import Number, anywhere, clamp, maximum, where
from cartwheel.devices.joints.pid import DampedEffort

_INSIDE = 1 - 1e-6
"""Part of a limit: MuJoCo does not integrate the damping of an actuator at its limit implicitly."""


_ENDLESS = (-math.inf, math.inf)
"""The range of a joint without limits."""


@dataclass(frozen=True, kw_only=True, slots=True)
class JointLimits:
    """Limits of a joint. Source: joint_limits_interface."""

    lower: float = -math.inf
    """Minimum position, rad or m."""
    upper: float = math.inf
    """Maximum position, rad or m."""
    velocity: float = math.inf
    """Maximum speed, rad/s or m/s."""
    effort: float = math.inf
    """Maximum effort, N m or N."""
    soft: SoftLimits | None = None
    """Limits at which the joint slows down; None: not applied."""


def position_range(joint: Joint | None) -> tuple[float, float]:
    """Returns the lowest and highest position of a joint, rad or m; infinite without a limit."""
    if joint is None or joint.type == "continuous":
        return _ENDLESS
    lower, upper = joint.axis.lower, joint.axis.upper
    return -math.inf if lower is None else lower, math.inf if upper is None else upper


def velocity_limit(joint: Joint | None) -> float:
    """Returns the stated maximum speed of a joint, rad/s or m/s; infinite without a limit.

    A limit of 0 holds the joint, as in gz-sim's physics and in ROS 1's joint_limits_interface.
    """
    stated = joint.axis.velocity if joint is not None else None
    return math.inf if stated is None else stated


def velocity_bounds(limits: JointLimits, position: Number) -> tuple[Number, Number]:
    """Returns the lowest and highest velocity in rad/s or m/s at a position in rad or m.

    Near a soft limit, the speed toward it decreases. Source: PR2.
    """
    most, soft = limits.velocity, limits.soft
    if soft is None or math.inf in (-limits.lower, limits.upper):
        return -most, most
    low = clamp(-soft.k_position * (position - soft.lower), -most, most)
    high = clamp(-soft.k_position * (position - soft.upper), -most, most)
    return low, high


def limited_position(
    limits: JointLimits, target: Number, position: Number
) -> tuple[Number, Number]:
    """Returns a target position within the limits, and the maximum speed toward it.

    Args:
        limits: The limits.
        target: Target position, rad or m.
        position: Position of the joint, rad or m.
    """
    lower, upper, fastest = limits.lower, limits.upper, limits.velocity
    soft = limits.soft
    if soft is not None and math.inf not in (-lower, upper):
        lower, upper = max(lower, soft.lower), min(upper, soft.upper)
        low, high = velocity_bounds(limits, position)
        fastest = maximum(where(target > position, high, -low), 0.0)
    return clamp(target, lower, upper), fastest


def saturated(
    command: DampedEffort, limit: float, velocity: Number, gain: Number = 0.0
) -> DampedEffort:
    """Returns an effort whose value at the joint's velocity is within a limit.

    While the effort is limited, it is constant, so that a joint under load reaches the velocity at
    which the commanded effort is within the limit. If the joint is so light that it would reach
    this velocity within one control period, the damping remains: a constant effort would exceed the
    velocity, and the next effort would return the joint beyond it.

    Args:
        command: The commanded effort.
        limit: Maximum effort, N m or N.
        velocity: Velocity of the joint, rad/s or m/s.
        gain: Change of the velocity in one control period, for an effort of 1 N m or 1 N.
    """
    effort, damping = command
    output = effort - damping * velocity
    clamped = clamp(output, -limit, limit)
    over = output != clamped
    if not anywhere(over):
        return command
    light = clamp(effort - damping * (velocity + gain * clamped), -limit, limit) != clamped
    return DampedEffort(
        where(over, where(light, _INSIDE * clamped + damping * velocity, clamped), effort),
        where(over, where(light, damping, 0.0), damping),
    )


def cut_range(limits: JointLimits, held: tuple[float, float]) -> tuple[float, float]:
    """Returns the lowest and highest position without reduced efforts, rad or m.

    Beyond a limit of its controllers, a joint has only efforts that move it back. A limit of the
    joint itself holds the joint: in Gazebo, a joint that an effort pushes against it rests there.
    If efforts were reduced beyond it, the joint would leave this limit, which is slightly soft, and
    return, for ever.

    Args:
        limits: The limits of the controllers.
        held: The limits of the joint itself, rad or m.
    """
    lower = limits.lower if limits.lower > held[0] else -math.inf
    upper = limits.upper if limits.upper < held[1] else math.inf
    return lower, upper


def limited_effort(
    limits: JointLimits,
    command: DampedEffort,
    position: Number,
    velocity: Number,
    gain: Number = 0.0,
    *,
    held: tuple[float, float] = _ENDLESS,
) -> DampedEffort:
    """Returns an effort within the limits.

    Args:
        limits: The limits.
        command: The commanded effort.
        position: Position of the joint, rad or m.
        velocity: Velocity of the joint, rad/s or m/s.
        gain: Change of the velocity per effort in one control period; see `saturated`.
        held: Range of positions in which the joint's own limits hold it, rad or m; see `cut_range`.
    """
    effort, damping = saturated(command, limits.effort, velocity, gain)
    if limits.soft is not None:
        # Acts as a damper toward the bound, which the physics integrates implicitly.
        gain, output = limits.soft.k_velocity, effort - damping * velocity
        slowest, fastest = velocity_bounds(limits, position)
        slow = output < gain * (slowest - velocity)
        fast = output > gain * (fastest - velocity)
        effort = where(slow, gain * slowest, where(fast, gain * fastest, effort))
        damping = where(slow | fast, gain, damping)
    # Beyond a limit, only efforts that move the joint back are applied.
    lower, upper = cut_range(limits, held)
    below = (position < lower) | (velocity < -limits.velocity)
    above = (position > upper) | (velocity > limits.velocity)
    outside = below | above
    if outside is not False and anywhere(outside):
        output = effort - damping * velocity
        farther = (above & (output > 0.0)) | (below & (output < 0.0))
        effort, damping = where(farther, 0.0, effort), where(farther, 0.0, damping)
    # Most commands are within the limits, and a new object takes as long as the comparisons above.
    unchanged = effort is command.effort and damping is command.damping
    return command if unchanged else DampedEffort(effort, damping)
