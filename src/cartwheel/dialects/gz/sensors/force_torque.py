"""Force-torque sensors in gz-sim, which need no plugin."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

from cartwheel.codes import devices
from cartwheel.devices.contact.wrench import WrenchSensor, WrenchSensorConfig
from cartwheel.dialects.gz.sensor_tags import GzSensor, frame_tag
from cartwheel.dialects.sdf.force_torque import read_joint_load
from cartwheel.dialects.tags import tag
from cartwheel.errors import PluginError
from cartwheel.geometry import IDENTITY


@dataclass(frozen=True, kw_only=True, slots=True)
class GzForceTorqueParameters:
    topic: str = tag(
        "topic",
        default="",
        doc="Topic of the WrenchStamped messages. Default: "
        "`/world/<world>/model/<model>/joint/<joint>/sensor/<sensor>/forcetorque`.",
    )
    frame: str = frame_tag(default="the link selected by `<frame>`")


class GzForceTorque(GzSensor[GzForceTorqueParameters]):
    """Publishes the force and torque in the joint that contains a ``force_torque`` sensor.

    These tags of the sensor's ``<force_torque>`` are supported: ``<frame>`` selects the frame in
    which the force and torque are expressed, ``child`` (default), ``parent`` or ``sensor``.
    ``<measure_direction>`` selects their sign, ``child_to_parent`` (default) or
    ``parent_to_child``. ``<force>`` and ``<torque>`` can specify noise for each axis.

    The default frame ID is the link that ``<frame>`` selects. If ``<frame>`` is ``sensor``, it is
    the child link, or the sensor's name if the sensor is rotated relative to its link. Original
    sensor: ``ForceTorqueSensor`` in gz-sensors.
    """

    serves: ClassVar[tuple[str, ...]] = ("force_torque",)

    def configure(self) -> None:
        sensor, config = self.sensor, self.config
        if sensor.joint is None:
            raise PluginError(
                f'sensor "{sensor.name}" measures a joint, but is not inside a <joint>',
                code=devices.SENSOR_INCOMPLETE,
                origin=sensor.origin,
                hint="Move the <sensor> into the <joint>.",
                values={"sensor": sensor.name, "missing": "joint"},
            )
        joint = self.part.description.joint(sensor.joint)
        assert joint is not None
        scope = f"/world/{self.part.world.name}/model/{self.part.name}/joint/{sensor.joint}"
        load = read_joint_load(self.part, sensor, sensor.joint)
        frame = joint.child
        if load.axes == "parent":
            frame = joint.parent
        elif load.axes == "sensor" and sensor.pose.orientation != IDENTITY:
            frame = sensor.name
        device = WrenchSensorConfig(
            load=load,
            topic=config.topic or f"{scope}/sensor/{sensor.name}/forcetorque",
            frame=config.frame or frame,
            rate=sensor.update_rate,
        )
        self.add(WrenchSensor(self.scope, device))
