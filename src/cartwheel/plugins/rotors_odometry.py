"""``librotors_gazebo_odometry_plugin.so``: where a link of a multicopter is, as it is measured."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np

from cartwheel.codes import devices
from cartwheel.errors import PluginError
from cartwheel.geometry import Array, Quat, quat_multiply, quat_normalize
from cartwheel.messages import header, message_class
from cartwheel.plugins.base import Plugin
from cartwheel.plugins.odometry import Odometry
from cartwheel.plugins.parameters import tag

_NONE = (0.0, 0.0, 0.0)


@dataclass(frozen=True, kw_only=True, slots=True)
class RotorsOdometryParameters:
    link: str = tag("linkName", doc="Link whose pose is told.")
    pose_topic: str = tag("poseTopic", default="pose", doc="Pose.")
    with_topic: str = tag(
        "poseWithCovarianceTopic", default="pose_with_covariance", doc="The same, with a stamp."
    )
    position_topic: str = tag("positionTopic", default="position", doc="PointStamped.")
    transform_topic: str = tag("transformTopic", default="transform", doc="TransformStamped.")
    odometry_topic: str = tag("odometryTopic", default="odometry", doc="Odometry.")
    parent: str = tag("parentFrameId", default="world", doc="Only the world is supported.")
    child: str = tag("childFrameId", default="odometry_sensor", doc="What the link is called.")
    divisor: int = tag("measurementDivisor", default=1, doc="Every so many steps it is told.")
    delay: int = tag("measurementDelay", default=0, doc="Has no effect: it is told at once.")
    unknown_delay: float = tag("unknownDelay", default=0.0, unit="s", doc="Added to the stamp.")
    normal_position: tuple[float, float, float] = tag(
        "noiseNormalPosition", default=_NONE, unit="m", doc="Standard deviations."
    )
    normal_turn: tuple[float, float, float] = tag(
        "noiseNormalQuaternion", default=_NONE, unit="rad", doc="Standard deviations."
    )
    normal_linear: tuple[float, float, float] = tag(
        "noiseNormalLinearVelocity", default=_NONE, unit="m/s", doc="Standard deviations."
    )
    normal_angular: tuple[float, float, float] = tag(
        "noiseNormalAngularVelocity", default=_NONE, unit="rad/s", doc="Standard deviations."
    )
    uniform_position: tuple[float, float, float] = tag(
        "noiseUniformPosition", default=_NONE, unit="m", doc="Bounds, either side."
    )
    uniform_turn: tuple[float, float, float] = tag(
        "noiseUniformQuaternion", default=_NONE, unit="rad", doc="Bounds, either side."
    )
    uniform_linear: tuple[float, float, float] = tag(
        "noiseUniformLinearVelocity", default=_NONE, unit="m/s", doc="Bounds, either side."
    )
    uniform_angular: tuple[float, float, float] = tag(
        "noiseUniformAngularVelocity", default=_NONE, unit="rad/s", doc="Bounds, either side."
    )


class RotorsOdometry(Plugin[RotorsOdometryParameters]):
    """Publishes where a link is in the world, with noise, in five forms and as a transform.

    The twist is in the link's axes. Source: rotors_gazebo_plugins, gazebo_odometry_plugin.
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
                "<measurementDelay> has no effect: measurements are published at once",
                values={"parameter": "measurementDelay"},
            )
        self._link = part.link(config.link, origin=origin)
        self._frames = self.frame(config.parent), self.frame(config.child)
        variance = self._normal**2
        self._covariance = np.diag(variance[:6]).ravel()
        self._odometry = self.keep(
            Odometry(
                self,
                topic=config.odometry_topic,
                frame=config.parent,
                base=config.child,
                rate=None,
                transform=True,
                pose_covariance=self._covariance,
                twist_covariance=np.diag(variance[6:]).ravel(),
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
            self._tell()
        self._steps += 1

    def _tell(self) -> None:
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
        made = self._classes
        head = header(now, self._frames[0])
        pose = made["Pose"](made["Point"](x, y, z), made["Quaternion"](*turn))
        told: dict[str, Any] = {
            "Pose": pose,
            "PoseWithCovarianceStamped": made["PoseWithCovarianceStamped"](
                head, made["PoseWithCovariance"](pose, self._covariance)
            ),
            "PointStamped": made["PointStamped"](head, pose.position),
            "TransformStamped": made["TransformStamped"](
                head, self._frames[1], made["Transform"](made["Vector3"](x, y, z), pose.orientation)
            ),
        }
        for kind in wanted:
            self._others[kind].publish(told[kind])

    def _error(self) -> Array:
        """Of position, turning, velocity and turning rate, shape (12,)."""
        if not (self._normal.any() or self._uniform.any()):
            return np.zeros(12)
        random = self.part.random(f"odometry {self.tag.name}")
        drawn: Array = random.normal(0.0, self._normal) + random.uniform(-1, 1, 12) * self._uniform
        return drawn


def _tilted(turn: Quat, angles: Array) -> Quat:
    """A rotation that is turned by small angles about its own axes."""
    if not angles.any():
        return turn
    x, y, z = (angles / 2).tolist()
    return quat_normalize(quat_multiply(turn, (x, y, z, 1.0)))
