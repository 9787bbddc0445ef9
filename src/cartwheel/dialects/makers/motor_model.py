"""Multicopter propellers: plugins from rotors_simulator, PX4 and gz-sim."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any, ClassVar, Literal

import numpy as np

from cartwheel.codes import devices, running
from cartwheel.dialects.gz.drive_tags import gz_name
from cartwheel.dialects.plugin import Plugin
from cartwheel.dialects.tags import tag
from cartwheel.geometry import rotate
from cartwheel.messages import message_class

ACTUATORS = "mav_msgs/msg/Actuators"
GZ_ACTUATORS = "actuator_msgs/msg/Actuators"
_FLOAT = "std_msgs/msg/Float32"
SLOWDOWN = 10.0
"""Default ratio of the speed of the propeller to the speed of its joint."""
_NO_MOMENT = (0.0, 0.0, 0.0)


@dataclass(frozen=True, kw_only=True, slots=True)
class _Motor:
    joint: str = tag("jointName", doc="Joint of the propeller.")
    link: str = tag("linkName", doc="Link of the propeller. The thrust acts along its z axis.")
    direction: Literal["cw", "ccw"] = tag(
        "turningDirection", doc="Direction of rotation, seen from above."
    )
    kind: Literal["velocity", "position", "force"] = tag(
        "motorType", default="velocity", doc="Command type; only `velocity` is supported."
    )
    motor_constant: float = tag(
        "motorConstant",
        default=8.54858e-06,
        unit="N s²/rad²",
        doc="Thrust divided by the square of the propeller's speed.",
    )
    moment_constant: float = tag(
        "momentConstant",
        default=0.016,
        unit="m",
        doc="Torque on the parent link divided by the thrust.",
    )
    up: float = tag(
        "timeConstantUp", default=1 / 80, unit="s", doc="Time constant while the speed increases."
    )
    down: float = tag(
        "timeConstantDown", default=1 / 40, unit="s", doc="Time constant while the speed decreases."
    )
    drag: float = tag(
        "rotorDragCoefficient",
        default=1e-4,
        unit="N s²/(m rad)",
        doc="Drag force divided by the propeller's speed and by the airspeed perpendicular "
        "to its axis.",
    )
    rolling: float = tag(
        "rollingMomentCoefficient",
        default=1e-6,
        unit="N s²/rad",
        doc="Rolling moment divided by the propeller's speed and by the airspeed "
        "perpendicular to its axis.",
    )
    slowdown: float = tag(
        "rotorVelocitySlowdownSim",
        default=SLOWDOWN,
        doc="Speed of the propeller divided by the speed of the joint.",
    )


class _MotorModel(Plugin[Any]):
    """Turns a joint as commanded. Applies thrust and drag to its link, moments to the parent."""

    def _start(self, *, topic: str, kind: str, field: str, number: int, fastest: float) -> None:
        config: _Motor = self.config
        part, origin = self.part, self.tag.origin
        self.check_above_zero(
            timeConstantUp=config.up,
            timeConstantDown=config.down,
            rotorVelocitySlowdownSim=config.slowdown,
            maxRotVelocity=fastest,
        )
        self.check_not_negative("number")
        joint = part.description.joint(config.joint)
        self._joint = part.joint(config.joint, origin=origin)
        assert joint is not None
        self._axis = rotate(joint.pose.orientation, joint.axis.xyz)
        self._link = part.link(config.link, origin=origin)
        self._push = part.wrench(config.link)
        self._twist = part.wrench(joint.parent, origin=origin)
        self._sense = 1.0 if config.direction == "ccw" else -1.0
        self._number, self._field, self._fastest = number, field, fastest
        self.reset()
        if config.kind != "velocity":
            self.warn(
                devices.PLUGIN_PARAMETER_UNSUPPORTED,
                f'<motorType> "{config.kind}" is not supported, so the joint is not driven',
                values={"parameter": "motorType", "value": config.kind},
            )
            return
        self._motor = part.velocity_motor(config.joint, max_effort=None)
        self.subscribe(topic, kind, self._on_command)
        part.schedule(0, before=self._turn)

    def reset(self) -> None:
        self._wanted = self._speed = 0.0
        self._before_ns = self.part.time_ns
        self._push.forget()
        self._twist.forget()

    def _on_command(self, message: Any) -> None:
        speeds = getattr(message, self._field)
        if self._number >= len(speeds):
            self.warn(
                running.COMMAND_IGNORED,
                f"a command is ignored: it has only {len(speeds)} speeds, so none for motor "
                f"{self._number}",
                values={"speeds": len(speeds), "motor": self._number},
            )
            return
        self._wanted = min(float(speeds[self._number]), self._fastest)

    def _thrust(self, speed: float) -> float:
        """Returns the thrust in N along the link's z axis, at a joint speed in rad/s."""
        return self._sense * math.copysign(speed * speed, speed) * float(self.config.motor_constant)

    def _left(self, _along: float) -> float:
        """Returns the remaining fraction of the thrust at a velocity along the axis in m/s."""
        return 1.0

    def _rolling(self) -> float:
        return float(self.config.rolling)

    def _turn(self) -> None:
        config: _Motor = self.config
        part = self.part
        part.locate()
        speed = self._joint.velocity * config.slowdown
        _, turned = self._link.place()
        axis = np.array(rotate(turned, self._axis))
        velocity = np.array(self._link.motion(local=False)[0])
        along = float(velocity @ axis)
        across = velocity - along * axis
        thrust = self._thrust(speed)
        up = np.array(rotate(turned, (0.0, 0.0, 1.0)))
        drag = -abs(speed) * config.drag * across
        roll = -abs(speed) * self._rolling() * across
        twist = -self._sense * thrust * config.moment_constant * up + roll
        self._push.apply((self._left(along) * thrust * up + drag).tolist(), _NO_MOMENT)
        self._twist.apply(_NO_MOMENT, twist.tolist())
        now = part.time_ns
        seconds, self._before_ns = (now - self._before_ns) * 1e-9, now
        constant = config.up if self._wanted > self._speed else config.down
        self._speed += (self._wanted - self._speed) * -math.expm1(-seconds / constant)
        self._motor.command(self._sense * self._speed / config.slowdown)


@dataclass(frozen=True, kw_only=True, slots=True)
class RotorsMotorParameters(_Motor):
    number: int = tag(
        "motorNumber", default=0, doc="Index of the motor's speed in the commands, from 0."
    )
    topic: str = tag(
        "commandSubTopic",
        default="command/motor_speed",
        doc="Topic of the Actuators commands, with speeds in rad/s.",
    )
    speed_topic: str = tag(
        "motorSpeedPubTopic",
        default="motor_speed",
        doc="Topic of the joint's velocity in rad/s. The propeller's velocity is "
        "`<rotorVelocitySlowdownSim>` times larger.",
    )
    position_topic: str = tag(
        "motorPositionPubTopic",
        default="",
        doc="Topic of the joint's angle in rad. Not published if empty.",
    )
    fastest: float = tag(
        "maxRotVelocity", default=838.0, unit="rad/s", doc="Maximum speed of the propeller."
    )


class RotorsMotorModel(_MotorModel):
    """Simulates the thrust, drag and rolling moment of a propeller.

    The thrust is proportional to the square of the propeller's speed. Wind is not simulated.
    Original plugin: ``gazebo_motor_model`` in the package ``rotors_gazebo_plugins``.
    """

    filenames: ClassVar[tuple[str, ...]] = ("librotors_gazebo_motor_model.so",)
    parameters: ClassVar[type] = RotorsMotorParameters

    def configure(self) -> None:
        config: RotorsMotorParameters = self.config
        self._start(
            topic=config.topic, kind=ACTUATORS, field="angular_velocities",
            number=config.number, fastest=config.fastest,
        )  # fmt: skip
        self._Float32 = message_class(_FLOAT)
        # The topic ends with the motor's number, which is not a valid name in ROS 2.
        self._outputs = [
            (self.advertise(gz_name(self, f"{self.namespace}/{topic}", ""), _FLOAT), what)
            for topic, what in (
                (config.speed_topic, "velocity"),
                (config.position_topic, "position"),
            )
            if topic
        ]
        self.part.schedule(
            0, after=self._publish, active=lambda: any(each.wanted for each, _ in self._outputs)
        )

    def _publish(self) -> None:
        for publisher, what in self._outputs:
            if publisher.wanted:
                publisher.publish(self._Float32(getattr(self._joint, what)))


@dataclass(frozen=True, kw_only=True, slots=True)
class Px4MotorParameters(_Motor):
    number: int = tag(
        "motorNumber", default=0, doc="Index of the motor's speed in the commands, from 0."
    )
    topic: str = tag(
        "commandSubTopic",
        default="/gazebo/command/motor_speed",
        doc="Topic of the Actuators commands, with speeds in rad/s. The model's name is prepended.",
    )
    fastest: float = tag(
        "maxRotVelocity", default=838.0, unit="rad/s", doc="Maximum speed of the propeller."
    )
    airspeed: float = tag(
        "maxRelativeAirspeed",
        default=25.0,
        unit="m/s",
        doc="Velocity along the axis at which the thrust becomes 0.",
    )
    reversible: bool = tag("reversible", default=False, doc="Allow negative thrust.")


class Px4MotorModel(_MotorModel):
    """Simulates a PX4 propeller, whose thrust decreases with airspeed.

    Commands are received as mav_msgs/Actuators messages instead of through PX4's own protocol.
    Original plugin: ``gazebo_motor_model`` in ``PX4-SITL_gazebo-classic``.
    """

    filenames: ClassVar[tuple[str, ...]] = ("libgazebo_motor_model.so",)
    parameters: ClassVar[type] = Px4MotorParameters

    def configure(self) -> None:
        config: Px4MotorParameters = self.config
        self.check_above_zero(maxRelativeAirspeed=config.airspeed)
        self._start(
            topic=gz_name(self, f"{self.part.name}/{config.topic.strip('/')}", ""),
            kind=ACTUATORS, field="angular_velocities",
            number=config.number, fastest=config.fastest,
        )  # fmt: skip

    def _thrust(self, speed: float) -> float:
        config: Px4MotorParameters = self.config
        force = math.copysign(speed * speed, speed) * config.motor_constant
        return force if config.reversible else abs(force)

    def _left(self, along: float) -> float:
        return min(max(1 - abs(along) / float(self.config.airspeed), 0.0), 1.0)

    def _rolling(self) -> float:
        return self._sense * float(self.config.rolling)


@dataclass(frozen=True, kw_only=True, slots=True)
class GzMotorParameters(_Motor):
    number: int = tag(
        "actuator_number",
        "motorNumber",
        doc="Index of the motor's speed in the commands, from 0.",
    )
    topic: str = tag(
        "commandSubTopic",
        default="",
        doc="Topic of the Actuators commands, with speeds in rad/s. Its namespace is "
        "`<robotNamespace>`, or else the model's name.",
    )
    fastest: float = tag(
        "maxRotVelocity", default=838.0, unit="rad/s", doc="Maximum speed of the propeller."
    )


class GzMotorModel(_MotorModel):
    """Simulates the thrust, drag and rolling moment of a propeller.

    The thrust is proportional to the square of the propeller's speed. Original plugin:
    ``MulticopterMotorModel`` in gz-sim.
    """

    filenames: ClassVar[tuple[str, ...]] = ("gz-sim-multicopter-motor-model-system",)
    parameters: ClassVar[type] = GzMotorParameters

    def configure(self) -> None:
        config: GzMotorParameters = self.config
        over = self.namespace or self.part.name
        self._start(
            topic=gz_name(self, f"{over}/{config.topic.strip()}".rstrip("/"), ""),
            kind=GZ_ACTUATORS, field="velocity",
            number=config.number, fastest=config.fastest,
        )  # fmt: skip
