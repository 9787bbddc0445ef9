"""``libgazebo_ros_force.so``: a commanded force on a link."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, ClassVar, Literal

from cartwheel.dialects.plugin import Plugin
from cartwheel.dialects.tags import tag
from cartwheel.geometry import rotate


@dataclass(frozen=True, kw_only=True, slots=True)
class ForceParameters:
    body: str = tag(
        "bodyName", "body_name", "link_name", doc="Link to which the wrench is applied."
    )
    topic: str = tag(
        "topicName", "topic_name", default="gazebo_ros_force", doc="Topic of the Wrench messages."
    )
    frame: Literal["world", "link"] = tag(
        "force_frame",
        default="world",
        doc="Frame of the commanded wrench. Gazebo's ROS 1 plugin does not have this tag.",
    )


class Force(Plugin[ForceParameters]):
    """Applies the last received Wrench to a link, at its centre of mass.

    A wrench stays in effect until the next message. Original plugin: ``gazebo_ros_force`` in the
    package ``gazebo_plugins``.
    """

    filenames: ClassVar[tuple[str, ...]] = ("libgazebo_ros_force.so",)
    parameters: ClassVar[type] = ForceParameters

    def configure(self) -> None:
        origin = self.tag.origin
        self._link = self.part.link(self.config.body, origin=origin)
        self._push = self.part.wrench(self.config.body, origin=origin)
        self._wrench: tuple[list[float], list[float]] | None = None
        self.subscribe(self.config.topic, "geometry_msgs/msg/Wrench", self._on_wrench)
        if self.config.frame == "link":
            self.part.schedule(0, before=self._turn)

    def reset(self) -> None:
        self._wrench = None
        self._push.forget()

    def _on_wrench(self, message: Any) -> None:
        force, torque = message.force, message.torque
        values = [force.x, force.y, force.z, torque.x, torque.y, torque.z]
        self._wrench = (values[:3], values[3:])
        if self.config.frame == "world":
            self._push.apply(*self._wrench)

    def _turn(self) -> None:
        if self._wrench is not None:
            _, turned = self._link.place()
            self._push.apply(*(rotate(turned, vector) for vector in self._wrench))
