"""Quantities of all joints of a model, by name."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, MutableMapping, Sequence
from typing import TYPE_CHECKING, Any, cast

import numpy as np
from numpy.typing import NDArray

from cartwheel.api.handles import Sealed
from cartwheel.api.values import array, scalar
from cartwheel.errors import CartwheelError
from cartwheel.geometry import Array

if TYPE_CHECKING:
    from cartwheel.api.joints import Joints
    from cartwheel.simulation import Simulation

Values = float | Mapping[str, float] | Sequence[float] | NDArray[np.float64]
"""One value for all joints, values of some joints by name, or an array of shape (joints,) in the
order of `Joints.names`."""


class JointValues(Sealed, MutableMapping[str, float]):
    """One quantity of all joints of a model: a mapping by name, and an array.

    Each access reads or sets the current state. ``numpy.asarray(values)`` is a new array in the
    order of `Joints.names`.
    """

    __slots__ = ("_joints", "_name", "_read", "_write")

    def __init__(
        self,
        joints: Joints,
        name: str,
        read: Callable[[Simulation, str], float],
        write: Callable[[Simulation, Mapping[str, float]], None],
    ) -> None:
        self._joints = joints
        self._name = name
        self._read = read
        self._write = write

    def __getitem__(self, joint: str) -> float:
        with self._joints.world.lock:
            return self._read(self._joints.world.session.simulation, joint)

    def __setitem__(self, joint: str, value: float) -> None:
        self.set({joint: value})

    def __delitem__(self, joint: str) -> None:
        raise TypeError(f'the {self._name} of joint "{joint}" cannot be removed')

    def __iter__(self) -> Iterator[str]:
        return iter(self._joints.names)

    def __len__(self) -> int:
        return len(self._joints.names)

    def __contains__(self, joint: object) -> bool:
        return joint in self._joints.names

    def __array__(self, dtype: Any = None, copy: bool | None = None) -> Array:
        with self._joints.world.lock:
            return np.array([self[joint] for joint in self._joints.names], dtype=dtype)

    def __repr__(self) -> str:
        return repr(dict(self))

    def set(self, values: Values) -> None:
        """Sets the same value for all joints, the values of some joints by name, or an array of
        shape (joints,).

        Raises:
            CartwheelError: A number is not finite or out of range, or an array has not one number
                for each joint.
            UnknownNameError: A joint does not exist or cannot move.
            SimulationError: The world is closed.
        """
        if not isinstance(values, Mapping):
            names = self._joints.names
            what = f"the {self._name} of the joints"
            if isinstance(values, str) or np.ndim(values) == 0:
                values = dict.fromkeys(names, scalar(cast("float", values), what))
            else:
                values = dict(zip(names, self._array(values, what).tolist(), strict=True))
        given = {
            joint: scalar(value, f'the {self._name} of joint "{joint}"')
            for joint, value in values.items()
        }
        with self._joints.world._used(change=True) as simulation:
            self._write(simulation, given)

    def _array(self, values: object, what: str) -> Array:
        """One finite number for each joint, shape (joints,)."""
        names = self._joints.names
        try:
            return array(values, (len(names),), what)
        except CartwheelError as error:
            some = f'{{"{names[0]}": …}}' if names else "{}"
            error.hint = f"Write one number for all joints, or values by name, such as {some}."
            raise
