"""The joints of a model."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, MutableMapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from cartwheel.api.values import array, scalar
from cartwheel.geometry import Array

if TYPE_CHECKING:
    from cartwheel.api.world import World
    from cartwheel.simulation import Simulation

Values = Mapping[str, float] | Sequence[float] | NDArray[np.float64]
"""Values of some joints by name, or of all joints in the order of `Joints.names`."""


class JointValues(MutableMapping[str, float]):
    """One quantity of all joints of a model: a mapping by name, and an array.

    Each access reads or sets the current state. ``numpy.asarray(values)`` is a new array in the
    order of `Joints.names`.
    """

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
        """Sets the values of some joints by name, or of all joints.

        Raises:
            CartwheelError: A number is not finite or out of range, or there is not one number for
                each joint.
            UnknownNameError: A joint does not exist or cannot move.
            SimulationError: The world is closed.
        """
        if not isinstance(values, Mapping):
            names = self._joints.names
            numbers = array(values, (len(names),), f"the {self._name} of the joints")
            values = dict(zip(names, numbers.tolist(), strict=True))
        given = {
            joint: scalar(value, f'the {self._name} of joint "{joint}"')
            for joint, value in values.items()
        }
        with self._joints.world.used(change=True) as simulation:
            self._write(simulation, given)


class Joints:
    """The joints of a model with one degree of freedom. `Model.joints` returns it.

    Fixed joints, ball joints and the joints of static models are not included.
    """

    def __init__(self, world: World, model: str) -> None:
        self.world = world
        """The world."""
        self.model = model
        """Name of the model."""

    @property
    def names(self) -> tuple[str, ...]:
        """Names of the joints, in the order of the description.

        Raises:
            UnknownNameError: The model does not exist any more.
        """
        with self.world.lock:
            return self.world.session.simulation.truth.joints(self.model)

    def __getitem__(self, name: str) -> Joint:
        """A handle to a joint.

        Raises:
            UnknownNameError: The joint does not exist or cannot move.
        """
        with self.world.lock:
            self.world.session.simulation.truth.joint(self.model, name)
        return Joint(self, name)

    def __iter__(self) -> Iterator[str]:
        return iter(self.names)

    def __len__(self) -> int:
        return len(self.names)

    def __contains__(self, name: object) -> bool:
        return name in self.names

    def __repr__(self) -> str:
        return f"Joints({list(self.names)!r})"

    @property
    def positions(self) -> JointValues:
        """Positions, rad or m. Setting a position stops the joint; joints that mimic it follow."""
        return JointValues(
            self,
            "position",
            lambda simulation, joint: simulation.truth.joint(self.model, joint).position,
            lambda simulation, values: simulation.set_joint_positions(self.model, values),
        )

    @positions.setter
    def positions(self, values: Values) -> None:
        self.positions.set(values)

    @property
    def velocities(self) -> JointValues:
        """Velocities, rad/s or m/s. A motor on the joint brings it back to its own velocity."""
        return JointValues(
            self,
            "velocity",
            lambda simulation, joint: simulation.truth.joint(self.model, joint).velocity,
            lambda simulation, values: simulation.truth.set_joint_velocities(self.model, values),
        )

    @velocities.setter
    def velocities(self, values: Values) -> None:
        self.velocities.set(values)

    @property
    def efforts(self) -> JointValues:
        """Efforts, N m or N: of motors, controllers and of what was set here.

        An effort that is set acts in addition to motors and controllers until it is set again.
        `World.reset` sets it to 0.
        """
        return JointValues(
            self,
            "effort",
            lambda simulation, joint: simulation.truth.effort(self.model, joint),
            lambda simulation, values: simulation.truth.set_efforts(self.model, values),
        )

    @efforts.setter
    def efforts(self, values: Values) -> None:
        self.efforts.set(values)


class Joint:
    """A handle to a joint with one degree of freedom. ``Model.joints[name]`` returns it."""

    def __init__(self, joints: Joints, name: str) -> None:
        self._joints = joints
        self.name = name
        """Name in the model."""

    def __repr__(self) -> str:
        return f"Joint({self._joints.model!r}, {self.name!r})"

    @property
    def position(self) -> float:
        """Position, rad or m; see `Joints.positions`."""
        return self._joints.positions[self.name]

    @position.setter
    def position(self, value: float) -> None:
        self._joints.positions[self.name] = value

    @property
    def velocity(self) -> float:
        """Velocity, rad/s or m/s; see `Joints.velocities`."""
        return self._joints.velocities[self.name]

    @velocity.setter
    def velocity(self, value: float) -> None:
        self._joints.velocities[self.name] = value

    @property
    def effort(self) -> float:
        """Effort, N m or N; see `Joints.efforts`."""
        return self._joints.efforts[self.name]

    @effort.setter
    def effort(self, value: float) -> None:
        self._joints.efforts[self.name] = value

    @property
    def limits(self) -> tuple[float | None, float | None]:
        """Lower and upper limit of the position, rad or m; None is unlimited."""
        with self._joints.world.lock:
            truth = self._joints.world.session.simulation.truth
            truth.joint(self._joints.model, self.name)
            joint = truth.description(self._joints.model).joint(self.name)
            assert joint is not None
            if joint.type == "continuous":
                return None, None
            return joint.axis.lower, joint.axis.upper
