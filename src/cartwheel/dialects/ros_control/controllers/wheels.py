"""Shared parts of wheeled drives: dimensions and axes from the robot description, and frames."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from cartwheel.codes import robot
from cartwheel.description.kinematics import link_poses
from cartwheel.description.model import Cylinder, RobotDescription, Sphere
from cartwheel.dialects.ros_control.controller import Controller
from cartwheel.dialects.ros_control.controllers.odometry import OdometryParameters
from cartwheel.dialects.ros_control.parameters import ros2_parameter
from cartwheel.geometry import Array, matrix_from_quat

LEFT, RIGHT, UP = (0.0, 1.0, 0.0), (0.0, -1.0, 0.0), (0.0, 0.0, 1.0)
"""Rotation axes of wheels, of reversed wheels and of steering joints, in the robot's base frame."""
_BEHIND = 1e-3
"""Distance of a steered wheel behind the driven axle, m."""
_ALONG = 0.5
"""Cosine between the axis of a wheel and the expected one, above which it points along it."""
_SIDEWAYS = 0.2
"""Ratio of the distances of two wheels along y and x below which a robot faces along y."""


def joint_place(description: RobotDescription, joint: str) -> tuple[float, float, float]:
    """Returns the position of a joint's child link in the robot in m, at zero joint positions."""
    described = description.joint(joint)
    assert described is not None
    poses = link_poses(description, {})
    front = poses[description.canonical_link].inverse()
    return (front @ poses[described.child]).position


def leftward(description: RobotDescription, left: str, right: str) -> tuple[float, float, float]:
    """Returns the axis of wheels that roll forward, by the places of a left and a right joint.

    It is along y, except in a robot that faces along its own y axis.
    """
    one, other = joint_place(description, left), joint_place(description, right)
    across, along = one[1] - other[1], one[0] - other[0]
    if abs(across) >= _SIDEWAYS * abs(along):
        return LEFT
    return (1.0, 0.0, 0.0) if along > 0 else (-1.0, 0.0, 0.0)


def faces_backward(
    description: RobotDescription, left: Sequence[str], right: Sequence[str]
) -> bool:
    """Whether a robot faces along negative x: its wheels are on the other sides, and all axes point
    to the right.

    Such a robot drives in its own forward direction and turns as commanded.

    Args:
        description: The robot.
        left: Joints of the left wheels.
        right: As many joints of the right wheels.
    """
    return all(
        leftward(description, one, other) == LEFT
        and joint_place(description, one)[1] < joint_place(description, other)[1]
        and max(float(joint_axis(description, each)[1]) for each in (one, other)) < -_ALONG
        for one, other in zip(left, right, strict=True)
    )


def check_axes(controller: Controller, wanted: Mapping[str, tuple[float, float, float]]) -> None:
    """Warns about wheels whose axes are opposite to those that the drive expects.

    Args:
        controller: The drive.
        wanted: Expected axes of all driven joints, by name, in the robot's base frame.
    """
    opposite = [name for name, axis in wanted.items() if _is_opposite(controller, name, axis)]
    for name in opposite:
        _report_axis(controller, name, wanted[name], every=len(opposite) == len(wanted))


def check_axis(controller: Controller, joint: str, wanted: tuple[float, float, float]) -> None:
    """Warns about a joint whose axis is opposite to the one that the drive expects.

    Args:
        controller: The drive.
        joint: Joint of a wheel, or a steering joint.
        wanted: Expected axis, in the robot's base frame.
    """
    if _is_opposite(controller, joint, wanted):
        _report_axis(controller, joint, wanted)


def _is_opposite(controller: Controller, joint: str, wanted: tuple[float, float, float]) -> bool:
    return float(joint_axis(controller.part.description, joint) @ np.array(wanted)) < -_ALONG


def _report_axis(
    controller: Controller, joint: str, wanted: tuple[float, float, float], *, every: bool = False
) -> None:
    """Reports a joint with an opposite axis; `every` is whether those of all wheels are."""
    described = controller.part.description.joint(joint)
    assert described is not None
    index = max(range(3), key=lambda each: abs(wanted[each]))
    sign, name = "-" if wanted[index] > 0 else "", "xyz"[index]
    controller.warn(
        robot.WHEEL_AXIS_MISALIGNED,
        f'the axis of joint "{joint}" points along the robot\'s {sign}{name} axis, so '
        "positive commands turn the wheel in the opposite direction",
        at=described.origin,
        values={"joint": joint, "axis": f"{sign}{name}", "all": every},
    )


def check_steering(controller: Controller, joint: str, driven: str, *, backward: bool) -> None:
    """Warns about a steering joint whose axis turns the wheels to the wrong side.

    A wheel behind the driven axle must turn to the right for a turn to the left.

    Args:
        controller: The drive.
        joint: The steering joint.
        driven: Joint of a driven wheel.
        backward: Whether the robot faces along negative x.
    """
    description = controller.part.description
    described = description.joint(joint)
    assert described is not None
    before = joint_place(description, joint)[0] - joint_place(description, driven)[0]
    behind = (before if backward else -before) > _BEHIND
    up = float(joint_axis(description, joint)[2]) * (-1.0 if behind else 1.0)
    if up < -0.5:
        points = "up, and the joint is behind the driven axle" if behind else "down"
        controller.warn(
            robot.STEERING_REVERSED,
            f'the axis of the steering joint "{joint}" points {points}, so the robot steers to the '
            "wrong side",
            at=described.origin,
            values={"joint": joint},
        )


def joint_axis(description: RobotDescription, joint: str) -> Array:
    """Returns the axis of a joint in the robot's base frame, shape (3,), at zero positions."""
    described = description.joint(joint)
    assert described is not None
    poses = link_poses(description, {})
    front = poses[description.canonical_link].inverse()
    turn = matrix_from_quat((front @ poses[described.child]).orientation)
    axis: Array = turn @ np.array(described.axis.xyz)
    return axis


def wheel_radius(description: RobotDescription, joint: str) -> float | None:
    """Returns the radius of a joint's wheel in m: its cylinder's or sphere's, or None."""
    described = description.joint(joint)
    link = description.link(described.child) if described is not None else None
    if link is None:
        return None
    shapes = [part.shape for part in link.collisions] + [part.shape for part in link.visuals]
    for shape in shapes:
        if isinstance(shape, Cylinder | Sphere):
            return shape.radius
    return None


@dataclass(frozen=True, kw_only=True, slots=True)
class FramePrefixParameters(OdometryParameters):
    """The parameters of drives whose frames have a prefix in ROS 2."""

    has_prefix: bool = ros2_parameter(
        "tf_frame_prefix_enable",
        default=True,
        doc="Add a prefix to the frames.",
    )
    prefix: str = ros2_parameter(
        "tf_frame_prefix",
        default="",
        doc="Prefix of the frames; if empty, the namespace of the controller manager.",
    )


def frame_prefix(controller: Controller, given: FramePrefixParameters) -> str:
    """Returns the prefix of a ROS 2 drive's frames: ``tf_frame_prefix``, or the namespace."""
    space = (given.prefix or controller.robot.namespace).strip("/")
    return f"{space}/" if controller.robot.ros2 and given.has_prefix and space else ""
