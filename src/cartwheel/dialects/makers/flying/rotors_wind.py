"""``librotors_gazebo_wind_plugin.so``: the force of wind on a link."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any, ClassVar

from cartwheel.devices.air.wind_force import WindForce, WindForceConfig
from cartwheel.dialects.common_tags import ZEROS
from cartwheel.dialects.plugin import Plugin
from cartwheel.dialects.tags import tag
from cartwheel.geometry import Vec3

_SPEED = "No effect: no plugin reads the speed of the wind, and the type of its topic is unknown."


def _unused(name: str) -> Any:
    return tag(name, default=None, doc=_SPEED)


@dataclass(frozen=True, kw_only=True, slots=True)
class RotorsWindParameters:
    link: str = tag("linkName", role="link", doc="Link on which the wind acts.")
    offset: tuple[float, float, float] = tag(
        "xyzOffset",
        default=ZEROS,
        unit="m",
        doc="Where it acts, from the link's centre of mass, along the axes of the link.",
    )
    topic: str = tag(
        "windForcePubTopic", default="external_force", doc="Topic of the force (WrenchStamped)."
    )
    frame: str = tag("frameId", default="world", doc="Frame ID of the messages.")
    mean: float = tag("windForceMean", default=0.0, unit="N", doc="Constant force.")
    direction: tuple[float, float, float] = tag(
        "windDirection",
        default=(1.0, 0.0, 0.0),
        doc="Direction of the constant force, in the world.",
    )
    gust_mean: float = tag("windGustForceMean", default=0.0, unit="N", doc="Force of the gust.")
    gust_direction: tuple[float, float, float] = tag(
        "windGustDirection", default=(0.0, 1.0, 0.0), doc="Direction of the gust, in the world."
    )
    gust_start: float = tag(
        "windGustStart", default=10.0, unit="s", least=0.0, doc="Start of the gust."
    )
    gust_duration: float = tag(
        "windGustDuration", default=0.0, unit="s", least=0.0, doc="Duration of the gust."
    )
    variance: str | None = tag(
        "windForceVariance",
        "windGustForceVariance",
        default=None,
        doc="No effect, as in the original plugin.",
    )
    speed: str | None = _unused("windSpeedMean")
    speed_variance: str | None = _unused("windSpeedVariance")
    speed_topic: str | None = _unused("windSpeedPubTopic")
    field: bool = tag(
        "useCustomStaticWindField",
        default=False,
        doc="No effect: wind fields in files are not supported.",
    )
    path: str | None = tag(
        "customWindFieldPath", default=None, doc="No effect: see `<useCustomStaticWindField>`."
    )


class RotorsWind(Plugin[RotorsWindParameters]):
    """Applies the force of constant wind, and of one gust, to a link.

    Original plugin: ``gazebo_wind_plugin`` in the package ``rotors_gazebo_plugins``.
    """

    filenames: ClassVar[tuple[str, ...]] = ("librotors_gazebo_wind_plugin.so",)

    def configure(self) -> None:
        config = self.config
        if config.field:
            self.warn_ignored("useCustomStaticWindField", "wind fields in files are not supported")
        self.add(
            WindForce(
                self.scope,
                WindForceConfig(
                    link=config.link,
                    place=config.offset,
                    force=_along(config.direction, config.mean),
                    gust=_along(config.gust_direction, config.gust_mean),
                    begin=config.gust_start,
                    end=config.gust_start + config.gust_duration,
                    topic=config.topic,
                    frame=config.frame,
                ),
            )
        )


def _along(direction: Vec3, size: float) -> Vec3:
    """A vector of this size; without a direction, it is zero."""
    length = math.hypot(*direction)
    x, y, z = (each * size / length if length > 0 else 0.0 for each in direction)
    return x, y, z
