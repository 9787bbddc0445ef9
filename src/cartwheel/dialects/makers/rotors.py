"""Plugins from rotors_simulator for multicopters: command relay, motor states, IMU."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np

from cartwheel.devices.noise import DriftingError
from cartwheel.dialects.classic.imu import ImuBase
from cartwheel.dialects.makers.motor_model import ACTUATORS, SLOWDOWN
from cartwheel.dialects.plugin import Plugin
from cartwheel.dialects.tags import tag
from cartwheel.geometry import Pose
from cartwheel.messages import header, message_class

_ROTOR = "rotor_"


@dataclass(frozen=True, kw_only=True, slots=True)
class RotorsControllerParameters:
    command_topic: str = tag(
        "commandMotorSpeedSubTopic",
        default="command/motor_speed",
        doc="Topic of the Actuators commands, with the speeds of all motors.",
    )
    motor_topic: str = tag(
        "motorSpeedCommandPubTopic",
        default="gazebo/command/motor_speed",
        doc="Topic on which commands are relayed to the motors.",
    )
    attitude_topic: str = tag(
        "commandAttitudeThrustSubTopic",
        default="",
        doc="No effect, as in Gazebo: the plugin does not subscribe to this topic.",
    )
    rate_topic: str = tag(
        "commandRateThrustSubTopic",
        default="",
        doc="No effect, as in Gazebo: the plugin does not subscribe to this topic.",
    )
    imu_topic: str = tag(
        "imuSubTopic",
        default="",
        doc="No effect, as in Gazebo: the plugin does not subscribe to this topic.",
    )


class RotorsController(Plugin[RotorsControllerParameters]):
    """Relays motor speed commands to the motors.

    Original plugin: ``gazebo_controller_interface`` in the package ``rotors_gazebo_plugins``.
    """

    filenames: ClassVar[tuple[str, ...]] = ("librotors_gazebo_controller_interface.so",)
    parameters: ClassVar[type] = RotorsControllerParameters

    def configure(self) -> None:
        self._Actuators = message_class(ACTUATORS)
        self._motors = self.advertise(self.config.motor_topic, ACTUATORS)
        self.subscribe(self.config.command_topic, ACTUATORS, self._on_command)

    def _on_command(self, message: Any) -> None:
        none = np.zeros(0)
        moment = header(self.part.time_ns, "")
        self._motors.publish(self._Actuators(moment, none, message.angular_velocities, none))


@dataclass(frozen=True, kw_only=True, slots=True)
class RotorsBaseParameters:
    link: str = tag("linkName", doc="Link that carries the propellers.")
    topic: str = tag(
        "motorPubTopic", default="motor_speed", doc="Topic of the speeds of the propellers."
    )
    joint_topic: str = tag(
        "jointStatePubTopic", default="joint_states", doc="Topic of the propeller joints' angles."
    )
    slowdown: float = tag(
        "rotorVelocitySlowdownSim",
        default=SLOWDOWN,
        doc="Speed of the propellers divided by the speed of their joints.",
    )


class RotorsBase(Plugin[RotorsBaseParameters]):
    """Publishes the speeds and angles of the propellers at every step.

    Propellers are the links named ``…rotor_<number>`` at movable joints of ``<linkName>``. Original
    plugin: ``gazebo_multirotor_base_plugin`` in the package ``rotors_gazebo_plugins``.
    """

    filenames: ClassVar[tuple[str, ...]] = ("librotors_gazebo_multirotor_base_plugin.so",)
    parameters: ClassVar[type] = RotorsBaseParameters

    def configure(self) -> None:
        config, part, origin = self.config, self.part, self.tag.origin
        self.check_above_zero(rotorVelocitySlowdownSim=config.slowdown)
        part.link(config.link, origin=origin)
        joints = {}
        for joint in part.description.joints:
            _, mark, number = joint.child.partition(_ROTOR)
            if mark and number.isdigit() and joint.parent == config.link and joint.drivable:
                joints[int(number)] = part.joint(joint.name, origin=origin)
        self._joints = [joints[number] for number in sorted(joints)]
        self._frame = self.frame(config.link)
        self._Actuators = message_class(ACTUATORS)
        self._JointState = message_class("sensor_msgs/msg/JointState")
        self._speeds = self.advertise(config.topic, ACTUATORS)
        self._states = self.advertise(config.joint_topic, "sensor_msgs/msg/JointState")
        part.schedule(
            0, after=self._publish, active=lambda: self._speeds.wanted or self._states.wanted
        )

    def _publish(self) -> None:
        moment, none = header(self.part.time_ns, self._frame), np.zeros(0)
        if self._speeds.wanted:
            speeds = np.array([joint.velocity * self.config.slowdown for joint in self._joints])
            self._speeds.publish(self._Actuators(moment, none, speeds, none))
        if self._states.wanted:
            names = [joint.name for joint in self._joints]
            angles = np.array([joint.position for joint in self._joints])
            self._states.publish(self._JointState(moment, names, angles, none, none))


@dataclass(frozen=True, kw_only=True, slots=True)
class RotorsImuParameters:
    link: str = tag("linkName", doc="Link that carries the IMU, and frame ID of the messages.")
    topic: str = tag("imuTopic", default="imu", doc="Topic of the Imu messages.")
    rate_noise: float = tag(
        "gyroscopeNoiseDensity",
        default=math.radians(70 / 3600),
        unit="rad/s/√Hz",
        doc="Noise density of the angular velocity.",
    )
    rate_walk: float = tag(
        "gyroscopeBiasRandomWalk",
        "gyroscopeRandomWalk",
        default=math.radians(8 / 3600),
        unit="rad/s²/√Hz",
        doc="Random walk of the gyroscope bias.",
    )
    rate_time: float = tag(
        "gyroscopeBiasCorrelationTime",
        default=1000.0,
        unit="s",
        doc="Correlation time of the gyroscope bias.",
    )
    rate_bias: float = tag(
        "gyroscopeTurnOnBiasSigma",
        default=math.radians(0.5),
        unit="rad/s",
        doc="Standard deviation of the constant gyroscope bias.",
    )
    accel_noise: float = tag(
        "accelerometerNoiseDensity",
        default=4e-3,
        unit="m/s²/√Hz",
        doc="Noise density of the acceleration.",
    )
    accel_walk: float = tag(
        "accelerometerRandomWalk",
        default=6e-3,
        unit="m/s³/√Hz",
        doc="Random walk of the accelerometer bias.",
    )
    accel_time: float = tag(
        "accelerometerBiasCorrelationTime",
        default=300.0,
        unit="s",
        doc="Correlation time of the accelerometer bias.",
    )
    accel_bias: float = tag(
        "accelerometerTurnOnBiasSigma",
        default=0.196,
        unit="m/s²",
        doc="Standard deviation of the constant accelerometer bias.",
    )


class RotorsImu(ImuBase):
    """Publishes the measurements of an IMU at every step, with white noise and drifting biases.

    Noise densities are converted to standard deviations for the step length. The bias is the sum of
    a constant and a random walk, which starts from its stationary distribution. Original plugin:
    ``gazebo_imu_plugin`` in the package ``rotors_gazebo_plugins``. See also REP 145.
    """

    filenames: ClassVar[tuple[str, ...]] = ("librotors_gazebo_imu_plugin.so",)
    parameters: ClassVar[type] = RotorsImuParameters

    def configure(self) -> None:
        config: RotorsImuParameters = self.config
        self.check_above_zero(
            gyroscopeBiasCorrelationTime=config.rate_time,
            accelerometerBiasCorrelationTime=config.accel_time,
        )
        self._errors = (
            self._error("rate", config.rate_noise, config.rate_walk, config.rate_time,
                        config.rate_bias),
            self._error("accel", config.accel_noise, config.accel_walk, config.accel_time,
                        config.accel_bias),
        )  # fmt: skip
        self.start(
            link=config.link, mount=Pose(), topic=config.topic, frame=config.link,
            noise=0.0, rate=0.0,
        )  # fmt: skip
        self._orientation_covariance = np.full(9, -1.0)
        self._rate_covariance = np.diag([config.rate_noise**2] * 3).ravel()
        self._accel_covariance = np.diag([config.accel_noise**2] * 3).ravel()

    def reset(self) -> None:
        for error in self._errors:
            error.restart()

    def _error(
        self, kind: str, density: float, walk: float, time: float, bias: float
    ) -> DriftingError:
        self.check_not_negative(f"{kind}_noise", f"{kind}_walk", f"{kind}_bias")
        part = self.part
        name = f"rotors imu {self.tag.name} {kind}"
        seconds = part.period_ns(0) * 1e-9
        return DriftingError(
            part,
            name,
            rate=0.0,
            offset=part.random(f"{name} bias").normal(0.0, bias, 3).tolist(),
            drift=[walk * math.sqrt(time / 2)] * 3,
            frequency=[1 / time] * 3,
            noise=[density / math.sqrt(seconds)] * 3,
            scale=[1.0] * 3,
        )

    def _blurred(
        self, rate: Sequence[float], acceleration: Sequence[float]
    ) -> tuple[Sequence[float], Sequence[float]]:
        one, two = self._errors
        return one.add(rate).tolist(), two.add(acceleration).tolist()
