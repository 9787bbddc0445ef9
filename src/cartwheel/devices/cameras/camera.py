"""Cameras: one or more lenses, rendered at a rate or on a trigger."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from cartwheel.codes import running
from cartwheel.component import Component, Scope
from cartwheel.devices.cameras.depth_camera import DepthConfig, DepthImager
from cartwheel.devices.cameras.imager import Imager, ImagerConfig
from cartwheel.errors import GraphError
from cartwheel.geometry import Pose
from cartwheel.simulation.sensing.opengl import NoOpenGLError

_IDLE_RATE = 1.0
"""Rate at which a triggered camera checks its trigger, Hz."""


@dataclass(frozen=True, kw_only=True, slots=True)
class CameraConfig:
    name: str
    """Name of the camera in the model."""
    link: str
    pose: Pose
    """Pose in the link. The camera looks along its x axis."""
    rate: float
    """Frame rate, Hz; 0: every step."""
    imagers: tuple[ImagerConfig, ...]
    """The lenses; at least one."""
    depth: DepthConfig | None = None
    """Depth topics of the first lens; None: only images are published."""
    trigger_topics: tuple[str, ...] = ()
    """Topics of the Empty messages that trigger an image; empty: the camera streams."""


class Camera(Component):
    """Renders and publishes images while a topic has subscribers, or after a trigger.

    Without OpenGL, a warning is reported once, and everything except images is published.

    Args:
        scope: The camera's model and names.
        config: Mounting, lenses and topics.
    """

    def __init__(self, scope: Scope, config: CameraConfig) -> None:
        super().__init__(scope)
        self._rate = config.rate
        self._pending = 0
        """Trigger messages without an image yet."""
        self._no_opengl = False
        self._triggered = bool(config.trigger_topics)
        self._imagers = [
            Imager(
                self,
                each,
                name=config.name,
                link=config.link,
                pose=config.pose,
                rate=config.rate,
                on_rate=self._set_rate,
            )
            for each in config.imagers
        ]
        for topic in config.trigger_topics:
            self.subscribe(topic, "std_msgs/msg/Empty", self._trigger)
        self._depths = (
            None
            if config.depth is None
            else DepthImager(self, self._imagers[0], config.depth, rate=config.rate or None)
        )
        self._task = self.part.schedule(
            _IDLE_RATE if self._triggered else config.rate,
            after=self._publish_once if self._triggered else self._publish,
            active=(lambda: self._pending > 0) if self._triggered else self._wanted,
            topics=None if self._triggered else self.publishers,
        )

    def _set_rate(self, rate: float) -> None:
        if self._triggered:
            raise GraphError(
                "the rate of a triggered camera cannot be changed", code=running.CAMERA_WITHOUT_RATE
            )
        if rate != self._rate:
            self._rate = rate
            self._task = self.part.reschedule(self._task, rate)

    def _trigger(self, _: Any) -> None:
        self._pending += 1
        # At the next step, regardless of the frame rate.
        self._task = self.part.reschedule(self._task, 0.0)

    def _publish_once(self) -> None:
        self._publish()
        self._pending -= 1
        if not self._pending:
            self._task = self.part.reschedule(self._task, _IDLE_RATE)

    def _wanted(self) -> bool:
        if self._depths is not None and self._depths.wanted:
            return True
        for imager in self._imagers:  # noqa: SIM110 - any() costs more than the answer
            if imager.wanted:
                return True
        return False

    def _publish(self) -> None:
        now, depths = self.part.time_ns, self._depths
        for imager in self._imagers:
            imager.publish_info(now)
        if depths is not None:
            depths.publish_info(now)
        if self._no_opengl:
            return
        try:
            if depths is not None and depths.needs_rendering:
                pixels, metres = self._imagers[0].render_with_depth()
                self._imagers[0].publish(now, pixels)
                depths.publish(now, pixels, metres)
            else:
                for imager in self._imagers:
                    if imager.needs_rendering:
                        imager.publish(now, imager.render())
        except NoOpenGLError as error:
            # Reported once; everything except images continues.
            self._no_opengl = True
            self.warn(error.code, error.message, hint=error.hint or "", values=error.values)
