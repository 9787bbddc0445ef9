"""``libgazebo_ros_force.so``: a commanded force on a link."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar, Literal

from cartwheel.devices.contact.force import CommandedWrench, CommandedWrenchConfig
from cartwheel.dialects.plugin import Plugin
from cartwheel.dialects.tags import tag


@dataclass(frozen=True, kw_only=True, slots=True)
class ForceParameters:
    body: str = tag(
        "bodyName",
        "body_name",
        "link_name",
        role="link",
        doc="Link to which the wrench is applied.",
    )
    topic: str = tag(
        "topicName", "topic_name", default="gazebo_ros_force", doc="Topic of the Wrench messages."
    )
    frame: Literal["world", "link"] = tag(
        "force_frame",
        default="world",
        doc="Frame in which the commanded wrench is expressed. Gazebo's ROS 1 plugin does not "
        "have this tag.",
    )


class Force(Plugin[ForceParameters]):
    """Applies the force and torque of the last received Wrench message to a link.

    The force acts at the link's centre of mass. The wrench stays in effect until the next message.
    Original plugin: ``gazebo_ros_force`` in the package ``gazebo_plugins``.
    """

    filenames: ClassVar[tuple[str, ...]] = ("libgazebo_ros_force.so",)

    def configure(self) -> None:
        config = self.config
        device = CommandedWrenchConfig(
            link=config.body, topic=config.topic, in_link=config.frame == "link"
        )
        self.add(CommandedWrench(self.scope, device))
