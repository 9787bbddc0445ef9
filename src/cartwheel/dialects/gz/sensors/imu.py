"""IMU sensors in gz-sim, which need no plugin."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

from cartwheel.devices.inertial.imu import Imu, ImuConfig
from cartwheel.dialects.gz.sensor_tags import GzSensor, frame_tag, topic_tag
from cartwheel.dialects.sdf.imu import read_inertial_unit


@dataclass(frozen=True, kw_only=True, slots=True)
class GzImuParameters:
    topic: str = topic_tag("Imu", "imu")
    frame: str = frame_tag()


class GzImu(GzSensor[GzImuParameters]):
    """Publishes the measurements of an ``imu`` sensor, with the noise specified in its ``<imu>``.

    The orientation is relative to the world, or to ``<orientation_reference_frame>`` if this tag is
    set. If ``<enable_orientation>`` is false, the orientation is not measured, and the first
    element of its covariance is -1.

    The sensor corresponds to ``ImuSensor`` in gz-sensors. See also REP 145.
    """

    serves: ClassVar[tuple[str, ...]] = ("imu",)

    def configure(self) -> None:
        sensor = self.sensor
        device = ImuConfig(
            unit=read_inertial_unit(self.part, sensor),
            topic=self.topic("imu"),
            frame=self.frame_id,
            rate=sensor.update_rate,
        )
        self.add(Imu(self.scope, device))
