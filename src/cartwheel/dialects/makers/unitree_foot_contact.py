"""``libunitreeFootContactPlugin.so``: the contact force on a foot."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from cartwheel.dialects.classic.bumper import watched_collisions
from cartwheel.dialects.plugin import Plugin
from cartwheel.geometry import quat_conjugate, rotate
from cartwheel.messages import header, message_class


@dataclass(frozen=True, kw_only=True, slots=True)
class FootContactParameters:
    pass


class FootContact(Plugin[FootContactParameters]):
    """Publishes the contact force on a foot, in the foot's link frame.

    The topic is ``/visual/<sensor>/the_force``. The force is the sum over all contacts of the
    sensor's collisions; in Gazebo it is their mean. Original plugin: ``foot_contact_plugin`` in the
    package ``unitree_gazebo``.
    """

    filenames: ClassVar[tuple[str, ...]] = ("libunitreeFootContactPlugin.so",)
    parameters: ClassVar[type] = FootContactParameters
    for_sensor: ClassVar[bool] = True
    sensor_type: ClassVar[str] = "contact"

    def configure(self) -> None:
        sensor = self.sensor
        assert sensor is not None
        self._link = self.part.link(sensor.link)
        self._collisions = watched_collisions(self, sensor)
        self._frame = self.frame(sensor.link)
        self._WrenchStamped = message_class("geometry_msgs/msg/WrenchStamped")
        self._Wrench = message_class("geometry_msgs/msg/Wrench")
        self._Vector3 = message_class("geometry_msgs/msg/Vector3")
        rate = sensor.update_rate
        self._publisher = self.advertise(
            f"/visual/{sensor.name}/the_force", "geometry_msgs/msg/WrenchStamped", rate=rate or None
        )
        self.part.schedule(rate, after=self._publish, active=lambda: self._publisher.wanted)

    def _publish(self) -> None:
        forces = [contact.force for contact in self.part.contacts(self._collisions)]
        total = np.sum(forces, axis=0) if forces else np.zeros(3)
        _, turned = self._link.place()
        force = self._Vector3(*rotate(quat_conjugate(turned), total.tolist()))
        wrench = self._Wrench(force, self._Vector3(0.0, 0.0, 0.0))
        self._publisher.publish(self._WrenchStamped(header(self.part.time_ns, self._frame), wrench))
