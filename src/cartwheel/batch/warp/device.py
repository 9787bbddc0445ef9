"""The states of all worlds on a device."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from cartwheel.batch.warp.library import Library, unsupported
from cartwheel.batch.warp.parameters import Parameters, prepared
from cartwheel.geometry import Array

RESULTS = ("qpos", "qvel", "act", "history", "qacc_warmstart")
"""Arrays of `MjData` that a step changes."""
_INPUTS = ("ctrl", "qfrc_applied", "xfrc_applied", "mocap_pos", "mocap_quat")
_ALIGNED = 64
"""The arrays begin at multiples of so many numbers."""
_LARGEST = 1 << 24
"""Maximum number of contacts of all worlds, and of constraints of each."""


class Device:
    """A model with the states of many worlds on a device.

    All state arrays are parts of one array, which is copied at once.

    Args:
        library: MuJoCo Warp.
        model: The MuJoCo model of the worlds.
        data: Its data in the first world.
        count: Number of worlds.

    Raises:
        CartwheelError: MuJoCo Warp does not support the model.
    """

    def __init__(self, library: Library, model: Any, data: Any, count: int) -> None:
        self._library, self._count = library, count
        self._host_model = prepared(model)
        with library.used():
            try:
                self._model = library.physics.put_model(self._host_model)
            except (NotImplementedError, ValueError) as error:
                raise unsupported(f"these models: {error}") from None
            self._model.opt.warn_overflow = 0
            # MuJoCo Warp raises it to 1e-6, with which wheels that slip miss their speed by 1 cm/s.
            self._model.opt.tolerance.fill_(float(model.opt.tolerance))
            if library.device.is_cuda:
                # The processor computes kernels in a fixed order.
                self._model.opt.deterministic = int(library.physics.DeterminismType.ALL)
                self._model.opt.graph_conditional = bool(
                    library.warp.is_conditional_graph_supported()
                )
            self.parameters = Parameters(library, self._host_model, self._model, count)
            self._lay_out(data)
            self._sizes: dict[str, int] = {}
            self._allocate()

    def _lay_out(self, data: Any) -> None:
        """Places all arrays of the state in one array; results first."""
        warp, count = self._library.warp, self._count
        self._places: dict[str, tuple[int, tuple[int, ...]]] = {}
        end = 0
        for name in (*RESULTS, *_INPUTS):
            value = getattr(data, name, None)
            if value is None or not value.size:
                continue
            self._places[name] = end, (count, *value.shape)
            size = count * value.size
            end += math.ceil(size / _ALIGNED) * _ALIGNED
            if name in RESULTS:
                self._results = end
        pinned = bool(self._library.device.is_cuda)
        self._up = warp.zeros(end, dtype=warp.float32, device="cpu", pinned=pinned)
        self._down = warp.zeros(self._results, dtype=warp.float32, device="cpu", pinned=pinned)
        self._all = warp.zeros(end, dtype=warp.float32)
        self.inputs = self._views(self._up.numpy())
        """The states before the next steps, which the caller sets: each of shape (worlds, …)."""
        self._found = self._views(self._down.numpy())
        self.equalities = np.zeros((count, data.eq_active.size), dtype=bool)
        """Which equality constraints are active; shape (worlds, constraints)."""

    def _views(self, flat: Array) -> dict[str, Array]:
        return {
            name: flat[start : start + math.prod(shape)].reshape(shape)
            for name, (start, shape) in self._places.items()
            if start < len(flat)
        }

    def _allocate(self) -> None:
        warp = self._library.warp
        data = self._data = self._library.physics.make_data(
            self._host_model, nworld=self._count, **self._sizes
        )
        for name, (start, _) in self._places.items():
            old = getattr(data, name)
            view = warp.array(
                ptr=self._all.ptr + start * 4, dtype=old.dtype, shape=old.shape,
                device=self._library.device, copy=False,
            )  # fmt: skip
            setattr(data, name, view)
        self._graph: Any = None

    def run(self, stops: Sequence[int]) -> list[Mapping[str, Array]]:
        """Computes steps of all worlds.

        Args:
            stops: Numbers of steps after which the states are read, ascending.

        Returns:
            The states after each of these numbers of steps, by the names of `RESULTS`, each of
            shape (worlds, …).

        Raises:
            CartwheelError: A limit of MuJoCo Warp is exceeded.
        """
        with self._library.used():
            while True:
                found = self._attempt(stops)
                exceeded = int(np.bitwise_or.reduce(self._data.overflow.numpy()))
                if not self._grows(exceeded):
                    return found

    def _attempt(self, stops: Sequence[int]) -> list[Mapping[str, Array]]:
        warp, data = self._library.warp, self._data
        if self.parameters.upload():
            self._graph = None
        data.overflow.zero_()
        warp.copy(self._all, self._up)
        if self.equalities.size:
            data.eq_active.assign(self.equalities)
        found: list[Mapping[str, Array]] = []
        done = 0
        for stop in stops:
            for _ in range(stop - done):
                self._step()
            done = stop
            warp.copy(self._down, self._all, count=self._results)
            if self._library.device.is_cuda:
                warp.synchronize_device(self._library.device)
            found.append({name: each.copy() for name, each in self._found.items()})
        return found

    def _step(self) -> None:
        warp, physics = self._library.warp, self._library.physics
        if not self._library.device.is_cuda:
            physics.step(self._model, self._data)
            return
        if self._graph is None:
            with warp.ScopedCapture(device=self._library.device) as capture:
                physics.step(self._model, self._data)
            self._graph = capture.graph
        warp.capture_launch(self._graph)

    def compile(self) -> None:
        """Compiles the kernels, by a step whose results are not used.

        Raises:
            CartwheelError: MuJoCo Warp does not support the model.
        """
        with self._library.used():
            self._library.warp.copy(self._all, self._up)
            try:
                self._library.physics.step(self._model, self._data)
            except (NotImplementedError, ValueError) as error:
                raise unsupported(f"these models: {error}") from None

    def _grows(self, exceeded: int) -> bool:
        """Makes space for more contacts and constraints.

        Args:
            exceeded: Bits of MuJoCo Warp's `OverflowType`.

        Returns:
            Whether the steps must be repeated.
        """
        kinds = self._library.physics.OverflowType
        if exceeded & int(kinds.HFIELD | kinds.NVMAX | kinds.EPA_HORIZON):
            names = ", ".join(each.name for each in kinds if each and exceeded & each)
            raise unsupported(f"this state: a limit of MuJoCo Warp is exceeded ({names})")
        data, sizes = self._data, self._sizes
        contacts = kinds.BROADPHASE | kinds.NARROWPHASE | kinds.CCD
        growing = []
        if exceeded & int(contacts):
            growing += ["naconmax", "naccdmax"]
        if exceeded & int(kinds.NEFC):
            growing += ["njmax", "njmax_nnz"]
        elif exceeded & int(kinds.NJMAX_NNZ):
            growing.append("njmax_nnz")
        if not growing:
            return False
        for name in ("naconmax", "naccdmax", "njmax", "njmax_nnz"):
            size = int(getattr(data, name))
            sizes[name] = max(1, size) * 2 if name in growing else size
            if sizes[name] > _LARGEST:
                raise unsupported("so many contacts")
        self._allocate()
        return True
