"""SDF's ``<joint>`` in a ``<world>``: connects models to the world or to each other."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from cartwheel.codes import tags
from cartwheel.description.elements.xml import Node
from cartwheel.description.losses import loss
from cartwheel.description.model import Joint, RobotDescription
from cartwheel.description.sdf.context import Context, not_simulated
from cartwheel.description.sdf.frames import WORLD, Frames
from cartwheel.description.sdf.joint import add_joint, read_joint
from cartwheel.errors import DescriptionError

_BETWEEN = ("fixed", "revolute", "continuous", "ball")
"""Joint types that can connect two models."""


def join_models(
    node: Node, models: Sequence[RobotDescription], frames: Frames, ctx: Context
) -> tuple[list[RobotDescription], tuple[Joint, ...]]:
    """The models with their joints to the world, and joints between models.

    Args:
        node: The ``<world>``.
        models: The models in the world.
        frames: The world's frames, complete except for joints.
        ctx: Receives the diagnostics.

    Raises:
        DescriptionError: A joint is invalid.
    """
    found = {model.name: model for model in models}
    between: list[Joint] = []
    nodes = node.all("joint")
    later = [each.attributes.get("name", "") for each in nodes]
    for each in nodes:
        joint = _read(each, frames, later, ctx)
        if joint is None:
            continue
        child, link = _owner(joint.child, found)
        parent, other = _owner(joint.parent, found)
        if child is None or (parent is None and joint.parent != WORLD):
            _leave_out(each, "one of its models does not exist", ctx)
            continue
        if parent is not None and parent.static:
            parent, other = None, WORLD
        if child.static and parent is not None and joint.type == "fixed":
            child, link, parent, other = parent, other, None, WORLD
        if parent is None or parent is child:
            own = replace(joint, parent=other if parent is child else WORLD, child=link)
            if child.joint(own.name) is not None:
                raise each.fail(
                    f'model "{child.name}" already has a joint "{own.name}"',
                    code=tags.NAME_TAKEN,
                    values={"name": own.name},
                )
            found[child.name] = replace(child, joints=(*child.joints, own))
        elif joint.type not in _BETWEEN:
            _leave_out(each, f"a {each.attributes['type']} joint cannot connect two models", ctx)
        else:
            if joint.type != "fixed" and joint.resists:
                ctx.warn(
                    tags.NOT_SIMULATED,
                    f'the limits, damping, friction and spring of joint "{joint.name}" are not '
                    "simulated because the joint connects two models",
                    origin=each.origin,
                    severity="warning",
                    values={"joint": joint.name},
                )
            between.append(joint)
    return list(found.values()), tuple(between)


def _read(node: Node, frames: Frames, later: list[str], ctx: Context) -> Joint | None:
    """A joint; None if it connects something that was skipped, which is reported."""
    try:
        frame = add_joint(frames, node, ctx, later)
        joint = read_joint(node, ctx, frames, frame)
    except DescriptionError as error:
        if not any(each.severity == "error" for each in ctx.diagnostics):
            raise
        node.mark()
        ctx.report(loss(error, "the joint is ignored", of="joint", origin=node.origin))
        return None
    for sensor in node.all("sensor"):
        sensor.mark()
        ctx.report(not_simulated("sensors on joints of the world are ignored", sensor))
    if joint is None:
        _leave_out(node, "a gearbox connects joints of one model", ctx)
    return joint


def _owner(scoped: str, models: dict[str, RobotDescription]) -> tuple[RobotDescription | None, str]:
    """The model of a link's scoped name, and the link's name in the model."""
    for name, model in models.items():
        link = scoped.removeprefix(f"{name}::")
        if link != scoped and model.link(link) is not None:
            return model, link
    return None, WORLD


def _leave_out(node: Node, why: str, ctx: Context) -> None:
    node.mark()
    name = node.attributes.get("name", "")
    ctx.warn(
        tags.ELEMENT_LEFT_OUT,
        f'joint "{name}" is ignored: {why}',
        origin=node.origin,
        severity="error",
        values={"tag": "joint", "name": name, "left_out": "joint"},
    )
