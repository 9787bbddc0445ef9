"""The largest effort that gravity demands of each joint."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from cartwheel.description.model import Joint, RobotDescription
from cartwheel.geometry import Pose, matrix_from_quat, rotate

Array = NDArray[np.float64]

_GRAVITY = 9.8
"""m/s²."""
_POSES = 500
"""Number of sampled poses. For six joints they miss a few per cent of the maximum."""
_TURNS = ("revolute", "continuous")


def gravity_efforts(description: RobotDescription) -> dict[str, float]:
    """Returns the largest effort that gravity demands of each movable joint, N m or N.

    The robot stands upright. The maximum is taken over its zero pose and random poses within the
    joint limits, which are the same in every run.
    """
    links = {link.name: link for link in description.links}
    inbound: dict[str, Joint] = {}
    for joint in description.joints:
        inbound.setdefault(joint.child, joint)
    order = _from_the_root(links, inbound)
    drawn = _draw(description)
    frames: dict[str, tuple[Array, Array]] = {"": (np.eye(3)[None], np.zeros((1, 3)))}
    """Orientations and positions of the links in all poses."""
    pivots: dict[str, tuple[Array, Array]] = {}
    for name in order:
        hung = inbound.get(name)
        parent = hung.parent if hung is not None else ""
        base = links[parent].pose if parent in links else Pose()
        frame = base.inverse() @ links[name].pose
        turn, place = frames.get(parent, frames[""])
        place = place + turn @ np.array(frame.position)
        turn = turn @ matrix_from_quat(frame.orientation)
        if hung is not None and hung.name in drawn:
            own = np.array(rotate(hung.pose.orientation, hung.axis.xyz))
            axis, offset = turn @ own, np.array(hung.pose.position)
            pivot = place + turn @ offset
            pivots[name] = axis, pivot
            value = drawn[hung.name]
            if hung.type == "prismatic":
                place = place + axis * value[:, None]
            else:
                turn = turn @ _turns(own, value)
                place = pivot - turn @ offset
        frames[name] = turn, place
    return _efforts(description, order, inbound, frames, pivots)


def _efforts(
    description: RobotDescription,
    order: list[str],
    inbound: Mapping[str, Joint],
    frames: Mapping[str, tuple[Array, Array]],
    pivots: Mapping[str, tuple[Array, Array]],
) -> dict[str, float]:
    """Returns the largest efforts from the link frames in all poses."""
    mass = dict.fromkeys(order, 0.0)
    moment: dict[str, Any] = dict.fromkeys(order, 0.0)
    for link in description.links:
        if link.inertial is not None and link.gravity:
            turn, place = frames[link.name]
            centre = place + turn @ np.array(link.inertial.pose.position)
            mass[link.name] = link.inertial.mass
            moment[link.name] = link.inertial.mass * centre
    efforts: dict[str, float] = {}
    for name in reversed(order):
        joint = inbound.get(name)
        if joint is None:
            continue
        if name in pivots:
            axis, pivot = pivots[name]
            if joint.type == "prismatic":
                effort = mass[name] * np.abs(axis[:, 2])
            else:
                arm = moment[name] - mass[name] * pivot
                effort = np.abs(axis[:, 1] * arm[:, 0] - axis[:, 0] * arm[:, 1])
            efforts[joint.name] = _GRAVITY * float(effort.max())
        if joint.parent in mass:
            mass[joint.parent] += mass[name]
            moment[joint.parent] = moment[joint.parent] + moment[name]
    return efforts


def _from_the_root(links: Mapping[str, Any], inbound: Mapping[str, Joint]) -> list[str]:
    """Returns the names of all links; each follows its parent."""
    children: dict[str, list[str]] = {}
    for name in links:
        parent = inbound[name].parent if name in inbound else ""
        children.setdefault(parent if parent in links else "", []).append(name)
    order = list(children.get("", ()))
    for name in order:  # the list grows meanwhile
        order += children.get(name, ())
    return order


def _draw(description: RobotDescription) -> dict[str, Array]:
    """Returns the sampled positions of all movable joints; the first is the one nearest 0."""
    generator = np.random.default_rng(0)
    drawn: dict[str, Array] = {}
    for joint in description.joints:
        if joint.type not in (*_TURNS, "prismatic"):
            continue
        widest = math.pi if joint.type in _TURNS else 0.0
        low, high = (
            each if each is not None and math.isfinite(each) else end
            for each, end in ((joint.axis.lower, -widest), (joint.axis.upper, widest))
        )
        low, high = min(low, high), max(low, high)
        drawn[joint.name] = generator.uniform(low, high, _POSES)
        drawn[joint.name][0] = min(max(0.0, low), high)
    for joint in description.joints:
        if joint.mimic is not None and joint.mimic.joint in drawn and joint.name in drawn:
            led = joint.mimic.multiplier * drawn[joint.mimic.joint] + joint.mimic.offset
            drawn[joint.name] = led
    return drawn


def _turns(axis: Array, angles: Array) -> Array:
    """Rotations about one axis, shape (n, 3, 3)."""
    x, y, z = axis / np.linalg.norm(axis)
    cross = np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
    sine, cosine = np.sin(angles)[:, None, None], np.cos(angles)[:, None, None]
    turned: Array = np.eye(3) + sine * cross + (1.0 - cosine) * (cross @ cross)
    return turned
