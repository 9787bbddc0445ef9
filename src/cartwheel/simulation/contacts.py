"""Contacts with their forces, as the last forward pass found them."""

from __future__ import annotations

import itertools
from collections.abc import Collection
from typing import Any

import mujoco
import numpy as np

from cartwheel.simulation.snapshot import Contact
from cartwheel.world.entry import collision_of, part_name

_GEOM = mujoco.mjtObj.mjOBJ_GEOM


def read_contacts(model: Any, data: Any, names: Collection[str]) -> list[Contact]:
    """The contacts of the named geoms; each has the named one as its `first`.

    A contact between two named geoms comes once for each of them.
    """
    wanted = {}
    for name in names:
        for number in itertools.count():
            index = mujoco.mj_name2id(model, _GEOM, part_name(name, number))
            if index < 0:
                break
            wanted[index] = name
    if not wanted or data.ncon == 0:
        return []
    found = []
    pairs = data.contact.geom
    for index in range(data.ncon):
        one, two = int(pairs[index, 0]), int(pairs[index, 1])
        if one not in wanted and two not in wanted:
            continue
        contact = data.contact[index]
        if contact.efc_address < 0:
            # Within the margin but without force.
            continue
        six = np.zeros(6)
        mujoco.mj_contactForce(model, data, index, six)
        # Rows of the frame are the normal and two tangents; the normal points from one to
        # two, and the force is what one exerts on two.
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
                        + np.cross(position - data.xipos[model.geom_bodyid[first]], sign * force),
                    )
                )
    return found
