"""Couples the joints that mimic others."""

from __future__ import annotations

from collections.abc import Mapping

import mujoco

from cartwheel.description.mimicking import targets
from cartwheel.description.model import Joint, Mimic, RobotDescription
from cartwheel.world import joints
from cartwheel.world.entry import ModelEntry, scoped

CLAMPED = slice(5, 8)
"""Elements in the data of a coupling, which the engine does not read: not 0 if the target of the
follower is limited, and negative while the leader comes first; the offset and the ratio."""
_SLACK = 1e-6
"""rad or m by which the target may be outside the limits of a follower."""


def add_mimics(spec: mujoco.MjSpec, entry: ModelEntry) -> None:
    """Couples the joints of a model that mimic others.

    The coupling is an equality constraint, which acts on both joints. A follower whose leader may
    leave the follower's limits is marked: `Followers` limits its target, so that it does not hold
    its leader back.

    Args:
        spec: Contains the model's bodies.
        entry: The model.
    """
    if entry.description.static:
        return
    limited = limited_followers(entry, entry.description)
    for joint in entry.description.joints:
        mimic = mimic_of(entry, joint)
        if mimic is None or joint.type == "fixed":
            continue
        joints.couple(
            spec,
            scoped(entry.name, joint.name, "mimic"),
            scoped(entry.name, joint.name),
            scoped(entry.name, mimic.joint),
            ratio=mimic.multiplier,
            offset=mimic.offset,
            clamped=joint.name in limited,
        )


def mimic_of(entry: ModelEntry, joint: Joint) -> Mimic | None:
    """What a joint follows: a plugin overrules the description."""
    return entry.mimics.get(joint.name, joint.mimic)


def limited_followers(entry: ModelEntry, description: RobotDescription) -> frozenset[str]:
    """The joints whose leaders can have positions that the joints' own limits exclude.

    Args:
        entry: The model.
        description: Its description, now or before.
    """
    named = {joint.name: joint for joint in description.joints}
    return frozenset(joint.name for joint in description.joints if _leaves(entry, named, joint))


def _leaves(entry: ModelEntry, named: Mapping[str, Joint], joint: Joint) -> bool:
    mimic = mimic_of(entry, joint)
    if mimic is None or mimic.mutual:
        return False
    bounds = joints.limits_of(joint, joint.axis, follows=joint.name in entry.mimics)
    if bounds is None:
        return False
    low, high = targets(mimic, named, lambda other: mimic_of(entry, other))
    return low < bounds[0] - _SLACK or high > bounds[1] + _SLACK
