"""Formulas that relate the motion of a robot in the plane to the rotation of its wheels.

All functions accept floats and arrays; see `cartwheel.devices.elementwise`.
"""

from __future__ import annotations

import math

from cartwheel.devices.elementwise import Number, cos, sin, where

PlanarPose = tuple[Number, Number, Number]
"""x and y in m, yaw in rad."""
_STRAIGHT = 1e-9
"""Rotation in rad below which an arc is a straight line."""


def rim_speeds(forward: Number, turn: Number, separation: Number) -> tuple[Number, Number]:
    """Returns the rim speeds in m/s of the left and right wheel on one axle.

    Args:
        forward: Velocity of the middle of the axle, m/s.
        turn: Yaw rate, rad/s.
        separation: Distance between the wheels, m.
    """
    half = turn * separation / 2
    return forward - half, forward + half


def axle_motion(left: Number, right: Number, separation: Number) -> tuple[Number, Number]:
    """Returns the motion of an axle's middle: the distance in m and the rotation in rad.

    Args:
        left: Distance that the left wheel rolled, m.
        right: Distance that the right wheel rolled, m.
        separation: Distance between the wheels, m.
    """
    return (left + right) / 2, (right - left) / separation


def along_arc(
    pose: PlanarPose, forward: Number, turn: Number, sideways: Number = 0.0
) -> PlanarPose:
    """Returns the pose after a motion at constant velocities.

    Args:
        pose: Pose before the motion.
        forward: Length of the motion along the robot's x axis, m.
        turn: Rotation during the motion, rad.
        sideways: Length of the motion along the robot's y axis, m.
    """
    x, y, heading = pose
    half = turn / 2
    middle = heading + half
    # The chord of an arc is shorter than the arc by this factor.
    if half.__class__ is float:
        # Without the calls that distinguish floats from arrays.
        chord = 1.0 if -_STRAIGHT <= turn <= _STRAIGHT else math.sin(half) / half
        c, s = math.cos(middle), math.sin(middle)
    else:
        straight = abs(turn) <= _STRAIGHT
        half = where(straight, 1.0, half)
        chord = where(straight, 1.0, sin(half) / half)
        c, s = cos(middle), sin(middle)
    return (
        x + chord * (forward * c - sideways * s),
        y + chord * (forward * s + sideways * c),
        heading + turn,
    )
