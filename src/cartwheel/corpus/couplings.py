"""Joints that follow other joints, so that their positions cannot be commanded independently."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence

from cartwheel.api import Model, World
from cartwheel.description.model import Joint
from cartwheel.simulation.models.couplings import Coupling, couplings


def couplings_of(world: World, model: Model) -> list[Coupling]:
    """The active couplings between joints of a model."""
    simulation = world.session.simulation
    names = {
        simulation.engine.joint_id(model.name, name): name
        for owner, name in simulation.scene.joints
        if owner == model.name
    }
    return couplings(simulation.model, simulation.data, names)


def consistent(
    target: tuple[str, float], targets: Mapping[str, float], coupled: Sequence[Coupling]
) -> dict[str, float]:
    """The targets of a joint and of all commanded joints that are coupled with it.

    Args:
        target: The joint and its position, rad or m.
        targets: The joints that are commanded.
        coupled: All couplings of the model.
    """
    found = dict([target])
    waiting = [target[0]]
    while waiting:
        one = waiting.pop()
        for other, position in _coupled_with(one, found[one], coupled):
            if other not in found:
                found[other] = position
                waiting.append(other)
    return {name: position for name, position in found.items() if name in targets}


def slopes(
    joint: str, commanded: Mapping[str, float], coupled: Sequence[Coupling]
) -> dict[str, float]:
    """How far a joint moves for each rad or m of itself and of the joints coupled with it.

    `commanded` contains the joints that count.
    """
    at_zero, at_one = (consistent((joint, at), commanded, coupled) for at in (0.0, 1.0))
    return {
        name: 1.0 / abs(at_one[name] - start)
        for name, start in at_zero.items()
        if at_one[name] != start
    }


def within(joint: Joint, position: float) -> bool:
    """Whether a position is within a joint's limits."""
    if joint.type == "continuous":
        return True
    lower, upper = joint.axis.lower, joint.axis.upper
    return (lower is None or position >= lower) and (upper is None or position <= upper)


def _coupled_with(
    joint: str, position: float, coupled: Sequence[Coupling]
) -> Iterator[tuple[str, float]]:
    for each in coupled:
        if each.leader == joint:
            yield each.follower, each.ratio * position + each.offset
        elif each.follower == joint and each.ratio:
            yield each.leader, (position - each.offset) / each.ratio
