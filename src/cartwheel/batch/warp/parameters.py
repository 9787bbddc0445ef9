"""Parameters of the models, of which each world can have its own."""

from __future__ import annotations

import dataclasses
from collections.abc import Iterator
from typing import Any

import numpy as np

from cartwheel.batch.warp.library import Library, unsupported
from cartwheel.geometry import Array
from cartwheel.simulation.outside_steps import AFFINE, LEAST_FRICTION, disabled, without_sleep

_UNSEEN = (
    "bvh_", "cam_", "hfield_", "key_", "light_", "mat_", "mesh_", "name", "numeric_", "oct_",
    "paths", "sensor_", "signature", "skin_", "text_", "tex_", "tuple_",
)  # fmt: skip
"""Prefixes of arrays that do not affect the physics, or that Cartwheel never changes."""
_UNUSED = frozenset(
    {"dof_length", "dof_M0", "geom_matid", "geom_rgba", "site_rgba", "tendon_rgba",
     "tree_sleep_policy"}
)  # fmt: skip
"""Other arrays that do not affect the physics on the device."""
_CHANGING = ("actuator_gainprm", "actuator_biasprm", "tendon_frictionloss")
"""Arrays that servos change between steps, without `Engine.note_change`."""
_SIZES = ("nq", "nv", "nu", "na", "nbody", "njnt", "ngeom", "npair", "neq", "ntendon", "names")
_OPTIONS = ("timestep", "wind", "magnetic", "density", "viscosity", "integrator")
_FRICTIONS = frozenset({"geom_friction", "pair_friction"})
_NO_DAMPING = 1e-30
"""Damping of actuators that have none. MuJoCo Warp omits damping that no actuator has at first."""


def prepared(model: Any) -> Any:
    """A copy of a model for MuJoCo Warp, with the same physics apart from sleep."""
    made = without_sleep(model)
    for name in (*_FRICTIONS, "actuator_biasprm"):
        getattr(made, name)[:] = _stated(made, name)
    return made


class Parameters:
    """Copies parameters of the worlds to the device when they change.

    Args:
        library: MuJoCo Warp.
        model: The `prepared` model of all worlds.
        device_model: The model on the device.
        count: Number of worlds.
    """

    def __init__(self, library: Library, model: Any, device_model: Any, count: int) -> None:
        self._library, self._model, self._device_model = library, model, device_model
        self._count = count
        self._shared: dict[str, Array] = {
            name: _single(_stated(model, name))
            for name, _ in _batched(device_model)
            if _is_copied(model, device_model, name)
        }
        """Parameters that the device has as they are, in single precision."""
        self._priorities = np.repeat(model.geom_priority[None], count, axis=0)
        """The order of the friction coefficients of each world, which must be the same in all."""
        self._fixed = [
            name for name in _arrays(model) if name not in self._shared and name != "geom_priority"
        ]
        self._own: dict[str, Array] = {}
        """Parameters by world, of those that differ in any world."""
        self._stale: set[str] = set()
        self._gravity = _single(model.opt.gravity)
        self._last: dict[tuple[int, str], bytes] = {}

    def check(self, row: int, model: Any) -> None:
        """Reads all parameters of a world, after a change.

        Raises:
            CartwheelError: A parameter has changed that is the same in all worlds.
        """
        if any(getattr(model, size) != getattr(self._model, size) for size in _SIZES):
            raise unsupported(
                "a world whose models differ from those of the other worlds",
                "Models cannot be spawned or deleted in worlds of a Warp batch.",
            )
        for name in _OPTIONS:
            if not np.array_equal(getattr(model.opt, name), getattr(self._model.opt, name)):
                raise unsupported(f"a world with its own {name}")
        if disabled(model) != disabled(self._model):
            raise unsupported("a world with its own disabled physics")
        for name in self._fixed:
            if not np.array_equal(getattr(model, name), getattr(self._model, name)):
                raise unsupported(f"a world with its own {name}")
        for name in self._shared:
            self._read(row, name, _stated(model, name))
        if not np.array_equal(self._priorities[row], model.geom_priority):
            self._priorities[row] = model.geom_priority
            self._stale.add("geom_priority")
        self._read(row, "gravity", model.opt.gravity)

    def watch(self, row: int, model: Any) -> None:
        """Reads the parameters of a world that servos change."""
        for name in _CHANGING:
            now = getattr(model, name).tobytes()
            if now and self._last.get((row, name)) != now:
                self._last[row, name] = now
                self._read(row, name, _stated(model, name))

    def _read(self, row: int, name: str, values: Array) -> None:
        base = self._gravity if name == "gravity" else self._shared[name]
        own = self._own.get(name)
        single = _single(values)
        if own is None:
            if np.array_equal(single, base):
                return
            own = self._own[name] = np.repeat(base[None], self._count, axis=0)
        if not np.array_equal(own[row], single):
            own[row] = single
            self._stale.add(name)

    def upload(self) -> bool:
        """Copies what has changed.

        Returns:
            Whether arrays of the device were replaced.

        Raises:
            CartwheelError: The friction coefficients of two worlds are in different orders.
        """
        replaced = False
        if "geom_priority" in self._stale:
            order = self._priorities
            if (order != order[0]).any():
                raise unsupported(
                    "worlds in which different surfaces have the lower friction",
                    "In a contact, the lower friction coefficient applies. Vary the friction so "
                    "that the order of all coefficients is the same in all worlds.",
                )
            self._device_model.geom_priority.assign(order[0])
            self._stale.remove("geom_priority")
        for name in sorted(self._stale):
            owner = self._device_model.opt if name == "gravity" else self._device_model
            array, values = getattr(owner, name), self._own[name]
            if array.shape[0] == self._count:
                array.assign(values)
                continue
            made = self._library.warp.array(values, dtype=array.dtype)
            setattr(owner, name, made)
            replaced = True
        self._stale.clear()
        return replaced


def _stated(model: Any, name: str) -> Array:
    """A parameter as the device needs it."""
    values: Array = getattr(model, name)
    if name in _FRICTIONS:
        # As MuJoCo does it for each contact.
        return np.maximum(values, LEAST_FRICTION)
    if name == "actuator_biasprm" and len(values):
        values = values.copy()
        free = (model.actuator_biastype == AFFINE) & (values[:, 2] == 0.0)
        values[free, 2] = -_NO_DAMPING
    return values


def _single(values: Array) -> Array:
    found: Array = np.asarray(values)
    return found.astype(np.float32) if found.dtype == np.float64 else found.copy()


def _batched(device_model: Any) -> Iterator[tuple[str, Any]]:
    """The arrays of MuJoCo Warp that can have values for each world."""
    for field in dataclasses.fields(device_model):
        shape: Any = getattr(field.type, "shape", ())
        if len(shape) > 1 and shape[0] == "*" and not field.name.startswith(_UNSEEN):
            yield field.name, field.type


def _is_copied(model: Any, device_model: Any, name: str) -> bool:
    if name in _UNUSED or not hasattr(model, name):
        return False
    here, there = _single(_stated(model, name)), getattr(device_model, name).numpy()
    return here.size == there.size and np.array_equal(here.ravel(), there.ravel())


def _arrays(model: Any) -> Iterator[str]:
    """Names of the arrays of a model that affect the physics."""
    for name in dir(model):
        if name.startswith(("_", *_UNSEEN)) or name in _UNUSED:
            continue
        if isinstance(getattr(model, name), np.ndarray):
            yield name
