"""``SteerBotHardwareGazebo``: hardware with one wheel and one steering joint for four wheels."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from cartwheel.codes import robot
from cartwheel.component import Component
from cartwheel.description.model import RobotDescription
from cartwheel.devices.joints.actuator import JointActuator, JointActuatorConfig
from cartwheel.devices.joints.limits import JointLimits, position_range
from cartwheel.dialects.ros_control.hardware import STRONGEST, Hardware, JointHardware
from cartwheel.dialects.ros_control.interfaces import JointInterfaces
from cartwheel.dialects.ros_control.parameters import parameter, read_parameters_of
from cartwheel.dialects.ros_control.settings import Settings
from cartwheel.errors import Origin

SIM_TYPE = "steer_bot_hardware_gazebo/SteerBotHardwareGazebo"
PARAMETERS = "steer_bot_hardware_gazebo"
"""Namespace of the parameters, in the namespace of the robot."""


@dataclass(frozen=True, kw_only=True, slots=True)
class SteerBotParameters:
    wheel: str = parameter("rear_wheel", doc="Joint by which controllers command all wheels.")
    steer: str = parameter("front_steer", doc="Joint by which controllers command the steering.")
    rear_wheels: tuple[str, ...] = parameter(
        "virtual_rear_wheels", doc="The rear wheels of the robot, the right one first."
    )
    front_wheels: tuple[str, ...] = parameter(
        "virtual_front_wheels", doc="The front wheels of the robot, the right one first."
    )
    front_steers: tuple[str, ...] = parameter(
        "virtual_front_steers", doc="The steering joints of the robot, the right one first."
    )
    ackermann: bool = parameter(
        "enable_ackermann_link",
        default=True,
        doc="Steer the wheel on the inside of a curve more than the other one. If false, the "
        "second joint turns by twice the angle, as in the original.",
    )
    track: float = parameter(
        "wheel_separation_w", default=0.0, unit="m", doc="Distance between the front wheels."
    )
    base: float = parameter(
        "wheel_separation_h", default=0.0, unit="m", doc="Distance between the axles."
    )


class SteerBotHardware(Hardware):
    """Drives all wheels at one speed, and both steering joints by one angle.

    Controllers command ``rear_wheel`` and ``front_steer``. These two joints need not exist in the
    description; if they do, nothing drives them there. The other joints only have states: commands
    to them have no effect. As the original sets velocities and positions directly, effort and
    velocity limits in the description do not apply. Source: steer_bot_hardware_gazebo.

    Args:
        owner: Plugin of the controller manager.
        settings: Parameters in the namespace ``steer_bot_hardware_gazebo``.
        origin: File and line for errors.

    Raises:
        PluginError: A parameter is missing or invalid.
        UnknownNameError: A wheel or a steering joint does not exist.
    """

    def __init__(self, owner: Component, settings: Settings, origin: Origin) -> None:
        super().__init__(owner, [], {})
        self._tags = f'no parameter of "{PARAMETERS}"'
        given = self._given = read_parameters_of(SteerBotParameters, settings, ros2=False)
        for name, pair in (
            ("virtual_rear_wheels", given.rear_wheels),
            ("virtual_front_wheels", given.front_wheels),
            ("virtual_front_steers", given.front_steers),
        ):
            if len(pair) != 2:
                raise settings.invalid(name, list(pair), "a list of two joints")
        if given.ackermann:
            for name, length in (
                ("wheel_separation_w", given.track),
                ("wheel_separation_h", given.base),
            ):
                if length <= 0:
                    raise settings.invalid(name, length, "positive")

        def actuators(names: Sequence[str], command: str) -> dict[str, JointActuator]:
            # A joint that is listed twice, as published files have it, counts as the right one.
            return {name: _actuator(owner, name, command, origin) for name in dict.fromkeys(names)}

        rear = actuators(given.rear_wheels, "velocity")
        front = actuators(given.front_wheels, "velocity")
        steers = actuators(given.front_steers, "position")
        self._wheels = [*rear.values(), *front.values()]
        self._steers = [*steers.values()]

        def shared(
            name: str, moved: Sequence[JointActuator], commands: tuple[str, ...] = ()
        ) -> _SharedJoint:
            return _SharedJoint(JointInterfaces(name=name, commands=commands, origin=origin), moved)

        self._wheel = shared(given.wheel, [*rear.values()], ("velocity",))
        self._steer = shared(given.steer, self._steers, ("position",))
        own = [
            *(shared(name, [each], ("velocity",)) for name, each in rear.items()),
            *(shared(name, [each]) for name, each in front.items()),
            *(shared(name, [each], ("position",)) for name, each in steers.items()),
        ]
        self._joints = {each.name: each for each in (*own, self._wheel, self._steer)}
        ratio = _turn_ratio(owner.part.description, given)
        owner.part.report(
            robot.SKID_STEERING.diagnostic(
                f'the hardware "{SIM_TYPE}" turns all four wheels at the same speed, in Gazebo as '
                f"well, so they slide in curves, and the robot turns at about {ratio:.0%} of the "
                "rate that the steering angle demands",
                origin=origin,
                values={"hardware": SIM_TYPE, "estimate": ratio},
            )
        )

    def start(self) -> None:
        super().start()
        for each in (*self._wheels, *self._steers):
            each.rest(holds=False)

    def write(self, seconds: float, *, lead: float = 0.0) -> None:
        for wheel in self._wheels:
            wheel.command = self._wheel.command
        angles = self._angles(self._steer.command)
        for joint, angle in zip(self._steers, angles, strict=False):
            joint.command = angle
        for each in (*self._wheels, *self._steers):
            if self.halted:
                each.halt()
            else:
                each.write(seconds, lead)

    def _angles(self, angle: float) -> tuple[float, float]:
        """Returns the angles of the right and the left joint, rad.

        An exact Ackermann linkage would have ``base`` instead of ``2 * base``.
        """
        if not self._given.ackermann:
            return angle, 2 * angle
        tangent, along = math.tan(angle), 2 * self._given.base
        across = self._given.track / 2 * tangent
        return (
            math.atan2(along * tangent, along + across),
            math.atan2(along * tangent, along - across),
        )


def _turn_ratio(description: RobotDescription, given: SteerBotParameters) -> float:
    """The turn rate of a car whose four wheels turn at one speed, relative to the steered one.

    The rims of wheels at the corners of a rectangle of length b and width t demand a turn of
    v a / b by their directions, at the speed v and the small steering angle a, and none by their
    speeds. The slip is least, in the mean of its square, where b (w b - v a) + t w t = 0.
    """
    places = {link.name: link.pose.position for link in description.links}
    children = {joint.name: joint.child for joint in description.joints}
    front, rear = (
        np.array([places[children[name]][:2] for name in pair])
        for pair in (given.front_wheels, given.rear_wheels)
    )
    base = float(np.linalg.norm(front.mean(axis=0) - rear.mean(axis=0)))
    track = float(np.mean([np.linalg.norm(pair[0] - pair[1]) for pair in (front, rear)]))
    return base**2 / (base**2 + track**2) if base > 0 else 1.0


class _SharedJoint(JointHardware):
    """A joint for controllers, whose state is the mean of one or two joints.

    `SteerBotHardware` applies its command.
    """

    def __init__(self, interfaces: JointInterfaces, actuators: Sequence[JointActuator]) -> None:
        # Like a reference, it has no motor of its own.
        vars(self).update(vars(actuators[0]))
        self.name = interfaces.name
        self.interfaces = interfaces
        self._actuators = actuators

    @property
    def position(self) -> float:
        return sum(each.position for each in self._actuators) / len(self._actuators)

    @property
    def velocity(self) -> float:
        return sum(each.velocity for each in self._actuators) / len(self._actuators)

    @property
    def effort(self) -> float:
        return sum(each.effort for each in self._actuators) / len(self._actuators)

    def rest(self, *, holds: bool) -> None:  # noqa: ARG002
        self.command = 0.0

    def write(self, seconds: float, lead: float = 0.0) -> None:
        raise NotImplementedError


def _actuator(owner: Component, name: str, command: str, origin: Origin) -> JointActuator:
    lower, upper = position_range(owner.part.description.joint(name))
    return JointActuator(
        owner.part,
        JointActuatorConfig(
            joint=name,
            commands=(command,),
            limits=JointLimits(lower=lower, upper=upper),
            strength=STRONGEST,
            exceeds_limit=True,
            origin=origin,
        ),
    )
