"""The joints of a model."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import TYPE_CHECKING

from cartwheel.api.handles import Handle
from cartwheel.api.properties.joint_values import JointValues, Values
from cartwheel.api.properties.of_joints import JointProperties
from cartwheel.description.model import JointType

if TYPE_CHECKING:
    from cartwheel.api.world import World


class Joints(Handle):
    """The joints of a model with one degree of freedom. `Model.joints` returns it.

    Fixed joints, ball joints and the joints of static models are not included.
    """

    __slots__ = ("model", "world")

    def __init__(self, world: World, model: str) -> None:
        self.world = world
        """The world."""
        self.model = model
        """Name of the model."""

    @property
    def _identity(self) -> tuple[World, str]:
        return self.world, self.model

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
    def damping(self) -> JointValues:
        """Damping, N m s/rad or N s/m; see `Joint.damping`."""
        return JointValues(
            self,
            "damping",
            lambda _, joint: self[joint].damping,
            lambda _, values: self._set_each("damping", values),
        )

    @damping.setter
    def damping(self, values: Values) -> None:
        self.damping.set(values)

    @property
    def friction(self) -> JointValues:
        """Dry friction, N m or N; see `Joint.friction`."""
        return JointValues(
            self,
            "friction",
            lambda _, joint: self[joint].friction,
            lambda _, values: self._set_each("friction", values),
        )

    @friction.setter
    def friction(self, values: Values) -> None:
        self.friction.set(values)

    def _set_each(self, name: str, values: Mapping[str, float]) -> None:
        for joint, value in values.items():
            setattr(self[joint], name, value)

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


class Joint(JointProperties):
    """A handle to a joint with one degree of freedom. ``Model.joints[name]`` returns it.

    Two handles are equal if they belong to the same world and have the same names.
    """

    __slots__ = ("_joints", "name")
    _joints: Joints
    name: str

    def __init__(self, joints: Joints, name: str) -> None:
        self._joints = joints
        self.name = name
        """Name in the model."""

    def __repr__(self) -> str:
        return f"Joint({self._joints.model!r}, {self.name!r})"

    @property
    def _identity(self) -> tuple[Joints, str]:
        return self._joints, self.name

    @property
    def type(self) -> JointType:
        """Type as in URDF, such as ``revolute``, ``continuous`` or ``prismatic``."""
        return self._described.type

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
