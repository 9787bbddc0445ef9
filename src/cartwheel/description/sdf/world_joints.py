"""SDF's ``<joint>`` in a ``<world>``: models that hang on the world or on each other."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from cartwheel.description.model import Joint, RobotDescription
from cartwheel.description.sdf.context import Context
from cartwheel.description.sdf.frames import WORLD, Frames
from cartwheel.description.sdf.joint import add_joint, read_joint
from cartwheel.description.xml import Node
from cartwheel.errors import DescriptionError

_BETWEEN = ("fixed", "revolute", "continuous", "ball")
"""Types that hold two models together."""


def join_models(
    node: Node, models: Sequence[RobotDescription], frames: Frames, ctx: Context
) -> tuple[list[RobotDescription], tuple[Joint, ...]]:
    """The models with the joints by which they hang on the world, and joints between models.

    Args:
        node: The ``<world>``.
        models: Those that stand in it.
        frames: The world's, complete but for joints.
        ctx: Takes the diagnostics.

    Raises:
        DescriptionError: a joint that makes no sense, with its place.
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
            _leave_out(each, "one of its models is not there", ctx)
            continue
        if parent is not None and parent.static:
            parent, other = None, WORLD
        if child.static and parent is not None and joint.type == "fixed":
            child, link, parent, other = parent, other, None, WORLD
        if parent is None or parent is child:
            own = replace(joint, parent=other if parent is child else WORLD, child=link)
            if child.joint(own.name) is not None:
                raise each.fail(f'model "{child.name}" has a joint "{own.name}" already')
            found[child.name] = replace(child, joints=(*child.joints, own))
        elif joint.type not in _BETWEEN:
            _leave_out(each, f"a {each.attributes['type']} joint cannot hold two models", ctx)
        else:
            if joint.type != "fixed" and joint.resists:
                ctx.tell(
                    "warning",
                    f'joint "{joint.name}" holds two models together, but turns freely: its '
                    "limits, damping, friction and spring have no effect",
                    each.origin,
                )
            between.append(joint)
    return list(found.values()), tuple(between)


def _read(node: Node, frames: Frames, later: list[str], ctx: Context) -> Joint | None:
    """A joint; None where it joins what could not be found, which is told."""
    try:
        frame = add_joint(frames, node, ctx, later)
        joint = read_joint(node, ctx, frames, frame)
    except DescriptionError as error:
        if not any(told.severity == "error" for told in ctx.diagnostics):
            raise
        _leave_out(node, error.message, ctx)
        return None
    for sensor in node.all("sensor"):
        sensor.mark()
        ctx.tell("warning", "a sensor of a joint of the world is left out", sensor.origin)
    if joint is None:
        _leave_out(node, "a gearbox gears joints of one model", ctx)
    return joint


def _owner(scoped: str, models: dict[str, RobotDescription]) -> tuple[RobotDescription | None, str]:
    """The model of a link's scoped name, and what it calls the link."""
    for name, model in models.items():
        link = scoped.removeprefix(f"{name}::")
        if link != scoped and model.link(link) is not None:
            return model, link
    return None, WORLD


def _leave_out(node: Node, why: str, ctx: Context) -> None:
    node.mark()
    name = node.attributes.get("name", "")
    ctx.tell("error", f'joint "{name}" is left out: {why}', node.origin)
