"""Joints whose axis has length 0, which gz-sim does not load."""

from __future__ import annotations

from cartwheel.codes import robot
from cartwheel.description.elements.xml import Node
from cartwheel.description.sdf.context import Context


def accept_zero_axis(node: Node, joint: str, said: str, ctx: Context) -> None:
    """Warns about an axis of length 0, for which the x axis of the world is used.

    urdfdom and sdformat 9 pass such an axis on, and ODE's ``dJointSetHingeAxis`` normalises it in
    the frame of the world to 1 0 0. sdformat 10 and later refuse it: all versions of gz-sim since
    Dome.

    The value ``refused_by`` of the warning is ``gz``.

    Args:
        node: The ``<axis>``.
        joint: The name of the joint.
        said: What is wrong, as a sentence without a full stop.
        ctx: Receives the warning.

    Raises:
        DescriptionError: The description is for gz-sim.
    """
    if ctx.simulator == "gz":
        raise node.fail(said, code=robot.AXIS_ZERO, values={"joint": joint})
    ctx.warn(
        robot.AXIS_ZERO,
        f"{said}, for which Gazebo Classic uses the x axis of the world; gz-sim does not load such "
        "a robot",
        origin=node.origin,
        severity="warning",
        values={"joint": joint, "refused_by": "gz"},
    )
