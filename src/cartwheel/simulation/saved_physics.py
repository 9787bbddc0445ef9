"""Saves MuJoCo's model and data.

A copy of an `MjData` contains the whole state of the physics: also what `mj_step` does not read,
such as poses and contact forces of the last step, which plugins may read before the next one.
"""

from __future__ import annotations

import copy
import pickle
from collections.abc import Iterator
from typing import Any

import mujoco
import numpy as np

_SIZES = ("nq", "nv", "nu", "nbody", "njnt", "ngeom", "neq", "ntendon", "npair")
_NUMBERS = (int, float)


VERSION: str = mujoco.__version__


class Physics:
    """A copy of MuJoCo's model and data.

    Args:
        model: ``mujoco.MjModel``.
        data: ``mujoco.MjData``.
    """

    def __init__(self, model: Any, data: Any) -> None:
        self._data = copy.copy(data)
        self._model = pickle.dumps(model)
        self._shape = _shape(model)

    def fits(self, model: Any) -> bool:
        """Whether the copy belongs to a model with the same elements."""
        return self._shape == _shape(model)

    def restore(self, model: Any, data: Any) -> None:
        """Copies the saved state to a simulation. All views of its arrays remain valid.

        Args:
            model: The simulation's model, which the copy `fits`.
            data: The simulation's data.
        """
        if self._model != pickle.dumps(model):
            _copy(pickle.loads(self._model), model, numbers=False)  # noqa: S301 - see `State`
        mujoco.mj_copyData(data, model, self._data)
        for name in _fields(type(data)):
            value = getattr(self._data, name)
            if type(value) in _NUMBERS and value != getattr(data, name) and name not in _FIXED:
                setattr(data, name, value)

    def __getstate__(self) -> dict[str, Any]:
        # A pickled MjData lacks the newest fields of MuJoCo.
        pickled = pickle.dumps(self._data)
        lost = dict(_differences(self._data, pickle.loads(pickled)))  # noqa: S301 - see above
        return {**vars(self), "_data": (pickled, lost)}

    def __setstate__(self, state: dict[str, Any]) -> None:
        pickled, lost = state["_data"]
        data = pickle.loads(pickled)  # noqa: S301 - see `State`
        for name, value in lost.items():
            if isinstance(value, np.ndarray):
                getattr(data, name)[...] = value
            else:
                setattr(data, name, value)
        vars(self).update(state, _data=data)


_FIXED = frozenset({"signature", "threadpool"})
"""Numbers of an `MjData` that belong to its model and process."""


def _shape(model: Any) -> tuple[Any, ...]:
    return (*(getattr(model, size) for size in _SIZES), model.names)


def _differences(data: Any, other: Any) -> Iterator[tuple[str, Any]]:
    """Yields arrays and numbers of an `MjData` that differ in another one of the same size."""
    for name in _fields(type(data)):
        value = getattr(data, name)
        if isinstance(value, np.ndarray):
            same = value.shape == getattr(other, name).shape
            if same and value.tobytes() != getattr(other, name).tobytes():
                yield name, value.copy()
        elif type(value) in _NUMBERS and value != getattr(other, name) and name not in _FIXED:
            yield name, value


def _copy(source: Any, target: Any, *, numbers: bool = True) -> None:
    """Copies the arrays of a structure and of its parts.

    Args:
        source: The structure.
        target: A structure of the same class.
        numbers: Whether to copy numbers, too. Those of a model are sizes, which cannot be set.
    """
    for name in _fields(type(source)):
        value = getattr(source, name)
        if isinstance(value, np.ndarray):
            if value.size:
                getattr(target, name)[...] = value
        elif type(value) in _NUMBERS:
            if numbers and value != getattr(target, name):
                setattr(target, name, value)
        elif type(value).__module__.startswith("mujoco"):
            _copy(value, getattr(target, name))


_FIELDS: dict[type, tuple[str, ...]] = {}


def _fields(cls: type) -> tuple[str, ...]:
    if cls not in _FIELDS:
        _FIELDS[cls] = tuple(
            name
            for name in dir(cls)
            if not name.startswith("_") and isinstance(getattr(cls, name), property)
        )
    return _FIELDS[cls]
