"""IMU sensors in gz-sim, which need no plugin."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

from cartwheel.devices.inertial.imu import Imu, ImuConfig
from cartwheel.dialects.gz.sensor_tags import default_topic, frame_tag
from cartwheel.dialects.plugin import Plugin
from cartwheel.dialects.sdf.imu import read_inertial_unit
from cartwheel.dialects.tags import tag


@dataclass(frozen=True, kw_only=True, slots=True)
class GzImuParameters:
    topic: str = tag(
        "topic",
        default="",
        doc="Topic of the Imu messages. Default: "
        "`/world/<world>/model/<model>/link/<link>/sensor/<sensor>/imu`.",
    )
    frame: str = frame_tag()


class GzImu(Plugin[GzImuParameters]):
    """Publishes the measurements of an ``imu`` sensor, with the noise specified in its ``<imu>``.

    The orientation is relative to the world, or to ``<orientation_reference_frame>`` if this tag is
    set. If ``<enable_orientation>`` is false, the orientation is not measured, and the first
    element of its covariance is -1.

    The sensor corresponds to ``ImuSensor`` in gz-sensors. See also REP 145.
    """

    filenames: ClassVar[tuple[str, ...]] = ()
    parameters: ClassVar[type] = GzImuParameters
    for_sensor: ClassVar[bool] = True
    serves: ClassVar[tuple[str, ...]] = ("imu",)

    def configure(self) -> None:
        sensor, config = self.sensor, self.config
        assert sensor is not None
        device = ImuConfig(
            unit=read_inertial_unit(self.part, sensor),
            topic=config.topic or default_topic(self.part, sensor, "imu"),
            frame=config.frame or sensor.link,
            rate=sensor.update_rate,
        )
        self.add(Imu(self.scope, device))
