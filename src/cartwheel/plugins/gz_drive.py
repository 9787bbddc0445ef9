"""What the drives of new Gazebo share: topics under the model's name, limits, odometry."""

from __future__ import annotations

import dataclasses
from dataclasses import dataclass
from typing import Any

from cartwheel.codes import devices
from cartwheel.errors import PluginError
from cartwheel.plugins.base import Plugin
from cartwheel.plugins.gz_bridge import gz_topic
from cartwheel.plugins.odometry import Odometry
from cartwheel.plugins.parameters import tag


@dataclass(frozen=True, kw_only=True, slots=True)
class GzDriveParameters:
    topic: str = tag(
        "topic", default="", doc="Twist that drives; /model/<name>/cmd_vel when empty."
    )
    odom_topic: str = tag(
        "odom_topic", default="", doc="Odometry; /model/<name>/odometry when empty."
    )
    tf_topic: str = tag(
        "tf_topic", default="", doc="TFMessage of the odometry; /model/<name>/tf when empty."
    )
    frame: str = tag("frame_id", default="", doc="Of the odometry; <name>/odom when empty.")
    child_frame: str = tag(
        "child_frame_id", default="", doc="Of the robot; <name>/<root link> when empty."
    )
    rate: float = tag("odom_publish_frequency", default=50.0, unit="Hz", doc="Of what is told.")


@dataclass(frozen=True, kw_only=True, slots=True)
class GzCommonLimits(GzDriveParameters):
    """Of straight and turning motion alike."""

    min_velocity: float | None = tag(
        "min_velocity", default=None, unit="m/s, rad/s", doc="Of the command; none when missing."
    )
    max_velocity: float | None = tag(
        "max_velocity", default=None, unit="m/s, rad/s", doc="Of the command; none when missing."
    )
    min_acceleration: float | None = tag(
        "min_acceleration", default=None, unit="m/s², rad/s²", doc="Of the command."
    )
    max_acceleration: float | None = tag(
        "max_acceleration", default=None, unit="m/s², rad/s²", doc="Of the command."
    )
    min_jerk: float | None = tag("min_jerk", default=None, unit="m/s³", doc="Has no effect.")
    max_jerk: float | None = tag("max_jerk", default=None, unit="m/s³", doc="Has no effect.")


@dataclass(frozen=True, kw_only=True, slots=True)
class GzLimitedParameters(GzCommonLimits):
    """Of each motion its own, where it is stated."""

    min_linear_velocity: float | None = tag(
        "min_linear_velocity", default=None, unit="m/s", doc="In place of min_velocity."
    )
    max_linear_velocity: float | None = tag(
        "max_linear_velocity", default=None, unit="m/s", doc="In place of max_velocity."
    )
    min_angular_velocity: float | None = tag(
        "min_angular_velocity", default=None, unit="rad/s", doc="In place of min_velocity."
    )
    max_angular_velocity: float | None = tag(
        "max_angular_velocity", default=None, unit="rad/s", doc="In place of max_velocity."
    )
    min_linear_acceleration: float | None = tag(
        "min_linear_acceleration", default=None, unit="m/s²", doc="In place of min_acceleration."
    )
    max_linear_acceleration: float | None = tag(
        "max_linear_acceleration", default=None, unit="m/s²", doc="In place of max_acceleration."
    )
    min_angular_acceleration: float | None = tag(
        "min_angular_acceleration", default=None, unit="rad/s²", doc="In place of min_acceleration."
    )
    max_angular_acceleration: float | None = tag(
        "max_angular_acceleration", default=None, unit="rad/s²", doc="In place of max_acceleration."
    )
    min_linear_jerk: float | None = tag(
        "min_linear_jerk", default=None, unit="m/s³", doc="Has no effect."
    )
    max_linear_jerk: float | None = tag(
        "max_linear_jerk", default=None, unit="m/s³", doc="Has no effect."
    )
    min_angular_jerk: float | None = tag(
        "min_angular_jerk", default=None, unit="rad/s³", doc="Has no effect."
    )
    max_angular_jerk: float | None = tag(
        "max_angular_jerk", default=None, unit="rad/s³", doc="Has no effect."
    )


class Limiter:
    """Keeps a commanded speed within its limits, and its change within those of acceleration.

    Args:
        velocity: Least and most, m/s or rad/s; None is no limit.
        acceleration: Least and most, m/s² or rad/s²; None is no limit.
    """

    def __init__(
        self,
        velocity: tuple[float | None, float | None],
        acceleration: tuple[float | None, float | None],
    ) -> None:
        self._velocity, self._acceleration = velocity, acceleration
        self.value = 0.0

    @classmethod
    def common(cls, limits: GzCommonLimits) -> Limiter:
        """That of any motion."""
        return cls(
            (limits.min_velocity, limits.max_velocity),
            (limits.min_acceleration, limits.max_acceleration),
        )

    @classmethod
    def of(cls, limits: GzLimitedParameters, kind: str) -> Limiter:
        """That of ``linear`` or ``angular`` motion."""

        def pair(what: str) -> tuple[float | None, float | None]:
            both = []
            for bound in ("min", "max"):
                own = getattr(limits, f"{bound}_{kind}_{what}")
                both.append(getattr(limits, f"{bound}_{what}") if own is None else own)
            return both[0], both[1]

        return cls(pair("velocity"), pair("acceleration"))

    def step(self, wanted: float, seconds: float) -> float:
        """The speed after a time in s, on the way to the wanted one."""
        low, high = self._acceleration
        change = _clamp(
            wanted - self.value,
            None if low is None else low * seconds,
            None if high is None else high * seconds,
        )
        self.value = _clamp(self.value + change, *self._velocity)
        return self.value


def _clamp(value: float, low: float | None, high: float | None) -> float:
    if low is not None:
        value = max(value, low)
    return value if high is None else min(value, high)


def report_limits(plugin: Plugin[Any], limits: GzCommonLimits) -> None:
    """Tells of limits on jerk, which are not kept.

    Raises:
        PluginError: A least above a most.
    """
    for field in dataclasses.fields(limits):
        value = getattr(limits, field.name)
        if value is not None and "jerk" in field.name:
            plugin.warn(
                devices.PLUGIN_PARAMETER_IGNORED,
                f"<{field.name}> has no effect: jerk is not limited",
                values={"parameter": field.name},
            )
        if value is not None and field.name.startswith("min_"):
            most = getattr(limits, field.name.replace("min_", "max_"))
            if most is not None and value > most:
                raise PluginError(
                    f"<{field.name}> must not exceed its maximum {most:g} (got {value:g})",
                    code=devices.PLUGIN_RANGE_REVERSED,
                    origin=plugin.place_of(field.name),
                    values={"parameter": field.name, "value": value, "most": most},
                )


def gz_name(plugin: Plugin[Any], topic: str, default: str) -> str:
    """A topic as new Gazebo names it: global, and under the model's name by default."""
    return gz_topic(topic.strip() or f"model/{plugin.part.name}/{default}")


def gz_odometry(plugin: Plugin[Any], config: GzDriveParameters) -> Odometry:
    """The odometry of a drive of new Gazebo.

    Raises:
        PluginError: A rate below 0.
    """
    plugin.check_not_negative("rate")
    name = plugin.part.name
    return plugin.keep(
        Odometry(
            plugin,
            topic=gz_name(plugin, config.odom_topic, "odometry"),
            frame=config.frame or f"{name}/odom",
            base=config.child_frame or f"{name}/{plugin.part.description.canonical_link}",
            rate=config.rate,
            transform=True,
            tf_topic=gz_name(plugin, config.tf_topic, "tf"),
        )
    )
