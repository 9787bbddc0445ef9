"""The physics of the worlds of a batch, by MuJoCo Warp."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from cartwheel.batch.warp.device import RESULTS, Device
from cartwheel.batch.warp.library import library, unsupported
from cartwheel.geometry import Array
from cartwheel.simulation.outside_steps import count_steps, keep_awake, physics_of_cartwheel

if TYPE_CHECKING:
    from cartwheel.batch.abreast import Run
    from cartwheel.simulation import Simulation
    from cartwheel.simulation.engine import Engine


@dataclass(frozen=True, slots=True)
class _Piece:
    run: Run
    engine: Engine
    row: int
    count: int
    forwarded: bool
    looks_back: bool
    """Whether poses, contacts and forces before the last step are needed."""


class WarpPhysics:
    """Computes the steps of all worlds together, on a device.

    Between the times at which plugins act, the worlds are on the device. At these times, their
    states are copied to their `MjData`. What sensors read is computed there from the states, by a
    forward pass of MuJoCo itself.

    Args:
        simulations: The worlds, with the same models.
        device: Warp's name of the device, such as ``cuda:0``.

    Raises:
        CartwheelError: MuJoCo Warp is not installed, or cannot use the device or the models.
    """

    def __init__(self, simulations: Sequence[Simulation], device: str) -> None:
        engines = [each.engine for each in simulations]
        if not engines[0].model.nv:
            raise unsupported("a world in which nothing can move")
        self._library = library(device)
        self._rows = {id(engine): row for row, engine in enumerate(engines)}
        self._known: list[tuple[Any, int]] = [(None, -1)] * len(engines)
        """The model of each world and `Engine.revisions` when its parameters were read."""
        for engine in engines:
            _check(engine)
        first = engines[0]
        self._start = first.model.qpos0.copy()
        self._device = Device(self._library, first.model, first.data, len(engines))
        for engine in engines:
            self._read(engine)
        self._device.compile()

    def advance(self, lanes: Sequence[Run]) -> None:
        """Makes the next steps of some worlds. An error of a world ends its run."""
        pieces = []
        for run in lanes:
            try:
                pieces.append(self._piece(run))
            except Exception as error:  # noqa: BLE001 - an error of this world
                run.fail(error)
        if not pieces:
            return
        stops = {each.count for each in pieces}
        stops |= {each.count - 1 for each in pieces if each.looks_back and each.count > 1}
        ordered = sorted(stops)
        states = dict(zip(ordered, self._device.run(ordered), strict=True))
        for piece in pieces:
            try:
                _apply(piece, states)
            except Exception as error:  # noqa: BLE001 - an error of this world
                piece.run.fail(error)
        self._calm(states[ordered[-1]])

    def _piece(self, run: Run) -> _Piece:
        """Reads the state of a world before its next steps."""
        engine = run.simulation.engine
        row = self._read(engine)
        count, forwarded = run.piece
        looks_back = run.ends or run.simulation.looks_back(count)
        return _Piece(run, engine, row, count, forwarded, looks_back)

    def _read(self, engine: Engine) -> int:
        """Reads the state of a world, and its parameters if they have changed.

        Returns:
            The row of the world.

        Raises:
            CartwheelError: The world has changed so that it cannot be simulated.
        """
        row = self._rows[id(engine)]
        model, data = engine.model, engine.data
        known, revisions = self._known[row]
        if known is not model or revisions != engine.revisions:
            _check(engine)
            self._device.parameters.check(row, model)
            self._known[row] = model, engine.revisions
        self._device.parameters.watch(row, model)
        for name, values in self._device.inputs.items():
            values[row] = getattr(data, name)
        if data.eq_active.size:
            self._device.equalities[row] = data.eq_active
        return row

    def _calm(self, states: Mapping[str, Array]) -> None:
        """Replaces states that are not finite, which would delay the other worlds.

        The states in the worlds themselves are not affected.
        """
        inputs = self._device.inputs
        size = states["qpos"].sum(axis=1)
        if "qvel" in states:
            size = size + states["qvel"].sum(axis=1)
        for row in np.flatnonzero(~np.isfinite(size)):
            for values in inputs.values():
                values[row] = 0.0
            inputs["qpos"][row] = self._start


def _check(engine: Engine) -> None:
    """Raises an error if Cartwheel itself computes a part of the steps."""
    keep_awake(engine)
    for feature in physics_of_cartwheel(engine):
        raise unsupported(feature)


def _apply(piece: _Piece, states: Mapping[int, Mapping[str, Array]]) -> None:
    """Sets the state of a world after its steps, as if MuJoCo had computed them."""
    engine, count = piece.engine, piece.count
    before = count - 1
    if piece.looks_back:
        if before:
            count_steps(engine, before)
            _set(engine, piece.row, states[before])
        if before or not piece.forwarded:
            engine.forward()
    count_steps(engine, 1 if piece.looks_back else count)
    _set(engine, piece.row, states[count])


def _set(engine: Engine, row: int, state: Mapping[str, Array]) -> None:
    data = engine.data
    for name in RESULTS:
        values = state.get(name)
        if values is not None:
            getattr(data, name)[...] = values[row]
