"""Formulas of robots with steered wheels.

A *middle wheel* is an imaginary wheel midway between the wheels of an axle. Angles are positive to
the left. All functions accept floats and arrays; see `cartwheel.devices.elementwise`.
"""

from __future__ import annotations

import math

from cartwheel.devices.elementwise import Number, atan, atan2, copysign, cos, sin, tan, where

_SIDEWAYS = 1e-6
"""Cosine of a steering angle below which both driven wheels have the same speed."""


def angle_of_turn(speed: Number, turn: Number, base: Number) -> Number:
    """Returns the steering angle of the middle wheel in rad.

    Args:
        speed: Velocity of the unsteered axle, m/s. At 0, the angle is 0.
        turn: Yaw rate, rad/s.
        base: Distance between the axles, m.
    """
    angle = atan2(turn * base, abs(speed))
    return where(speed == 0, 0.0, copysign(angle, turn * speed))


def angle_of_turn_in_place(speed: Number, turn: Number, base: Number) -> Number:
    """Returns the steering angle of the middle wheel in rad, which is ±90° at standstill.

    Args:
        speed: Velocity of the unsteered axle, m/s.
        turn: Yaw rate, rad/s.
        base: Distance between the axles, m.
    """
    stands = speed == 0
    in_place = where(turn == 0, 0.0, copysign(math.pi / 2, turn))
    return where(stands, in_place, atan(turn * base / where(stands, 1.0, speed)))


def wheel_angles(middle: Number, base: Number, track: Number) -> tuple[Number, Number]:
    """Returns the angles of the left and right steered wheels in rad, by Ackermann geometry.

    The axes of all four wheels intersect at the centre of the turn.

    Args:
        middle: Angle of the middle wheel, rad.
        base: Distance between the axles, m.
        track: Distance between the steered wheels, m.
    """
    tangent = tan(middle)
    half = track / 2 / base * tangent
    return atan2(tangent, 1 - half), atan2(tangent, 1 + half)


def wheel_angles_in_place(middle: Number, base: Number, track: Number) -> tuple[Number, Number]:
    """Returns the same angles as `wheel_angles`, rounded differently.

    This formula does not need the tangent, which is very large at ±90°.
    """
    sine, cosine, half = sin(middle), cos(middle), track / 2
    return (
        atan2(base * sine, base * cosine - half * sine),
        atan2(base * sine, base * cosine + half * sine),
    )


def middle_angle(angle: Number, base: Number, track: Number, side: int) -> Number:
    """Returns the angle of the middle wheel in rad from that of a steered wheel.

    Args:
        angle: Angle of the steered wheel, rad.
        base: Distance between the axles, m.
        track: Distance between the steered wheels, m.
        side: -1: the left wheel; 1: the right wheel; 0: the only wheel.
    """
    tangent = tan(angle)
    return atan(tangent * base / (base - side * tangent * track / 2))


def rim_factors(middle: Number, base: Number, track: Number) -> tuple[Number, Number]:
    """Returns the speeds of the left and right unsteered wheel, relative to the middle wheel.

    Args:
        middle: Steering angle of the middle wheel of the other axle, rad.
        base: Distance between the axles, m.
        track: Distance between the unsteered wheels, m.
    """
    half = track / 2 / base * tan(middle)
    return 1 - half, 1 + half


def rim_factors_in_place(middle: Number, base: Number, track: Number) -> tuple[Number, Number]:
    """Returns the same factors as `rim_factors`, rounded differently, and 1 at ±90°."""
    half = where(abs(cos(middle)) < _SIDEWAYS, 0.0, track / 2 * tan(middle) / base)
    return 1 - half, 1 + half


def axle_speed(forward: Number, turn: Number, base: Number, radius: Number) -> Number:
    """Returns the speed in rad/s of a wheel in the middle of the unsteered axle.

    Args:
        forward: Velocity of the axle, m/s. At 0, the speed is that of a steered wheel at ±90°.
        turn: Yaw rate, rad/s.
        base: Distance between the axles, m.
        radius: Radius of the wheel, m.
    """
    in_place = (forward == 0) & (turn != 0)
    return where(in_place, abs(turn) * base / radius, forward / radius)


def driven_wheel_speed(
    speed: Number, turn: Number, angle: Number, base: Number, radius: Number
) -> Number:
    """Returns the speed in rad/s of a wheel that is both driven and steered.

    Args:
        speed: Velocity of the unsteered axle, m/s. At 0, the wheel turns the robot in place.
        turn: Yaw rate, rad/s.
        angle: Steering angle of the wheel, rad.
        base: Distance between the wheel and the unsteered axle, m.
        radius: Radius of the wheel, m.
    """
    return where(speed == 0, abs(turn) * base / radius, speed / (radius * cos(angle)))


def driven_wheel_motion(distance: Number, angle: Number, base: Number) -> tuple[Number, Number]:
    """Returns the distance of the unsteered axle in m and the rotation of the robot in rad.

    Args:
        distance: Distance that the driven and steered wheel rolled, m.
        angle: Steering angle of the wheel, rad.
        base: Distance between the wheel and the unsteered axle, m.
    """
    return distance * cos(angle), distance * sin(angle) / base


def alignment(error: Number) -> Number:
    """Returns the factor by which a driven wheel slows down until it is steered.

    Args:
        error: Difference between the wanted and the current steering angle, rad.
    """
    size = abs(error)
    return where(size < math.pi / 6, 1.0, where(size > math.pi / 2, 0.01, cos(size)))
