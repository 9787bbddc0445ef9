"""Inertial measurement units with topics and services."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from cartwheel.component import Scope
from cartwheel.devices.elementwise import Number, cos, sin
from cartwheel.devices.inertial.messages import imu_form
from cartwheel.devices.inertial.unit import InertialUnit, InertialUnitConfig
from cartwheel.devices.noise import DriftingError, DriftingErrorConfig, VectorNoise
from cartwheel.devices.topic_sensor import TopicSensor
from cartwheel.geometry import (
    IDENTITY,
    Array,
    Quat,
    quat_conjugate,
    quat_multiply,
    quat_normalize,
    rotate,
)
from cartwheel.graph import Publisher
from cartwheel.messages import message_class

_IMU = "sensor_msgs/msg/Imu"
_EMPTY = "std_srvs/srv/Empty"
_SET_BIAS = "hector_gazebo_plugins/srv/SetBias"


@dataclass(frozen=True, kw_only=True, slots=True)
class ImuConfig:
    unit: InertialUnitConfig
    """Link, mounting, and noise with a constant bias."""
    topic: str
    """Topic of the measurements."""
    frame: str
    """Frame ID of the messages, without the robot's prefix."""
    rate: float
    """Publish rate, Hz; 0: every step."""
    gravity: bool = True
    """Whether the acceleration includes gravity, as measured by an accelerometer."""
    noise: float = 0.0
    """Standard deviation of additional noise on angular velocity and acceleration, rad/s and
    m/s²."""
    rate_error: DriftingErrorConfig | None = None
    """Further errors of the angular velocity, rad/s."""
    acceleration_error: DriftingErrorConfig | None = None
    """Further errors of the acceleration, m/s²."""
    yaw_error: DriftingErrorConfig | None = None
    """Error of the yaw, rad. The orientation then also has the tilt that the acceleration's error
    causes. None: the orientation has no error."""
    orientation_covariance: Array | None = None
    """Shape (9,). None: computed from the noise."""
    rate_covariance: Array | None = None
    """Shape (9,). None: computed from the noise."""
    acceleration_covariance: Array | None = None
    """Shape (9,). None: computed from the noise."""
    bias_topic: str | None = None
    """Topic of the current errors: offset and drift. None: not published."""
    calibration_service: str | None = None
    """Service (Empty) that removes the drift of the angular velocity, if it has one. None: not
    offered."""
    acceleration_bias_service: str | None = None
    """Service (SetBias) that sets the acceleration's drift. None: not offered."""
    rate_bias_service: str | None = None
    """Service (SetBias) that sets the angular velocity's drift. None: not offered."""


class Imu(TopicSensor):
    """Publishes angular velocity, acceleration and orientation of an IMU on a link.

    Args:
        scope: The IMU's model and names.
        config: Link, topics and errors.

    Raises:
        UnknownNameError: The link does not exist.
    """

    def __init__(self, scope: Scope, config: ImuConfig) -> None:
        super().__init__(scope, config.frame, config.rate)
        part = self.part
        self._config = config
        self._unit = InertialUnit(part, config.unit, origin=self.origin)
        self._acceleration, self._rate, self._yaw = (
            DriftingError(part, error) if error is not None else None
            for error in (config.acceleration_error, config.rate_error, config.yaw_error)
        )
        self._strength = math.hypot(*part.world.gravity)
        self._form = imu_form(self._frame, self._stated_covariances())
        self._publisher = self._offer(config.topic, _IMU)
        self._biases: Publisher | None = None
        if config.bias_topic is not None:
            self._biases = self._offer(config.bias_topic, _IMU, qos="default")
        self._offer_services()

    def reset(self) -> None:
        """Starts new drifts."""
        super().reset()
        for error in (self._acceleration, self._rate, self._yaw):
            if error is not None:
                error.restart()

    def _stated_covariances(self) -> tuple[Array, Array, Array]:
        """Returns the covariances of orientation, angular velocity and acceleration."""
        config, unit = self._config, self._unit
        of_orientation = np.full(3, config.noise**2)
        if self._yaw is not None and self._acceleration is not None:
            tilt = np.array([-1.0, -1.0])
            if self._strength > 0:
                tilt = self._acceleration.variance[:2] / self._strength**2
            of_orientation = np.array([*tilt, self._yaw.variance[0]])
        elif not unit.has_orientation:
            # sensor_msgs/Imu: -1 in the first element marks the orientation as not measured.
            of_orientation = np.array([-1.0, 0.0, 0.0])
        of_rate = _variance(config.noise, unit.rate_noise, self._rate)
        of_acceleration = _variance(config.noise, unit.acceleration_noise, self._acceleration)
        orientation, rate, acceleration = (
            np.diag(variance).ravel() if stated is None else stated
            for stated, variance in (
                (config.orientation_covariance, of_orientation),
                (config.rate_covariance, of_rate),
                (config.acceleration_covariance, of_acceleration),
            )
        )
        return orientation, rate, acceleration

    def _offer_services(self) -> None:
        config = self._config
        if config.calibration_service is not None:
            self.serve(config.calibration_service, _EMPTY, self._calibrate)
        for name, error in (
            (config.acceleration_bias_service, self._acceleration),
            (config.rate_bias_service, self._rate),
        ):
            if name is not None and error is not None:
                self.serve(name, _SET_BIAS, _bias_setter(error))

    def _calibrate(self, _: Any) -> Any:
        if self._rate is not None:
            self._rate.put((0.0, 0.0, 0.0))
        return message_class(f"{_EMPTY}_Response")()

    def _measure(self) -> None:
        config, unit = self._config, self._unit
        orientation, rate, acceleration = unit.measure()
        if not config.gravity:
            fall = rotate(quat_conjugate(orientation), unit.gravity)
            acceleration = [a + b for a, b in zip(acceleration, fall, strict=True)]
        if config.noise > 0:
            random = self.part.random(f"imu {self._publisher.topic}")
            rate = (rate + random.normal(0.0, config.noise, 3)).tolist()
            acceleration = (acceleration + random.normal(0.0, config.noise, 3)).tolist()
        if self._rate is not None:
            rate = self._rate.add(rate)
        if self._acceleration is not None:
            acceleration = self._acceleration.add(acceleration)
        error = IDENTITY
        if self._yaw is not None and self._acceleration is not None:
            error = self._orientation_error(self._yaw, self._acceleration)
            orientation = quat_multiply(error, orientation)
        time_ns = self.part.clock.time_ns
        if self._publisher.wanted:
            self._publisher.publish_values(self._form, (time_ns, orientation, rate, acceleration))
        if self._biases is not None and self._biases.wanted:
            biases = (_bias(self._rate), _bias(self._acceleration))
            self._biases.publish_values(self._form, (time_ns, error, *biases))

    def _orientation_error(self, yaw: DriftingError, acceleration: DriftingError) -> Quat:
        (angle,) = yaw.add([0.0])
        x, y, _ = rotate(self._unit.orientation, acceleration.bias.tolist())
        return quat_normalize(orientation_error(angle, x, y, self._strength or math.inf))


def orientation_error(
    yaw: Number, x: Number, y: Number, gravity: Number
) -> tuple[Number, Number, Number, Number]:
    """Returns the error of an orientation that is estimated from an accelerometer.

    An accelerometer error of b tilts the estimated vertical by b/g. The result is not normalized.

    Args:
        yaw: Error of the yaw, rad.
        x: Error of the acceleration along the world's x axis, m/s².
        y: The same along the y axis, m/s².
        gravity: Gravity g, m/s².
    """
    return quat_multiply(
        (0.0, 0.0, sin(yaw / 2), cos(yaw / 2)), (y / (2 * gravity), -x / (2 * gravity), 0.0, 1.0)
    )


def _variance(noise: float, *errors: VectorNoise | DriftingError | None) -> Array:
    """Returns the variance of three quantities with white noise and further errors."""
    variance = np.full(3, noise**2)
    for error in errors:
        if error is not None:
            variance = variance + error.variance
    return variance


def _bias(error: DriftingError | None) -> Sequence[float]:
    """Returns the current error of three quantities."""
    if error is None:
        return (0.0, 0.0, 0.0)
    bias: list[float] = error.bias.tolist()
    return bias


def _bias_setter(error: DriftingError) -> Callable[[Any], Any]:
    response = message_class(f"{_SET_BIAS}_Response")

    def handle(request: Any) -> Any:
        bias: Sequence[float] = (request.bias.x, request.bias.y, request.bias.z)
        error.put(bias)
        return response()

    return handle
