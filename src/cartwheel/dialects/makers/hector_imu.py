"""``libhector_gazebo_ros_imu.so``: an inertial measurement unit with drift."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np

from cartwheel.devices.noise import DriftingError
from cartwheel.dialects.plugin import Plugin
from cartwheel.dialects.tags import tag
from cartwheel.geometry import (
    Pose,
    matrix_from_quat,
    quat_from_rpy,
    quat_multiply,
    quat_normalize,
    rotate,
)
from cartwheel.messages import header, message_class

_NONE = (0.0, 0.0, 0.0)
_HOUR = 1 / 3600.0


@dataclass(frozen=True, kw_only=True, slots=True)
class HectorImuParameters:
    body: str = tag("bodyName", default="", doc="Link of the IMU. Default: the root link.")
    topic: str = tag("topicName", default="imu", doc="Topic of the Imu messages.")
    bias_topic: str | None = tag(
        "biasTopicName",
        default=None,
        doc="Topic of the current errors (Imu). Default: `<topic>/bias`.",
    )
    service: str | None = tag(
        "serviceName",
        default=None,
        doc="Service (Empty) that removes the drift of the angular velocity. Default: "
        "`<topic>/calibrate`.",
    )
    frame: str = tag("frameId", default="", doc="Frame ID of the messages. Default: the link.")
    update_rate: float = tag(
        "updateRate", default=0.0, unit="Hz", doc="Publish rate. 0: every step."
    )
    xyz_offset: tuple[float, float, float] = tag(
        "xyzOffset",
        "xyzOffsets",
        default=_NONE,
        unit="m",
        doc="Position of the IMU in the link frame.",
    )
    rpy_offset: tuple[float, float, float] = tag(
        "rpyOffset",
        "rpyOffsets",
        default=_NONE,
        unit="rad",
        doc="Orientation of the IMU in the link frame, as roll, pitch, yaw.",
    )
    noise: float = tag(
        "gaussianNoise",
        default=0.0,
        doc="Standard deviation of the noise on angular velocity and acceleration. If positive, "
        "it overrides `<accelGaussianNoise>` and `<rateGaussianNoise>`.",
    )
    accel_offset: tuple[float, float, float] = tag(
        "accelOffset", default=_NONE, unit="m/s²", doc="Constant error of the acceleration."
    )
    accel_drift: tuple[float, float, float] = tag(
        "accelDrift",
        default=_NONE,
        unit="m/s²",
        doc="Standard deviation of the acceleration's drift.",
    )
    accel_frequency: tuple[float, float, float] = tag(
        "accelDriftFrequency",
        default=(_HOUR,) * 3,
        unit="1/s",
        doc="Inverse of the time constant of the acceleration's drift.",
    )
    accel_noise: tuple[float, float, float] = tag(
        "accelGaussianNoise",
        default=_NONE,
        unit="m/s²",
        doc="Standard deviation of the acceleration's noise.",
    )
    accel_scale: tuple[float, float, float] = tag(
        "accelScaleError", default=(1.0,) * 3, doc="Scale factor on the acceleration."
    )
    rate_offset: tuple[float, float, float] = tag(
        "rateOffset", default=_NONE, unit="rad/s", doc="Constant error of the angular velocity."
    )
    rate_drift: tuple[float, float, float] = tag(
        "rateDrift",
        default=_NONE,
        unit="rad/s",
        doc="Standard deviation of the angular velocity's drift.",
    )
    rate_frequency: tuple[float, float, float] = tag(
        "rateDriftFrequency",
        default=(_HOUR,) * 3,
        unit="1/s",
        doc="Inverse of the time constant of the angular velocity's drift.",
    )
    rate_noise: tuple[float, float, float] = tag(
        "rateGaussianNoise",
        default=_NONE,
        unit="rad/s",
        doc="Standard deviation of the angular velocity's noise.",
    )
    rate_scale: tuple[float, float, float] = tag(
        "rateScaleError", default=(1.0,) * 3, doc="Scale factor on the angular velocity."
    )
    yaw_offset: float = tag(
        "yawOffset", "headingOffset", default=0.0, unit="rad", doc="Constant error of the yaw."
    )
    yaw_drift: float = tag(
        "yawDrift",
        "headingDrift",
        default=0.0,
        unit="rad",
        doc="Standard deviation of the yaw's drift.",
    )
    yaw_frequency: float = tag(
        "yawDriftFrequency",
        "headingDriftFrequency",
        default=_HOUR,
        unit="1/s",
        doc="Inverse of the time constant of the yaw's drift.",
    )
    yaw_noise: float = tag(
        "yawGaussianNoise",
        "headingGaussianNoise",
        default=0.0,
        unit="rad",
        doc="Standard deviation of the yaw's noise.",
    )
    yaw_scale: float = tag(
        "yawScaleError",
        "headingScaleError",
        default=1.0,
        doc="No effect.",
    )


class HectorImu(Plugin[HectorImuParameters]):
    """Publishes angular velocity, acceleration and orientation of a link, with noise and drift.

    The acceleration includes the reaction to gravity. Each quantity has a constant offset, a slow
    drift and noise. Acceleration and angular velocity also have a scale factor. As in the original
    plugin, the acceleration error also tilts the orientation. The services
    ``<topic>/set_accel_bias`` and ``<topic>/set_rate_bias`` set the current drift of the
    acceleration and of the angular velocity. Original plugin: ``gazebo_ros_imu`` in the package
    ``hector_gazebo_plugins``. See also REP 145.
    """

    filenames: ClassVar[tuple[str, ...]] = (
        "libhector_gazebo_ros_imu.so",
        "hector_gazebo_ros_imu",
    )
    parameters: ClassVar[type] = HectorImuParameters

    def configure(self) -> None:
        config, part, origin = self.config, self.part, self.tag.origin
        self.check_not_negative(
            "update_rate", "noise",
            "accel_drift", "accel_frequency", "accel_noise",
            "rate_drift", "rate_frequency", "rate_noise",
            "yaw_drift", "yaw_frequency", "yaw_noise",
        )  # fmt: skip
        name = config.body or part.description.canonical_link
        self._link = part.link(name, origin=origin)
        self._mount = Pose(config.xyz_offset, quat_from_rpy(*config.rpy_offset))
        self._turn = matrix_from_quat(self._mount.orientation).T
        self._frame = self.frame(config.frame or name)
        both = (config.noise,) * 3
        self._accel = self._error(
            "accel",
            (config.accel_offset, config.accel_drift, config.accel_frequency),
            both if config.noise > 0 else config.accel_noise,
            config.accel_scale,
        )
        self._rate = self._error(
            "rate",
            (config.rate_offset, config.rate_drift, config.rate_frequency),
            both if config.noise > 0 else config.rate_noise,
            config.rate_scale,
        )
        self._yaw = self._error(
            "yaw",
            ((config.yaw_offset,), (config.yaw_drift,), (config.yaw_frequency,)),
            (config.yaw_noise,),
            (1.0,),
        )
        self._Imu = message_class("sensor_msgs/msg/Imu")
        self._Vector3 = message_class("geometry_msgs/msg/Vector3")
        self._Quaternion = message_class("geometry_msgs/msg/Quaternion")
        gravity = math.hypot(*part.world.gravity)
        tilt = self._accel.variance / gravity**2 if gravity > 0 else np.array([-1.0, -1.0, 0.0])
        self._gravity = gravity
        self._covariances = [
            np.diag([tilt[0], tilt[1], self._yaw.variance[0]]).ravel(),
            np.diag(self._rate.variance).ravel(),
            np.diag(self._accel.variance).ravel(),
        ]
        self._offer()

    def _offer(self) -> None:
        config = self.config
        rate = config.update_rate
        self._publisher = self.advertise(
            config.topic, "sensor_msgs/msg/Imu", rate=rate or None, qos="sensor"
        )
        bias = f"{config.topic}/bias" if config.bias_topic is None else config.bias_topic
        self._biases = self.advertise(bias, "sensor_msgs/msg/Imu", rate=rate or None)
        service = f"{config.topic}/calibrate" if config.service is None else config.service
        self.serve(service, "std_srvs/srv/Empty", self._calibrate)
        for name, error in (("accel", self._accel), ("rate", self._rate)):
            self.serve(
                f"{config.topic}/set_{name}_bias",
                "hector_gazebo_plugins/srv/SetBias",
                self._setter(error),
            )
        self.part.schedule(
            rate,
            after=self._measure,
            active=lambda: self._publisher.wanted or self._biases.wanted,
        )

    def _error(
        self, name: str, drift: tuple[Any, Any, Any], noise: Any, scale: Any
    ) -> DriftingError:
        offset, deviation, frequency = drift
        # In the original plugin, the standard deviation of the drift depends on the step length.
        return DriftingError(
            self.part,
            f"imu {self.config.topic} {name}",
            rate=self.config.update_rate,
            offset=offset,
            drift=deviation,
            frequency=frequency,
            noise=noise,
            scale=scale,
        )

    def reset(self) -> None:
        for error in (self._accel, self._rate, self._yaw):
            error.restart()

    def _calibrate(self, _: Any) -> Any:
        self._rate.put((0.0, 0.0, 0.0))
        return message_class("std_srvs/srv/Empty_Response")()

    @staticmethod
    def _setter(error: DriftingError) -> Any:
        response = message_class("hector_gazebo_plugins/srv/SetBias_Response")

        def handle(request: Any) -> Any:
            error.put((request.bias.x, request.bias.y, request.bias.z))
            return response()

        return handle

    def _measure(self) -> None:
        _, turned = self._link.place()
        _, turning = self._link.motion(local=True)
        accel = self._accel.add(self._turn @ self._link.proper_acceleration(self._mount.position))
        rate = self._rate.add(self._turn @ np.array(turning))
        mounted = quat_multiply(turned, self._mount.orientation)
        # An accelerometer error of b tilts the estimated vertical by b/g.
        bias = self._accel.bias.tolist()
        x, y, _ = rotate(mounted, bias)
        g = self._gravity or math.inf
        yaw = float(self._yaw.add([0.0])[0])
        error = quat_multiply(
            (0.0, 0.0, math.sin(yaw / 2), math.cos(yaw / 2)), (y / (2 * g), -x / (2 * g), 0.0, 1.0)
        )
        head = header(self.part.time_ns, self._frame)
        if self._publisher.wanted:
            self._publisher.publish(
                self._imu(head, quat_multiply(quat_normalize(error), mounted), rate, accel)
            )
        if self._biases.wanted:
            self._biases.publish(
                self._imu(head, quat_normalize(error), self._rate.bias, self._accel.bias)
            )

    def _imu(self, head: Any, turn: Any, rate: Any, accel: Any) -> Any:
        of_turn, of_rate, of_accel = self._covariances
        return self._Imu(
            head,
            self._Quaternion(*turn),
            of_turn,
            self._Vector3(*rate.tolist()),
            of_rate,
            self._Vector3(*accel.tolist()),
            of_accel,
        )
