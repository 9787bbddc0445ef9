"""``libgazebo_ros_vacuum_gripper.so``: a suction cup."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, ClassVar

from cartwheel.dialects.plugin import Plugin
from cartwheel.dialects.tags import tag
from cartwheel.messages import message_class, service_classes


@dataclass(frozen=True, kw_only=True, slots=True)
class VacuumGripperParameters:
    link: str = tag("bodyName", "link_name", doc="Link of the suction cup.")
    topic: str = tag(
        "topicName",
        default="grasping",
        doc="Topic of a Bool that is true while an object is held. Gazebo's ROS 1 plugin "
        "requires this tag.",
    )
    reach: float = tag(
        "max_distance",
        default=0.05,
        unit="m",
        doc="Maximum distance between the cup's frame and the frame of the gripped link.",
    )
    fixed: tuple[str, ...] = tag("fixed", default=(), doc="Models or links that are never gripped.")


class VacuumGripper(Plugin[VacuumGripperParameters]):
    """While switched on, holds the nearest link of a different model that is within reach.

    The held link keeps its pose relative to the cup, as with a fixed joint. In Gazebo, the link is
    pulled toward the cup. The services `on` and `off` switch the gripper. If the plugin tag
    contains ``<link_name>`` (ROS 2), the service ``switch`` replaces ``on`` and ``off``. Original
    plugin: ``gazebo_ros_vacuum_gripper`` in the package ``gazebo_plugins``.
    """

    filenames: ClassVar[tuple[str, ...]] = ("libgazebo_ros_vacuum_gripper.so",)
    parameters: ClassVar[type] = VacuumGripperParameters

    def configure(self) -> None:
        config, part = self.config, self.part
        self._link = part.link(config.link, origin=self.tag.origin)
        self._grip = part.attachment()
        self._surroundings = part.surroundings()
        self._on = False
        self._Bool = message_class("std_msgs/msg/Bool")
        self._publisher = self.advertise(config.topic, "std_msgs/msg/Bool")
        if self.tag.element.find("bodyName") is None:
            _, self._Switched = service_classes("std_srvs/srv/SetBool")
            self.serve("switch", "std_srvs/srv/SetBool", self._on_switch)
        else:
            _, self._Empty = service_classes("std_srvs/srv/Empty")
            self.serve("on", "std_srvs/srv/Empty", lambda _: self._switched(on=True))
            self.serve("off", "std_srvs/srv/Empty", lambda _: self._switched(on=False))
        part.schedule(0, before=self._seek, active=lambda: self._on and self._grip.held is None)
        part.schedule(0, after=self._publish, active=lambda: self._publisher.wanted)

    def reset(self) -> None:
        self._switch(on=False)

    def _switched(self, *, on: bool) -> Any:
        self._switch(on=on)
        return self._Empty()

    def _on_switch(self, request: Any) -> Any:
        changed = bool(request.data) != self._on
        self._switch(on=bool(request.data))
        state = "on" if self._on else "off"
        return self._Switched(success=changed, message=f"{'' if changed else 'already '}{state}")

    def _switch(self, *, on: bool) -> None:
        self._on = on
        if not on:
            self._grip.release()

    def _seek(self) -> None:
        position, _ = self._link.place()
        distances = self._surroundings.distances(position)
        taken = {self.part.name, *self.config.fixed}
        for index in distances.argsort(kind="stable"):
            if distances[index] > self.config.reach:
                return
            model, link = place = self._surroundings.links[index]
            if place in self._surroundings.moving and not {model, link} & taken:
                self._grip.hold((self.part.name, self._link.name), place)
                return

    def _publish(self) -> None:
        self._publisher.publish(self._Bool(self._grip.held is not None))
