"""``libunitreeFootContactPlugin.so``: the contact force on a foot."""

from __future__ import annotations

from typing import ClassVar

from cartwheel.devices.contact.loads import ContactForceConfig
from cartwheel.devices.contact.wrench import WrenchSensor, WrenchSensorConfig
from cartwheel.dialects.plugin import NoTags, SensorPlugin
from cartwheel.dialects.sdf.contact import read_collisions


class FootContact(SensorPlugin[NoTags]):
    """Publishes the contact force on a robot's foot, in the frame of the foot's link.

    The topic is ``/visual/<sensor>/the_force``. The force is the sum over all contacts of the
    sensor's collisions; in Gazebo, it is their mean. Original plugin: ``foot_contact_plugin`` in
    the package ``unitree_gazebo``.
    """

    filenames: ClassVar[tuple[str, ...]] = ("libunitreeFootContactPlugin.so",)
    sensor_type: ClassVar[str] = "contact"

    def configure(self) -> None:
        sensor = self.sensor
        device = WrenchSensorConfig(
            load=ContactForceConfig(link=sensor.link, collisions=read_collisions(self, sensor)),
            topic=f"/visual/{sensor.name}/the_force",
            frame=sensor.link,
            rate=sensor.update_rate,
            qos="default",
        )
        self.add(WrenchSensor(self.scope, device))
