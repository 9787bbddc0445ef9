"""SDF's ``<contact>`` element: the collisions of a contact sensor."""

from __future__ import annotations

from cartwheel.codes import devices
from cartwheel.component import Component
from cartwheel.description.model import Sensor
from cartwheel.similar_names import meant, suggestion
from cartwheel.world.entry import scoped


def read_collisions(component: Component, sensor: Sensor) -> frozenset[str]:
    """Returns ``link::collision`` for each collision of a contact sensor.

    All of Gazebo's spellings are accepted. The component reports unknown names.
    """
    spellings: dict[str, str] = {}
    for link in component.part.description.links:
        for collision in link.collisions:
            for name in (*collision.aliases, collision.name):
                spellings[name] = scoped(link.name, collision.name)
            spellings[scoped(link.name, collision.name)] = scoped(link.name, collision.name)
    collisions = set()
    for wanted in sensor.collisions:
        name = wanted.strip()
        bare = name.rsplit("::", 1)[-1]
        if name in spellings or bare in spellings:
            collisions.add(spellings.get(name) or spellings[bare])
        else:
            component.warn(
                devices.CONTACT_COLLISION_UNKNOWN,
                f'the collision "{name}" of contact sensor "{sensor.name}" does not exist, so its '
                "contacts are not reported",
                hint=suggestion(name, spellings),
                values={
                    "sensor": sensor.name,
                    "collision": name,
                    "meant": meant(name, spellings),
                },
            )
    if not sensor.collisions:
        component.warn(
            devices.SENSOR_INCOMPLETE,
            f'contact sensor "{sensor.name}" has no <collision>, so it never reports a contact',
            values={"sensor": sensor.name, "missing": "collision"},
        )
    return frozenset(collisions)
