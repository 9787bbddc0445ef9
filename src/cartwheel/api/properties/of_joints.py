"""The properties of a joint that a program can change."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

from cartwheel.api.handles import Handle
from cartwheel.api.properties.inertials import missing
from cartwheel.api.values import instance, invalid, scalar
from cartwheel.description.model import Joint as Description
from cartwheel.description.model import RobotDescription

if TYPE_CHECKING:
    from cartwheel.api.joints import Joints
    from cartwheel.simulation import Simulation


_FAILED = 1e-9
"""Maximum effort of a motor that has failed, N m or N. In descriptions, 0 is unlimited."""


@dataclass(frozen=True, slots=True)
class Gains:
    """Gains of a PID controller of a joint."""

    p: float
    """Proportional gain, effort per rad or m, or per rad/s or m/s for a target velocity."""
    i: float = 0.0
    """Integral gain, the same per second."""
    d: float = 0.0
    """Derivative gain, the same times seconds."""


class JointProperties(Handle):
    """The properties of a joint, which `World.reset` keeps."""

    __slots__ = ()

    _joints: Joints
    name: str

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
        self._limit(lower=lower, upper=upper)

    @property
    def effort_limit(self) -> float | None:
        """Maximum effort of the joint's motor or controller, N m or N; None is unlimited.

        Setting it replaces the limits of the file, the plugin and the controller, for a weak or a
        strong motor. 0 is a motor that has failed: the joint turns freely.

        Raises:
            CartwheelError: The limit is not finite, or negative.
            UnknownNameError: The model does not exist any more.
            SimulationError: The world is closed.
        """
        with self._joints.world.lock:
            simulation = self._joints.world.session.simulation
            self._find(simulation)
            found = simulation.truth.limits.effort(self._joints.model, self.name)
            return 0.0 if found == _FAILED else found

    @effort_limit.setter
    def effort_limit(self, effort: float | None) -> None:
        if effort is not None:
            effort = scalar(effort, "effort_limit", least=0.0) or _FAILED
        self._limit(effort=effort)

    @property
    def velocity_limit(self) -> float | None:
        """Maximum velocity that controllers command, rad/s or m/s; None is unlimited.

        As in Gazebo, only controllers of ros_control and ros2_control have a limit.

        Raises:
            CartwheelError: The limit is not finite, or not above 0, or the joint has no such
                controller.
            UnknownNameError: The model does not exist any more.
            SimulationError: The world is closed.
        """
        with self._joints.world.lock:
            simulation = self._joints.world.session.simulation
            self._find(simulation)
            return simulation.truth.limits.velocity(self._joints.model, self.name)

    @velocity_limit.setter
    def velocity_limit(self, velocity: float | None) -> None:
        if velocity is not None:
            velocity = scalar(velocity, "velocity_limit", above=0.0)
        with self._joints.world.lock:
            simulation = self._joints.world.session.simulation
            self._find(simulation)
            if not simulation.truth.limits.limits_velocity(self._joints.model, self.name):
                raise missing("joint", self.name, "controller that limits its velocity")
        self._limit(velocity=velocity)

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
        instance(gains, Gains, "gains", "cartwheel.Gains(p=100.0, i=0.01, d=10.0)")
        given = {name: scalar(getattr(gains, name), name) for name in ("p", "i", "d")}
        with self._joints.world._used(change=True) as simulation:
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

    def _limit(self, **limits: float | None) -> None:
        """Sets limits of the joint and of what drives it."""
        with self._joints.world._used(change=True) as simulation:
            self._find(simulation)
            simulation.truth.limits.set(self._joints.model, self.name, limits)

    def _change(self, **values: float | None) -> None:
        """Changes values of the joint's axis."""
        with self._joints.world._used(change=True) as simulation:
            description, joint = self._find(simulation)
            axis = replace(joint.axis, **values)  # type: ignore[arg-type]
            if axis != joint.axis:
                changed = replace(joint, axis=axis)
                joints = tuple(changed if each is joint else each for each in description.joints)
                simulation.redescribe(self._joints.model, replace(description, joints=joints))
