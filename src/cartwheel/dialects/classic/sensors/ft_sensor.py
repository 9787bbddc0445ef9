"""``libgazebo_ros_ft_sensor.so``: the force and torque on a joint."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

from cartwheel.codes import devices
from cartwheel.devices.contact.loads import JointReactionConfig, LinkLoadConfig
from cartwheel.devices.contact.wrench import WrenchSensor, WrenchSensorConfig
from cartwheel.dialects.common_tags import deviation_tag
from cartwheel.dialects.plugin import Plugin
from cartwheel.dialects.tags import tag
from cartwheel.errors import PluginError


@dataclass(frozen=True, kw_only=True, slots=True)
class FtSensorParameters:
    joint: str = tag(
        "jointName",
        "joint_name",
        default="",
        role="other_joint",
        doc="Joint whose force and torque are measured. Default: the joint that contains the "
        "sensor.",
    )
    body: str = tag(
        "body_name",
        default="",
        role="link",
        doc="If set, the plugin measures the external force and torque on this link, as "
        "`libgazebo_ros_f3d.so` does, instead of those of a joint. This tag comes from the "
        "ROS 2 plugin.",
    )
    topic: str = tag(
        "topicName", "topic_name", default="wrench", doc="Topic of the WrenchStamped messages."
    )
    frame: str = tag(
        "frame_name",
        default="",
        role="frame",
        doc="Frame ID of the messages if `<body_name>` is set. Otherwise, this tag has no "
        "effect: as in Gazebo, the frame is that of the joint's child link. Default: "
        "`world`.",
    )
    noise: float = deviation_tag(
        "gaussianNoise", "gaussian_noise", unit="N and N m", of="the noise"
    )
    update_rate: float = tag(
        "updateRate",
        "update_rate",
        default=0.0,
        unit="Hz",
        least=0.0,
        doc="Publish rate. If 0, the `<update_rate>` of the sensor that contains the plugin "
        "applies. If no sensor contains the plugin, messages are then published at every "
        "simulation step.",
    )


class FtSensor(Plugin[FtSensorParameters]):
    """Publishes the force and torque that a joint's child link exerts on its parent link.

    The force and the torque are expressed in the frame of the child link. The torque is about the
    origin of the joint. For example, a load that hangs from the joint results in a downward force.
    Fixed joints are supported without ``<preserveFixedJoint>``. Original plugin:
    ``gazebo_ros_ft_sensor`` in the package ``gazebo_plugins``.
    """

    filenames: ClassVar[tuple[str, ...]] = ("libgazebo_ros_ft_sensor.so",)

    def configure(self) -> None:
        config, sensor = self.config, self.sensor
        rate = config.update_rate or (sensor.update_rate if sensor is not None else 0.0)
        load, frame = self._load()
        device = WrenchSensorConfig(
            load=load, topic=config.topic, frame=frame, rate=rate, noise=config.noise
        )
        self.add(WrenchSensor(self.scope, device))

    def _load(self) -> tuple[LinkLoadConfig | JointReactionConfig, str]:
        """Returns the measurement and the frame ID."""
        config = self.config
        if config.body:
            # If both tags are present, Gazebo also uses the link.
            return LinkLoadConfig(link=config.body), config.frame or "world"
        name = config.joint or (self.sensor.joint if self.sensor is not None else None)
        if not name:
            raise PluginError(
                "a force-torque sensor requires <jointName>",
                code=devices.PLUGIN_PARAMETER_MISSING,
                origin=self.tag.origin,
                values={"parameter": "jointName"},
            )
        if config.frame:
            self.warn_ignored("frame_name", "the wrench of a joint is in the frame of its child")
        joint = self.part.description.joint(name)
        return JointReactionConfig(joint=name), joint.child if joint is not None else ""
