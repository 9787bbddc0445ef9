"""A pose sensor with noise, which publishes several message types."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from cartwheel.component import Component, Scope
from cartwheel.devices.drives.odometry import Odometry, OdometryConfig
from cartwheel.devices.transforms import transform_stamped
from cartwheel.geometry import Array, Quat, quat_multiply, quat_normalize
from cartwheel.messages import header, message_class


@dataclass(frozen=True, kw_only=True, slots=True)
class PoseSensorConfig:
    link: str
    """Link whose pose is measured."""
    pose_topic: str
    """Topic of the Pose messages."""
    pose_with_covariance_topic: str
    """Topic of the PoseWithCovarianceStamped messages."""
    position_topic: str
    """Topic of the PointStamped messages."""
    transform_topic: str
    """Topic of the TransformStamped messages."""
    odometry_topic: str
    """Topic of the Odometry messages, whose twist is in the link frame."""
    frame: str
    """Frame ID of the world."""
    child_frame: str
    divisor: int
    """Number of simulation steps per message."""
    stamp_delay: float
    """Delay added to the stamps, s."""
    normal: Array
    """Standard deviations of Gaussian noise on position in m, orientation in rad, linear velocity
    in m/s and angular velocity in rad/s, shape (12,)."""
    uniform: Array
    """Bounds of uniform noise on the same quantities, shape (12,)."""
    noise_name: str
    """Name of the random sequence."""


class PoseSensor(Component):
    """Publishes a link's noisy pose in the world, as five message types and a transform.

    Raises:
        UnknownNameError: The link does not exist.
    """

    def __init__(self, scope: Scope, config: PoseSensorConfig) -> None:
        super().__init__(scope)
        part = self.part
        self._config = config
        self._normal, self._uniform = config.normal, config.uniform
        self._link = part.link(config.link, origin=self.origin)
        self._frames = self.frame(config.frame), self.frame(config.child_frame)
        variance = self._normal**2
        self._covariance = np.diag(variance[:6]).ravel()
        self._odometry = self.add(
            Odometry(
                scope,
                OdometryConfig(
                    topic=config.odometry_topic,
                    frame=config.frame,
                    base=config.child_frame,
                    transform=True,
                    pose_covariance=self._covariance,
                    twist_covariance=np.diag(variance[6:]).ravel(),
                ),
            )
        )
        self._classes = {
            name: message_class(f"geometry_msgs/msg/{name}")
            for name in ("Pose", "Point", "Quaternion", "PoseWithCovariance",
                         "PoseWithCovarianceStamped", "PointStamped")
        }  # fmt: skip
        self._others = {
            kind: self.advertise(topic, f"geometry_msgs/msg/{kind}")
            for topic, kind in (
                (config.pose_topic, "Pose"),
                (config.pose_with_covariance_topic, "PoseWithCovarianceStamped"),
                (config.position_topic, "PointStamped"),
                (config.transform_topic, "TransformStamped"),
            )
        }
        self._steps = 0
        part.schedule(0, after=self._count)

    def reset(self) -> None:
        super().reset()
        self._steps = 0

    def _count(self) -> None:
        if self._steps % self._config.divisor == 0:
            self._publish()
        self._steps += 1

    def _publish(self) -> None:
        wanted = [kind for kind, publisher in self._others.items() if publisher.wanted]
        if not wanted and not self._odometry.wanted():
            return
        place, turn = self._link.place()
        linear, angular = self._link.motion(local=True)
        error = self._error()
        x, y, z = np.add(place, error[:3]).tolist()
        turn = tilted(turn, error[3:6])
        wx, wy, wz = np.add(angular, error[9:]).tolist()
        now = self.part.time_ns + round(self._config.stamp_delay * 1e9)
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
            "TransformStamped": transform_stamped(head, self._frames[1], (x, y, z), turn),
        }
        for kind in wanted:
            self._others[kind].publish(messages[kind])

    def _error(self) -> Array:
        """Returns noise on position, orientation, linear and angular velocity, shape (12,)."""
        if not (self._normal.any() or self._uniform.any()):
            return np.zeros(12)
        random = self.part.random(self._config.noise_name)
        drawn: Array = random.normal(0.0, self._normal) + random.uniform(-1, 1, 12) * self._uniform
        return drawn


def tilted(turn: Quat, angles: Array) -> Quat:
    """Rotates an orientation by small angles about its own axes."""
    if not angles.any():
        return turn
    x, y, z = (angles / 2).tolist()
    return quat_normalize(quat_multiply(turn, (x, y, z, 1.0)))
