"""``libgazebo_ros_f3d.so``: the external force and torque on a link."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

from cartwheel.devices.contact.loads import LinkLoadConfig
from cartwheel.devices.contact.wrench import WrenchSensor, WrenchSensorConfig
from cartwheel.dialects.plugin import Plugin
from cartwheel.dialects.tags import tag


@dataclass(frozen=True, kw_only=True, slots=True)
class F3DParameters:
    body: str = tag("bodyName", role="link", doc="Link whose force and torque are measured.")
    topic: str = tag(
        "topicName",
        default="f3d",
        doc="Topic of the WrenchStamped messages. In Gazebo, this tag is required.",
    )
    frame: str = tag(
        "frameName",
        default="world",
        role="frame",
        doc="Frame ID of the messages. The values are always in the world frame.",
    )


class F3D(Plugin[F3DParameters]):
    """Publishes the force and torque that contacts, attached objects and wrenches exert on a link.

    Plugins such as grippers can attach objects. Plugins and services can apply wrenches.

    The force and the torque are expressed in the world frame, and the torque is about the link's
    centre of mass. Gravity and joint reaction forces are not included. A message is published at
    every simulation step. Original plugin: ``gazebo_ros_f3d`` in the package ``gazebo_plugins``.
    """

    filenames: ClassVar[tuple[str, ...]] = ("libgazebo_ros_f3d.so",)

    def configure(self) -> None:
        config = self.config
        device = WrenchSensorConfig(
            load=LinkLoadConfig(link=config.body),
            topic=config.topic,
            frame=config.frame,
            qos="default",
        )
        self.add(WrenchSensor(self.scope, device))
