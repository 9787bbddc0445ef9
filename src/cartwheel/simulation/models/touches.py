"""All contacts in the current state, for reading between steps."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import mujoco
import numpy as np

from cartwheel.geometry import Vec3
from cartwheel.simulation.engine import Engine
from cartwheel.world.entry import ModelEntry, collision_of, scoped

_GEOM = mujoco.mjtObj.mjOBJ_GEOM
_SLEEP = mujoco.mjtEnableBit.mjENBL_SLEEP.value


Place = tuple[str, str, str]
"""Names of a model, a link and a collision."""


@dataclass(frozen=True, kw_only=True, slots=True)
class Touch:
    """A contact between the collisions of two links at one point."""

    first: tuple[str, str, str]
    """Names of the model, the link and the collision."""
    second: tuple[str, str, str]
    point: Vec3
    """m, in the world."""
    normal: Vec3
    """Unit vector in the world, from the second link into the first."""
    depth: float
    """Penetration depth, m."""
    force: Vec3
    """Force on the first link, N, in world axes."""

    def turned(self) -> Touch:
        """The same contact with the links exchanged."""
        nx, ny, nz = self.normal
        fx, fy, fz = self.force
        return Touch(
            first=self.second,
            second=self.first,
            point=self.point,
            normal=(-nx, -ny, -nz),
            depth=self.depth,
            force=(-fx, -fy, -fz),
        )


class Touches:
    """Reads the contacts of an engine.

    A sleeping body has no contacts in the engine. If there are such bodies, the contacts are
    computed in a copy of the state, in which no body sleeps.

    Args:
        engine: The engine.
    """

    def __init__(self, engine: Engine) -> None:
        self._engine = engine
        self._model: Any = None
        self._names: list[tuple[str, str, str]] = []
        self._copy: Any = None
        """A copy of the data; None until it is first needed for a compiled model."""
        self._copied = b""
        """The state of the last forward pass of the copy."""

    def read(
        self,
        entries: Sequence[ModelEntry],
        counts: Callable[[Place, Place], bool] | None = None,
    ) -> list[Touch]:
        """The contacts with force in the current state.

        Args:
            entries: The models in the world.
            counts: Whether a contact of two collisions is returned; None returns all.
        """
        engine = self._engine
        if self._model is not engine.model:
            self._model, self._copy, self._copied = engine.model, None, b""
            self._names = collision_names(engine.model, entries)
        model, data = engine.model, self._data()
        if not data.ncon:
            return []
        contacts = data.contact
        active = np.flatnonzero(contacts.efc_address >= 0)
        if counts is not None:
            names, pairs = self._names, contacts.geom[active].tolist()
            meant = [counts(names[one], names[two]) for one, two in pairs]
            active = active[np.array(meant, dtype=bool)]
        if not active.size:
            return []
        # The rows of a frame are the normal and two tangents. The normal points from the first geom
        # to the second, and the force acts on the second.
        frames = contacts.frame[active].reshape(-1, 3, 3)
        local = np.zeros((len(active), 6))
        for index, wrench in zip(active.tolist(), local, strict=True):
            mujoco.mj_contactForce(model, data, index, wrench)
        forces = -np.einsum("ijk,ij->ik", frames, local[:, :3])
        columns = (contacts.pos[active], -frames[:, 0], -contacts.dist[active], forces)
        values = zip(*(each.tolist() for each in (contacts.geom[active], *columns)), strict=True)
        return [
            Touch(
                first=self._names[one],
                second=self._names[two],
                point=tuple(point),
                normal=tuple(normal),
                depth=depth,
                force=tuple(force),
            )
            for (one, two), point, normal, depth, force in values
        ]

    def _data(self) -> Any:
        """Data after a forward pass of the current state, in which no body sleeps."""
        engine = self._engine
        engine.refresh()
        model, data = engine.model, engine.data
        if not (data.tree_asleep >= 0).any():
            return data
        state = engine.signature()
        if state != self._copied:
            if self._copy is None:
                self._copy = mujoco.MjData(model)
            mujoco.mj_copyData(self._copy, model, data)
            model.opt.enableflags &= ~_SLEEP
            try:
                engine.forward(self._copy)
            finally:
                model.opt.enableflags |= _SLEEP
            self._copied = state
        return self._copy


def collision_names(model: Any, entries: Sequence[ModelEntry]) -> list[tuple[str, str, str]]:
    """Model, link and collision of each geom."""
    known = {
        scoped(entry.name, link.name, collision.name): (entry.name, link.name, collision.name)
        for entry in entries
        for link in entry.description.links
        for collision in link.collisions
    }
    names = (mujoco.mj_id2name(model, _GEOM, index) or "" for index in range(model.ngeom))
    return [known.get(collision_of(name), ("", "", name)) for name in names]
