"""The joints of a model."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

from cartwheel.api.handles import Handle
from cartwheel.api.properties.inertials import missing
from cartwheel.api.properties.joint_values import JointValues, Values
from cartwheel.api.values import invalid, scalar
from cartwheel.description.model import Joint as Description
from cartwheel.description.model import JointType, RobotDescription

if TYPE_CHECKING:
    from cartwheel.api.world import World
    from cartwheel.simulation import Simulation


@dataclass(frozen=True, slots=True)
class Gains:
    """Gains of a PID controller of a joint."""

    p: float
    """Proportional gain, effort per rad or m, or per rad/s or m/s for a target velocity."""
    i: float = 0.0
    """Integral gain, the same per second."""
    d: float = 0.0
    """Derivative gain, the same times seconds."""


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


class Joint(Handle):
    """A handle to a joint with one degree of freedom. ``Model.joints[name]`` returns it.

    Two handles are equal if they belong to the same world and have the same names.
    """

    __slots__ = ("_joints", "name")

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

    # -- properties, which `World.reset` keeps

    @property
    def limits(self) -> tuple[float | None, float | None]:
        """Lower and upper limit of the position, rad or m; None is unlimited.

        Raises:
            CartwheelError: A limit is not finite, the lower limit is above the upper one, or the
                joint is continuous.
            UnknownNameError: The model does not exist any more.
            SimulationError: The world is closed.
        """
        joint = self._described
        if joint.type == "continuous":
            return None, None
        return joint.axis.lower, joint.axis.upper

    @limits.setter
    def limits(self, limits: tuple[float | None, float | None]) -> None:
        if not isinstance(limits, Sequence) or len(limits) != 2:
            raise invalid("limits", "must be two numbers or None", limits)
        lower, upper = (None if each is None else scalar(each, "limits") for each in limits)
        if lower is not None and upper is not None and lower > upper:
            raise invalid("limits", "must not decrease", limits)
        if self._described.type == "continuous":
            raise invalid("limits", "of a continuous joint cannot be set", limits)
        self._change(lower=lower, upper=upper)

    @property
    def damping(self) -> float:
        """Effort per velocity, N m s/rad or N s/m.

        Raises:
            CartwheelError: The damping is negative or not finite.
            UnknownNameError: The model does not exist any more.
            SimulationError: The world is closed.
        """
        return self._described.axis.damping

    @damping.setter
    def damping(self, damping: float) -> None:
        self._change(damping=scalar(damping, "damping", least=0.0))

    @property
    def friction(self) -> float:
        """Effort of dry friction, N m or N.

        Raises:
            CartwheelError: The friction is negative or not finite.
            UnknownNameError: The model does not exist any more.
            SimulationError: The world is closed.
        """
        return self._described.axis.friction

    @friction.setter
    def friction(self, friction: float) -> None:
        self._change(friction=scalar(friction, "friction", least=0.0))

    @property
    def stiffness(self) -> float:
        """Stiffness of the joint's spring, N m/rad or N/m; 0 without a spring.

        Raises:
            CartwheelError: The stiffness is negative or not finite.
            UnknownNameError: The model does not exist any more.
            SimulationError: The world is closed.
        """
        return self._described.axis.spring_stiffness

    @stiffness.setter
    def stiffness(self, stiffness: float) -> None:
        self._change(spring_stiffness=scalar(stiffness, "stiffness", least=0.0))

    @property
    def spring_reference(self) -> float:
        """Position at which the joint's spring exerts no effort, rad or m.

        Raises:
            CartwheelError: The position is not finite.
            UnknownNameError: The model does not exist any more.
            SimulationError: The world is closed.
        """
        return self._described.axis.spring_reference

    @spring_reference.setter
    def spring_reference(self, position: float) -> None:
        self._change(spring_reference=scalar(position, "spring_reference"))

    @property
    def gains(self) -> Gains | None:
        """Gains of the joint's PID controller; None without one.

        A plugin or controller that holds positions and velocities regardless of the load has no
        gains.

        Raises:
            CartwheelError: A gain is not finite, or the joint has no PID controller.
            UnknownNameError: The model does not exist any more.
            SimulationError: The world is closed.
        """
        with self._joints.world.lock:
            found = self._joints.world.session.simulation.truth.gains(self._joints.model, self.name)
        return None if found is None else Gains(found.p, found.i, found.d)

    @gains.setter
    def gains(self, gains: Gains) -> None:
        given = {name: scalar(getattr(gains, name), name) for name in ("p", "i", "d")}
        with self._joints.world.used(change=True) as simulation:
            if not simulation.truth.set_gains(self._joints.model, self.name, given):
                raise missing("joint", self.name, "PID controller")

    @property
    def _described(self) -> Description:
        with self._joints.world.lock:
            return self._find(self._joints.world.session.simulation)[1]

    def _find(self, simulation: Simulation) -> tuple[RobotDescription, Description]:
        """The descriptions of the model and of the joint."""
        simulation.truth.joint(self._joints.model, self.name)
        description = simulation.truth.description(self._joints.model)
        joint = description.joint(self.name)
        assert joint is not None
        return description, joint

    def _change(self, **values: float | None) -> None:
        """Changes values of the joint's axis."""
        with self._joints.world.used(change=True) as simulation:
            description, joint = self._find(simulation)
            axis = replace(joint.axis, **values)  # type: ignore[arg-type]
            if axis != joint.axis:
                changed = replace(joint, axis=axis)
                joints = tuple(changed if each is joint else each for each in description.joints)
                simulation.redescribe(self._joints.model, replace(description, joints=joints))
