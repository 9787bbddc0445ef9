"""Moves models that are fixed to the world at velocities."""

from __future__ import annotations

import math

import numpy as np

from cartwheel.simulation.dynamics.moved import Moved
from cartwheel.simulation.dynamics.separation import Separation
from cartwheel.simulation.engine import Engine
from cartwheel.simulation.models.in_place import InPlace
from cartwheel.simulation.models.placement import fixed_roots, put_fixed
from cartwheel.world.entry import ModelEntry, scoped
from cartwheel.world.motion import Motion


class Motions:
    """The models of a simulation that are fixed to the world and move.

    Args:
        engine: The engine.
        in_place: Computes the places of fixed links in its model.
        separation: Limits the speed of models that overlap others.
    """

    def __init__(self, engine: Engine, in_place: InPlace, separation: Separation) -> None:
        self._engine = engine
        self._separation = separation
        self._in_place = in_place
        self.moving: list[tuple[ModelEntry, Motion]] = []
        """The models that move."""

    def can_move(self, entry: ModelEntry) -> bool:
        """Whether a model that is fixed to the world can move: no joint depends on its links."""
        prefix = scoped(entry.name, "")
        for joint in self._engine.world.joints:
            if joint.parent.startswith(prefix) or joint.child.startswith(prefix):
                return False
        model = self._engine.model
        return not model.body_dofnum[
            np.isin(model.body_rootid, fixed_roots(self._engine, entry))
        ].any()

    def set(self, entry: ModelEntry, motion: Motion | None) -> None:
        """Moves a model from now on, or stops it."""
        if entry.motion != motion:
            entry.motion = motion
            self.gather()
            self._in_place.wake()

    def gather(self) -> None:
        """Continues with a newly compiled model, or with other motions."""
        engine = self._engine
        self.moving = [
            (entry, entry.motion) for entry in engine.entries if entry.motion is not None
        ]
        engine.stepping.moved = None
        roots = [fixed_roots(engine, entry) for entry, _ in self.moving]
        engine.ray_scenes.moved = frozenset(body for bodies in roots for body in bodies)
        if self.moving:
            engine.stepping.moved = Moved(
                engine.model,
                roots,
                [(motion.linear, motion.angular) for _, motion in self.moving],
            )
            self._locate()

    def advance(self) -> None:
        """Moves the models to their poses at the current time."""
        for entry, motion in self.moving:
            entry.pose = motion.at(self._engine.time_ns)
            put_fixed(self._engine, entry)
        moved = self._engine.stepping.moved
        if moved is not None and moved.deep(self._engine.data):
            self._separate()
        self._in_place.locate_fixed()
        self._in_place.wake(changes_model=False)
        self._locate()

    def _separate(self) -> None:
        """Limits the speed of what the models squeeze."""
        engine = self._engine
        for entry, motion in self.moving:
            speeds = math.hypot(*motion.linear), math.hypot(*motion.angular)
            roots = set(fixed_roots(engine, entry))
            self._separation.begin(engine.model, engine.data, roots, speeds)

    def _locate(self) -> None:
        moved = self._engine.stepping.moved
        assert moved is not None
        moved.origins[:] = [entry.pose.position for entry, _ in self.moving]
