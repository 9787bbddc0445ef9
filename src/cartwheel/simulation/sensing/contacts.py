"""Contacts and their forces from the last forward pass."""

from __future__ import annotations

import itertools
from collections.abc import Collection, Mapping
from typing import Any

import mujoco
import numpy as np

from cartwheel.geometry import cross
from cartwheel.simulation.snapshot import Contact
from cartwheel.world.entry import collision_of, part_name

_GEOM = mujoco.mjtObj.mjOBJ_GEOM


def read_contacts(model: Any, data: Any, names: Collection[str]) -> list[Contact]:
    """Contacts of the named geoms; see `contacts_of`."""
    return contacts_of(model, data, geoms_of(model, names))


def geoms_of(model: Any, names: Collection[str]) -> dict[int, str]:
    """The names of geoms by index. A name may have several geoms."""
    wanted = {}
    for name in names:
        for number in itertools.count():
            index = mujoco.mj_name2id(model, _GEOM, part_name(name, number))
            if index < 0:
                break
            wanted[index] = name
    return wanted


def contacts_of(model: Any, data: Any, wanted: Mapping[int, str]) -> list[Contact]:
    """Contacts of geoms, with the wanted geom as `first`.

    A contact between two wanted geoms is returned once for each of them.

    Args:
        model: The MuJoCo model.
        data: Its data, after a forward pass.
        wanted: Names of geoms by index.
    """
    if not wanted or data.ncon == 0:
        return []
    found: list[Contact] = []
    pairs = data.contact.geom.tolist()
    if wanted.keys().isdisjoint(itertools.chain.from_iterable(pairs)):
        return found
    for index, (one, two) in enumerate(pairs):
        if one not in wanted and two not in wanted:
            continue
        contact = data.contact[index]
        if contact.efc_address < 0:
            # Within the margin, but without force.
            continue
        six = np.zeros(6)
        mujoco.mj_contactForce(model, data, index, six)
        # The rows of the frame are the normal and two tangents. The normal points from the first
        # geom to the second, and the force acts on the second.
        frame = contact.frame.reshape(3, 3)
        force, torque = frame.T @ six[:3], frame.T @ six[3:]
        position, normal, depth = contact.pos.copy(), frame[0].copy(), -float(contact.dist)
        for first, second, sign in ((one, two, -1.0), (two, one, 1.0)):
            if first in wanted:
                found.append(
                    Contact(
                        first=wanted[first],
                        second=collision_of(mujoco.mj_id2name(model, _GEOM, second) or ""),
                        position=position,
                        normal=sign * normal,
                        depth=depth,
                        force=sign * force,
                        torque=sign * torque
                        + cross(position - data.xipos[model.geom_bodyid[first]], sign * force),
                    )
                )
    return found
