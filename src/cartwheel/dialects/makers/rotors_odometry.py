"""``librotors_gazebo_odometry_plugin.so``: the measured pose of a multicopter's link."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np

from cartwheel.codes import devices
from cartwheel.devices.drives.odometry import Odometry, OdometryConfig
from cartwheel.dialects.plugin import Plugin
from cartwheel.dialects.tags import tag
from cartwheel.errors import PluginError
from cartwheel.geometry import Array, Quat, quat_multiply, quat_normalize
from cartwheel.messages import header, message_class

_NONE = (0.0, 0.0, 0.0)


@dataclass(frozen=True, kw_only=True, slots=True)
class RotorsOdometryParameters:
    link: str = tag("linkName", doc="Link whose pose is published.")
    pose_topic: str = tag("poseTopic", default="pose", doc="Topic of the Pose messages.")
    with_topic: str = tag(
        "poseWithCovarianceTopic",
        default="pose_with_covariance",
        doc="Topic of the PoseWithCovarianceStamped messages.",
    )
    position_topic: str = tag(
        "positionTopic", default="position", doc="Topic of the PointStamped messages."
    )
    transform_topic: str = tag(
        "transformTopic", default="transform", doc="Topic of the TransformStamped messages."
    )
    odometry_topic: str = tag("odometryTopic", default="odometry", doc="Topic of the odometry.")
    parent: str = tag(
        "parentFrameId", default="world", doc="Reference frame; only `world` is supported."
    )
    child: str = tag(
        "childFrameId", default="odometry_sensor", doc="Child frame ID of the messages."
    )
    divisor: int = tag(
        "measurementDivisor", default=1, doc="Number of simulation steps per message."
    )
    delay: int = tag(
        "measurementDelay", default=0, doc="No effect: measurements are published immediately."
    )
    unknown_delay: float = tag(
        "unknownDelay", default=0.0, unit="s", doc="Delay added to the stamps."
    )
    normal_position: tuple[float, float, float] = tag(
        "noiseNormalPosition",
        default=_NONE,
        unit="m",
        doc="Standard deviation of Gaussian noise on the position.",
    )
    normal_turn: tuple[float, float, float] = tag(
        "noiseNormalQuaternion",
        default=_NONE,
        unit="rad",
        doc="Standard deviation of Gaussian noise on the orientation.",
    )
    normal_linear: tuple[float, float, float] = tag(
        "noiseNormalLinearVelocity",
        default=_NONE,
        unit="m/s",
        doc="Standard deviation of Gaussian noise on the linear velocity.",
    )
    normal_angular: tuple[float, float, float] = tag(
        "noiseNormalAngularVelocity",
        default=_NONE,
        unit="rad/s",
        doc="Standard deviation of Gaussian noise on the angular velocity.",
    )
    uniform_position: tuple[float, float, float] = tag(
        "noiseUniformPosition",
        default=_NONE,
        unit="m",
        doc="Uniform noise on the position is within ± this value.",
    )
    uniform_turn: tuple[float, float, float] = tag(
        "noiseUniformQuaternion",
        default=_NONE,
        unit="rad",
        doc="Uniform noise on the orientation is within ± this value.",
    )
    uniform_linear: tuple[float, float, float] = tag(
        "noiseUniformLinearVelocity",
        default=_NONE,
        unit="m/s",
        doc="Uniform noise on the linear velocity is within ± this value.",
    )
    uniform_angular: tuple[float, float, float] = tag(
        "noiseUniformAngularVelocity",
        default=_NONE,
        unit="rad/s",
        doc="Uniform noise on the angular velocity is within ± this value.",
    )


class RotorsOdometry(Plugin[RotorsOdometryParameters]):
    """Publishes a link's noisy pose in the world, as five message types and a transform.

    The twist in the Odometry messages is in the link frame. Original plugin:
    ``gazebo_odometry_plugin`` in the package ``rotors_gazebo_plugins``.
    """

    filenames: ClassVar[tuple[str, ...]] = ("librotors_gazebo_odometry_plugin.so",)
    parameters: ClassVar[type] = RotorsOdometryParameters

    def configure(self) -> None:
        config, part, origin = self.config, self.part, self.tag.origin
        if config.parent != "world":
            raise PluginError(
                f'<parentFrameId> "{config.parent}" is not supported: only "world" is',
                code=devices.PLUGIN_PARAMETER_UNSUPPORTED,
                origin=self.place_of("parentFrameId"),
                values={"parameter": "parentFrameId", "value": config.parent},
            )
        self.check_above_zero(measurementDivisor=config.divisor)
        normal = [config.normal_position, config.normal_turn, config.normal_linear,
                  config.normal_angular]  # fmt: skip
        uniform = [config.uniform_position, config.uniform_turn, config.uniform_linear,
                   config.uniform_angular]  # fmt: skip
        self._normal, self._uniform = np.array(normal).ravel(), np.array(uniform).ravel()
        self.check_not_negative(
            "normal_position", "normal_turn", "normal_linear", "normal_angular",
            "uniform_position", "uniform_turn", "uniform_linear", "uniform_angular",
        )  # fmt: skip
        if config.delay:
            self.warn(
                devices.PLUGIN_PARAMETER_IGNORED,
                "<measurementDelay> has no effect: measurements are published immediately",
                values={"parameter": "measurementDelay"},
            )
        self._link = part.link(config.link, origin=origin)
        self._frames = self.frame(config.parent), self.frame(config.child)
        variance = self._normal**2
        self._covariance = np.diag(variance[:6]).ravel()
        self._odometry = self.add(
            Odometry(
                self.scope,
                OdometryConfig(
                    topic=config.odometry_topic,
                    frame=config.parent,
                    base=config.child,
                    transform=True,
                    pose_covariance=self._covariance,
                    twist_covariance=np.diag(variance[6:]).ravel(),
                ),
            )
        )
        self._classes = {
            name: message_class(f"geometry_msgs/msg/{name}")
            for name in ("Pose", "Point", "Quaternion", "PoseWithCovariance", "Vector3",
                         "PoseWithCovarianceStamped", "PointStamped", "Transform",
                         "TransformStamped")
        }  # fmt: skip
        self._others = {
            kind: self.advertise(topic, f"geometry_msgs/msg/{kind}")
            for topic, kind in (
                (config.pose_topic, "Pose"),
                (config.with_topic, "PoseWithCovarianceStamped"),
                (config.position_topic, "PointStamped"),
                (config.transform_topic, "TransformStamped"),
            )
        }
        self._steps = 0
        part.schedule(0, after=self._count)

    def reset(self) -> None:
        self._steps = 0

    def _count(self) -> None:
        if self._steps % self.config.divisor == 0:
            self._publish()
        self._steps += 1

    def _publish(self) -> None:
        wanted = {kind for kind, publisher in self._others.items() if publisher.wanted}
        if not wanted and not self._odometry.wanted():
            return
        place, turn = self._link.place()
        linear, angular = self._link.motion(local=True)
        error = self._error()
        x, y, z = np.add(place, error[:3]).tolist()
        turn = _tilted(turn, error[3:6])
        wx, wy, wz = np.add(angular, error[9:]).tolist()
        now = self.part.time_ns + round(self.config.unknown_delay * 1e9)
        self._odometry.publish(
            now, (x, y, z), turn, np.add(linear, error[6:9]).tolist(), (wx, wy, wz)
        )
        if not wanted:
            return
        classes = self._classes
        head = header(now, self._frames[0])
        pose = classes["Pose"](classes["Point"](x, y, z), classes["Quaternion"](*turn))
        messages: dict[str, Any] = {
            "Pose": pose,
            "PoseWithCovarianceStamped": classes["PoseWithCovarianceStamped"](
                head, classes["PoseWithCovariance"](pose, self._covariance)
            ),
            "PointStamped": classes["PointStamped"](head, pose.position),
            "TransformStamped": classes["TransformStamped"](
                head,
                self._frames[1],
                classes["Transform"](classes["Vector3"](x, y, z), pose.orientation),
            ),
        }
        for kind in wanted:
            self._others[kind].publish(messages[kind])

    def _error(self) -> Array:
        """Returns noise on position, orientation, linear and angular velocity, shape (12,)."""
        if not (self._normal.any() or self._uniform.any()):
            return np.zeros(12)
        random = self.part.random(f"odometry {self.tag.name}")
        drawn: Array = random.normal(0.0, self._normal) + random.uniform(-1, 1, 12) * self._uniform
        return drawn


def _tilted(turn: Quat, angles: Array) -> Quat:
    """Rotates an orientation by small angles about its own axes."""
    if not angles.any():
        return turn
    x, y, z = (angles / 2).tolist()
    return quat_normalize(quat_multiply(turn, (x, y, z, 1.0)))
