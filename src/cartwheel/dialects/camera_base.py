"""The base class of camera plugins: one or more lenses, rendered at a rate or on a trigger."""

from __future__ import annotations

import dataclasses
from collections.abc import Iterator
from typing import Any, ClassVar, TypeVar

from cartwheel.codes import devices, running
from cartwheel.description.model import CameraIntrinsics
from cartwheel.devices.cameras.depth import DepthOptions, Depths
from cartwheel.devices.cameras.eye import Eye, EyeTopics
from cartwheel.devices.cameras.info import Calibration
from cartwheel.devices.cameras.lens import Distortion, Lens
from cartwheel.dialects.plugin import Plugin
from cartwheel.errors import GraphError
from cartwheel.simulation.offscreen import NoOpenGLError

_WIDEST_VIEW = 2.8
"""Largest field of view, rad; a wider image of a pinhole camera is nearly all border."""
_IDLE_RATE = 1.0
"""Rate at which a triggered camera checks its trigger, Hz."""
_LOST = {
    "lens": "the field of view is that of <horizontal_fov>",
    "save": "images are not saved",
    "visibility_mask": "all visuals are rendered",
}
"""Unsupported elements of SDF cameras, and what applies instead."""
_WIDE = ("wideanglecamera", "wide_angle_camera")

C = TypeVar("C")


class CameraBase(Plugin[C]):
    """Base class of camera plugins: sensor, rate and trigger. Subclasses define the topics."""

    empty_is_model: ClassVar[bool] = True
    for_sensor: ClassVar[bool] = True
    sensor_type: ClassVar[str] = "camera"

    def configure(self) -> None:
        sensor = self.sensor
        assert sensor is not None
        if not sensor.cameras:
            self.sensor = sensor = dataclasses.replace(sensor, cameras=(CameraIntrinsics(),))
            lens = sensor.cameras[0]
            self.warn(
                devices.SENSOR_INCOMPLETE,
                f'sensor "{sensor.name}" has no <camera>, so SDF\'s defaults are used: '
                f"{lens.width} x {lens.height} pixels and a field of view of "
                f"{lens.horizontal_fov:g} rad",
                at=sensor.origin,
                values={"sensor": sensor.name, "missing": "camera"},
            )
        if sensor.type in _WIDE:
            self.warn(
                devices.CAMERA_VIEW_NARROWED, "the wide-angle lens is rendered as a pinhole camera"
            )
        for camera in sensor.element.find_all("camera"):
            for child in camera.children:
                if child.tag in _LOST and child.attribute("enabled") not in ("false", "0"):
                    self.warn(
                        devices.SENSOR_SETTING_IGNORED,
                        f"<{child.tag}> has no effect: {_LOST[child.tag]}",
                        at=child.origin,
                        values={"setting": child.tag},
                    )
        rates = [rate for rate in (self._asked_rate(), sensor.update_rate) if rate > 0]
        self._rate = min(rates, default=0.0)
        self._triggers = 0
        self._blind = False
        self._eyes: list[Eye] = list(self._open_eyes())
        trigger_topics = self._trigger_topics()
        for topic in trigger_topics:
            self.subscribe(topic, "std_msgs/msg/Empty", self._trigger)
        self._waits = bool(trigger_topics)
        options = self._depth_options()
        self._depths = (
            None
            if options is None
            else Depths(self, self._eyes[0], options, rate=self._rate or None)
        )
        self._task = self.part.schedule(
            _IDLE_RATE if self._waits else self._rate,
            after=self._publish_once if self._waits else self._publish,
            active=(lambda: self._triggers > 0) if self._waits else self._wanted,
        )

    def _asked_rate(self) -> float:
        """Rate that the plugin's tags request, Hz; 0 for the sensor's rate."""
        return 0.0

    def _open_eyes(self) -> Iterator[Eye]:
        """Creates an `Eye` for each lens."""
        raise NotImplementedError

    def _trigger_topics(self) -> list[str]:
        """Returns the trigger topics; empty if the camera streams."""
        return []

    def _depth_options(self) -> DepthOptions | None:
        """Returns the options of the depth topics, or None if the camera publishes no depths."""
        return None

    def _eye(
        self,
        lens: CameraIntrinsics,
        topics: EyeTopics,
        *,
        frame: str,
        distortion: Distortion | None = None,
        **calibration: Any,
    ) -> Eye:
        """Creates the `Eye` of a lens.

        Args:
            lens: Intrinsics of the sensor.
            topics: Names of the topics.
            frame: Frame ID of the messages; empty for the sensor's link.
            distortion: Used if the sensor has no distortion.
            calibration: See `Calibration`.
        """
        sensor = self.sensor
        assert sensor is not None
        lens = self._narrowed(lens)
        bent = Lens(lens, self._distortion(lens, distortion or Distortion()))
        frame = self.frame(frame or sensor.link)
        return Eye(
            self,
            sensor,
            lens,
            bent=bent,
            calibration=Calibration(bent, frame, **calibration),
            topics=topics,
            frame=frame,
            rate=self._rate,
            on_rate=self._set_rate,
        )

    def _narrowed(self, lens: CameraIntrinsics) -> CameraIntrinsics:
        if lens.horizontal_fov <= _WIDEST_VIEW:
            return lens
        self.warn(
            devices.CAMERA_VIEW_NARROWED,
            f"the field of view of {lens.horizontal_fov:g} rad is rendered as {_WIDEST_VIEW:g} "
            "rad, the maximum for a pinhole camera",
            values={"stated": lens.horizontal_fov, "used": _WIDEST_VIEW},
        )
        return dataclasses.replace(lens, horizontal_fov=_WIDEST_VIEW)

    def _distortion(self, lens: CameraIntrinsics, configured: Distortion) -> Distortion:
        """Returns the sensor's distortion, or else the plugin's, for images and camera_info."""
        own = Distortion(k1=lens.k1, k2=lens.k2, p1=lens.p1, p2=lens.p2, k3=lens.k3)
        if not any(own.coefficients):
            return configured
        if any(configured.coefficients) and configured != own:
            self.warn(
                devices.PLUGIN_PARAMETER_IGNORED,
                "the plugin's distortion has no effect: the sensor's <distortion> is used",
                values={"parameter": "distortion"},
            )
        if lens.distortion_center != (0.5, 0.5):
            self.warn(
                devices.SENSOR_SETTING_IGNORED,
                "the <center> of the distortion is rendered, but camera_info cannot contain it",
                values={"setting": "center"},
            )
        return own

    def _set_rate(self, rate: float) -> None:
        if self._waits:
            raise GraphError(
                "the rate of a triggered camera cannot be changed", code=running.CAMERA_WITHOUT_RATE
            )
        if rate != self._rate:
            self._rate = rate
            self._task = self.part.reschedule(self._task, rate)

    def _trigger(self, _: Any) -> None:
        self._triggers += 1
        # At the next step, regardless of the sensor's rate.
        self._task = self.part.reschedule(self._task, 0.0)

    def _publish_once(self) -> None:
        self._publish()
        self._triggers -= 1
        if not self._triggers:
            self._task = self.part.reschedule(self._task, _IDLE_RATE)

    def _wanted(self) -> bool:
        if self._depths is not None and self._depths.wanted:
            return True
        for eye in self._eyes:  # noqa: SIM110 - any() costs more than the answer
            if eye.wanted:
                return True
        return False

    def _publish(self) -> None:
        now, depths = self.part.time_ns, self._depths
        for eye in self._eyes:
            eye.publish_info(now)
        if depths is not None:
            depths.publish_info(now)
        if self._blind:
            return
        try:
            if depths is not None and depths.sees:
                pixels, metres = self._eyes[0].picture_with_depth()
                self._eyes[0].publish(now, pixels)
                depths.publish(now, pixels, metres)
            else:
                for eye in self._eyes:
                    if eye.sees:
                        eye.publish(now, eye.picture())
        except NoOpenGLError as error:
            # Reported once; everything except images continues.
            self._blind = True
            self.warn(error.code, error.message, hint=error.hint or "", values=error.values)
