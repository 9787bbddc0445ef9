"""``librotors_gazebo_odometry_plugin.so``: the measured pose of a multicopter's link."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np

from cartwheel.codes import devices
from cartwheel.devices.air.pose_sensor import PoseSensor, PoseSensorConfig
from cartwheel.dialects.common_tags import ZEROS, deviation_tag
from cartwheel.dialects.plugin import Plugin
from cartwheel.dialects.tags import SMALLEST, tag
from cartwheel.errors import PluginError


def _normal_tag(name: str, unit: str, what: str) -> Any:
    return deviation_tag(name, default=ZEROS, unit=unit, of=f"Gaussian noise on {what}")


def _uniform_tag(name: str, unit: str, what: str) -> Any:
    doc = f"Maximum absolute value of uniform noise on {what}."
    return tag(name, default=ZEROS, unit=unit, least=0.0, doc=doc)


@dataclass(frozen=True, kw_only=True, slots=True)
class RotorsOdometryParameters:
    link: str = tag("linkName", role="link", doc="Link whose pose is published.")
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
        "measurementDivisor",
        default=1,
        least=SMALLEST,
        doc="Number of simulation steps per message.",
    )
    delay: int = tag(
        "measurementDelay", default=0, doc="No effect: measurements are published immediately."
    )
    unknown_delay: float = tag(
        "unknownDelay", default=0.0, unit="s", doc="Delay that is added to the header stamps."
    )
    normal_position: tuple[float, float, float] = _normal_tag(
        "noiseNormalPosition", "m", "the position"
    )
    normal_turn: tuple[float, float, float] = _normal_tag(
        "noiseNormalQuaternion", "rad", "the orientation"
    )
    normal_linear: tuple[float, float, float] = _normal_tag(
        "noiseNormalLinearVelocity", "m/s", "the linear velocity"
    )
    normal_angular: tuple[float, float, float] = _normal_tag(
        "noiseNormalAngularVelocity", "rad/s", "the angular velocity"
    )
    uniform_position: tuple[float, float, float] = _uniform_tag(
        "noiseUniformPosition", "m", "the position"
    )
    uniform_turn: tuple[float, float, float] = _uniform_tag(
        "noiseUniformQuaternion", "rad", "the orientation"
    )
    uniform_linear: tuple[float, float, float] = _uniform_tag(
        "noiseUniformLinearVelocity", "m/s", "the linear velocity"
    )
    uniform_angular: tuple[float, float, float] = _uniform_tag(
        "noiseUniformAngularVelocity", "rad/s", "the angular velocity"
    )


class RotorsOdometry(Plugin[RotorsOdometryParameters]):
    """Publishes a link's pose in the world, with noise, as five message types and a tf transform.

    The twist in the Odometry messages is in the link frame. Original plugin:
    ``gazebo_odometry_plugin`` in the package ``rotors_gazebo_plugins``.
    """

    filenames: ClassVar[tuple[str, ...]] = ("librotors_gazebo_odometry_plugin.so",)

    def configure(self) -> None:
        config = self.config
        if config.parent != "world":
            raise PluginError(
                f'<parentFrameId> "{config.parent}" is not supported: only "world" is',
                code=devices.PLUGIN_PARAMETER_UNSUPPORTED,
                origin=self.place_of("parentFrameId"),
                values={"parameter": "parentFrameId", "value": config.parent},
            )
        normal = [config.normal_position, config.normal_turn, config.normal_linear,
                  config.normal_angular]  # fmt: skip
        uniform = [config.uniform_position, config.uniform_turn, config.uniform_linear,
                   config.uniform_angular]  # fmt: skip
        if config.delay:
            self.warn_ignored("measurementDelay", "measurements are published immediately")
        device = PoseSensorConfig(
            link=config.link,
            pose_topic=config.pose_topic,
            pose_with_covariance_topic=config.with_topic,
            position_topic=config.position_topic,
            transform_topic=config.transform_topic,
            odometry_topic=config.odometry_topic,
            frame=config.parent,
            child_frame=config.child,
            divisor=config.divisor,
            stamp_delay=config.unknown_delay,
            normal=np.array(normal).ravel(),
            uniform=np.array(uniform).ravel(),
            noise_name=f"odometry {self.tag.name}",
        )
        self.add(PoseSensor(self.scope, device))
