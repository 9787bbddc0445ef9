"""``libgazebo_ros_range.so`` and hector's sonar: the distance to the nearest object."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, ClassVar, Literal

import numpy as np

from cartwheel.devices.noise import DriftingError
from cartwheel.dialects.plugin import Plugin
from cartwheel.dialects.scan import Scanner
from cartwheel.dialects.scan_messages import range_reading
from cartwheel.dialects.tags import tag
from cartwheel.messages import header


class _RangeBase(Plugin[Any]):
    """Base class of the plugins that publish the smallest range of a ray sensor."""

    def _start(
        self,
        *,
        topic: str,
        frame: str,
        rate: float,
        noise: float | None,
        fov: float | None,
        infrared: bool,
        offset: float = 0.0,
        drift: float = 0.0,
        frequency: float = 0.0,
    ) -> None:
        assert self.sensor is not None
        self.check_not_negative("noise", "update_rate", "drift", "drift_frequency")
        self._scanner = Scanner(self.part, self.sensor)
        self._fov = min(self._scanner.pattern.field_of_view) if fov is None else fov
        self._infrared = infrared
        self._frame = self.frame(frame or self.sensor.link)
        rates = [hertz for hertz in (rate, self.sensor.update_rate) if hertz > 0]
        slower = min(rates, default=0.0)
        # Gazebo ignores the sensor's own noise. Here it applies unless the plugin specifies noise.
        self._own_noise = noise is None
        self._error = DriftingError(
            self.part,
            f"range {self.sensor.link} {self.sensor.name}",
            rate=slower,
            offset=[offset],
            drift=[drift],
            frequency=[frequency],
            noise=[noise or 0.0],
            scale=[1.0],
        )
        self._publisher = self.advertise(
            topic, "sensor_msgs/msg/Range", rate=slower or None, qos="sensor"
        )
        self.part.schedule(slower, after=self._publish, active=lambda: self._publisher.wanted)

    def reset(self) -> None:
        self._error.restart()

    def _publish(self) -> None:
        pattern = self._scanner.pattern
        ranges = self._scanner.measure(noisy=False).ranges
        value = float(np.clip(ranges.min(), pattern.minimum, pattern.maximum))
        if value < pattern.maximum:
            if self._own_noise:
                (value,) = self._scanner.error.add([value])
            value = float(self._error.add([value])[0])
            value = min(max(value, pattern.minimum), pattern.maximum)
        moment = header(self.part.time_ns, self._frame)
        self._publisher.publish(
            range_reading(moment, pattern, value, fov=self._fov, infrared=self._infrared)
        )


@dataclass(frozen=True, kw_only=True, slots=True)
class RangeParameters:
    topic: str = tag(
        "topicName", "topic_name", default="/range", doc="Topic of the Range messages."
    )
    frame: str = tag(
        "frameName",
        "frame_name",
        default="",
        doc="Frame ID of the messages. Default: the sensor's link.",
    )
    fov: float = tag("fov", default=0.05, unit="rad", doc="Field of view in the messages.")
    radiation: Literal["ultrasound", "infrared"] = tag(
        "radiation", default="ultrasound", doc="Radiation type in the messages."
    )
    noise: float | None = tag(
        "gaussianNoise",
        default=None,
        unit="m",
        doc="Standard deviation of the noise. Default: the sensor's `<noise>`.",
    )
    update_rate: float = tag(
        "updateRate",
        "update_rate",
        default=0.0,
        unit="Hz",
        doc="Publish rate, at most the sensor's rate. 0: the sensor's rate.",
    )


class Range(_RangeBase):
    """Publishes the smallest range of a ray sensor, or its maximum range if nothing is hit.

    Original plugin: ``gazebo_ros_range`` in the package ``gazebo_plugins``.
    """

    filenames: ClassVar[tuple[str, ...]] = ("libgazebo_ros_range.so",)
    parameters: ClassVar[type] = RangeParameters
    for_sensor: ClassVar[bool] = True
    sensor_type: ClassVar[str] = "ray"

    def configure(self) -> None:
        config: RangeParameters = self.config
        self._start(
            topic=config.topic,
            frame=config.frame,
            rate=config.update_rate,
            noise=config.noise,
            fov=config.fov,
            infrared=config.radiation == "infrared",
        )


@dataclass(frozen=True, kw_only=True, slots=True)
class SonarParameters:
    topic: str = tag("topicName", default="sonar", doc="Topic of the Range messages.")
    frame: str = tag(
        "frameId",
        "frameName",
        default="",
        doc="Frame ID of the messages. Default: the sensor's link.",
    )
    noise: float | None = tag(
        "gaussianNoise",
        default=None,
        unit="m",
        doc="Standard deviation of the noise. Default: the sensor's `<noise>`.",
    )
    offset: float = tag("offset", default=0.0, unit="m", doc="Offset added to each range.")
    drift: float = tag("drift", default=0.0, unit="m", doc="Standard deviation of a slow drift.")
    drift_frequency: float = tag(
        "driftFrequency", default=0.0, unit="1/s", doc="Inverse of the drift's time constant."
    )
    update_rate: float = tag(
        "updateRate",
        default=0.0,
        unit="Hz",
        doc="Publish rate, at most the sensor's rate. 0: the sensor's rate.",
    )


class HectorSonar(_RangeBase):
    """Publishes the smallest range of a ray sensor as a Range message of type ultrasound.

    If nothing is hit, the maximum range is published. Original plugin: ``gazebo_ros_sonar`` in the
    package ``hector_gazebo_plugins``.
    """

    filenames: ClassVar[tuple[str, ...]] = ("libhector_gazebo_ros_sonar.so",)
    parameters: ClassVar[type] = SonarParameters
    for_sensor: ClassVar[bool] = True
    sensor_type: ClassVar[str] = "ray"

    def configure(self) -> None:
        config: SonarParameters = self.config
        self._start(
            topic=config.topic,
            frame=config.frame,
            rate=config.update_rate,
            noise=config.noise,
            fov=None,
            infrared=False,
            offset=config.offset,
            drift=config.drift,
            frequency=config.drift_frequency,
        )
