"""Common parts of gz-sim's drives: topics under the model's name, limits, odometry."""

from __future__ import annotations

import dataclasses
import math
from dataclasses import dataclass
from typing import Any

from cartwheel.codes import devices
from cartwheel.devices.drives.drive import DriveConfig
from cartwheel.devices.drives.limiter import Bounds, Limits
from cartwheel.devices.drives.odometry import OdometryConfig
from cartwheel.dialects.gz.bridge_file import gz_topic, namespaced
from cartwheel.dialects.plugin import Plugin
from cartwheel.dialects.tags import tag
from cartwheel.errors import PluginError
from cartwheel.simulation import Part

CONTROL_RATE = 100.0
"""Rate of the control loops, which apply limits and measure the wheels, Hz."""

_Pair = tuple[float | None, float | None]
"""Minimum and maximum; None for no limit."""
_UNITS = {
    "velocity": ("m/s", "rad/s"),
    "acceleration": ("m/s²", "rad/s²"),
    "jerk": ("m/s³", "rad/s³"),
}
"""Units of the limits on linear and on angular motion."""


@dataclass(frozen=True, kw_only=True, slots=True)
class GzDriveParameters:
    topic: str = tag(
        "topic",
        default="",
        role="command_topic",
        doc="Topic of the Twist commands. Default: `/model/<model>/cmd_vel`.",
    )
    odom_topic: str = tag(
        "odom_topic", default="", doc="Topic of the odometry. Default: `/model/<model>/odometry`."
    )
    tf_topic: str = tag(
        "tf_topic",
        default="",
        doc="Topic of the odometry transform (TFMessage). Default: `/model/<model>/tf`.",
    )
    frame: str = tag(
        "frame_id", default="", doc="Frame ID of the odometry. Default: `<model>/odom`."
    )
    child_frame: str = tag(
        "child_frame_id",
        default="",
        doc="Child frame ID of the odometry. Default: `<model>/<root link>`.",
    )
    rate: float = tag(
        "odom_publish_frequency",
        default=50.0,
        unit="Hz",
        least=0.0,
        doc="Publish rate of the odometry. If 0, it is published at every simulation step.",
    )


def limit_tag(name: str, *, motion: str = "", path: str = "") -> Any:
    """A limit on linear or angular motion, or on both, as the words of its name state.

    Args:
        name: Name of the tag.
        motion: ``linear`` or ``angular``, if the name does not state the motion.
        path: Tag that contains the tag, with a slash.
    """
    bound, *words, quantity = name.split("_")
    word = {"min": "Minimum", "max": "Maximum"}[bound]
    linear, angular = _UNITS[quantity]
    unit = angular if "angular" in (*words, motion) else linear
    if quantity == "jerk":
        doc = "No effect: jerk is not limited."
    elif motion:
        doc = f"{word} {motion} {quantity}. Default: no limit."
    elif words:
        motion = words[0]
        doc = f"{word} {motion} {quantity}. Overrides `<{bound}_{quantity}>`."
    else:
        doc = (
            f"{word} of the linear {quantity} (in {linear}) and of the angular {quantity} (in "
            f"{angular}). Default: no limit."
        )
        unit = f"{linear} or {angular}"
    return tag(f"{path}{name}", default=None, unit=unit, doc=doc)


@dataclass(frozen=True, kw_only=True, slots=True)
class GzCommonLimits(GzDriveParameters):
    """Limits on linear and angular motion."""

    min_velocity: float | None = limit_tag("min_velocity")
    max_velocity: float | None = limit_tag("max_velocity")
    min_acceleration: float | None = limit_tag("min_acceleration")
    max_acceleration: float | None = limit_tag("max_acceleration")
    min_jerk: float | None = limit_tag("min_jerk")
    max_jerk: float | None = limit_tag("max_jerk")


@dataclass(frozen=True, kw_only=True, slots=True)
class GzLimitedParameters(GzCommonLimits):
    """Separate limits for linear and angular motion, which override the common limits."""

    min_linear_velocity: float | None = limit_tag("min_linear_velocity")
    max_linear_velocity: float | None = limit_tag("max_linear_velocity")
    min_angular_velocity: float | None = limit_tag("min_angular_velocity")
    max_angular_velocity: float | None = limit_tag("max_angular_velocity")
    min_linear_acceleration: float | None = limit_tag("min_linear_acceleration")
    max_linear_acceleration: float | None = limit_tag("max_linear_acceleration")
    min_angular_acceleration: float | None = limit_tag("min_angular_acceleration")
    max_angular_acceleration: float | None = limit_tag("max_angular_acceleration")
    min_linear_jerk: float | None = limit_tag("min_linear_jerk")
    max_linear_jerk: float | None = limit_tag("max_linear_jerk")
    min_angular_jerk: float | None = limit_tag("min_angular_jerk")
    max_angular_jerk: float | None = limit_tag("max_angular_jerk")


def common_limits(limits: Any, *, prefix: str = "") -> Limits:
    """Returns the limits on any motion, or those in the fields whose names begin with `prefix`."""

    def pair(what: str) -> _Pair:
        low, high = (getattr(limits, f"{prefix}{bound}_{what}") for bound in ("min", "max"))
        return low, high

    return _limits(pair("velocity"), pair("acceleration"))


def separate_limits(limits: GzLimitedParameters, kind: str) -> Limits:
    """Returns the limits on ``linear`` or ``angular`` motion."""

    def pair(what: str) -> _Pair:
        both = []
        for bound in ("min", "max"):
            own = getattr(limits, f"{bound}_{kind}_{what}")
            both.append(getattr(limits, f"{bound}_{what}") if own is None else own)
        return both[0], both[1]

    return _limits(pair("velocity"), pair("acceleration"))


def _limits(velocity: _Pair, acceleration: _Pair) -> Limits:
    return Limits(
        velocity=None if velocity == (None, None) else _bounds(*velocity),
        # gz-sim adds the change to the last command even if it has no limit, which rounds.
        acceleration=_bounds(*acceleration),
    )


def _bounds(low: float | None, high: float | None) -> Bounds:
    return -math.inf if low is None else low, math.inf if high is None else high


def report_limits(plugin: Plugin[Any], limits: Any) -> None:
    """Warns about jerk limits, which are not supported, and checks the other limits.

    Raises:
        PluginError: A minimum exceeds its maximum.
    """
    for field in dataclasses.fields(limits):
        value = getattr(limits, field.name)
        if value is not None and "jerk" in field.name:
            plugin.warn_ignored(field.metadata["tags"][0], "jerk is not limited")
        if value is not None and "min_" in field.name:
            most = getattr(limits, field.name.replace("min_", "max_"))
            if most is not None and value > most:
                name = field.metadata["tags"][0]
                raise PluginError(
                    f"<{name}> must not exceed its maximum {most:g} (got {value:g})",
                    code=devices.PLUGIN_RANGE_REVERSED,
                    origin=plugin.place_of(name),
                    values={"parameter": name, "value": value, "most": most},
                )


def gz_name(plugin: Plugin[Any], topic: str, default: str) -> str:
    """Returns the global name of a gz-sim topic.

    Args:
        plugin: The plugin.
        topic: Topic in the description. If it is relative, it is in the namespace in which the
            model was spawned.
        default: The topic under the model's name, if the description states none.
    """
    if topic.strip():
        return namespaced(topic, plugin.part.namespace)
    return gz_topic(f"model/{plugin.part.name}/{default}")


def model_frame(part: Part, frame: str) -> str:
    """Returns a frame under the model's name, which the prefix of the model's frames replaces."""
    return frame if part.frame_prefix.strip("/") else f"{part.name}/{frame}"


def gz_drive(plugin: Plugin[Any], config: GzDriveParameters, *, topic: str = "") -> DriveConfig:
    """Returns the topics and rates of a gz-sim drive.

    Args:
        plugin: The drive.
        config: Its tags.
        topic: Topic of the commands, if ``<topic>`` is not set.

    Raises:
        PluginError: The rate is negative.
    """
    part = plugin.part
    return DriveConfig(
        command_topic=gz_name(plugin, config.topic or topic, "cmd_vel"),
        control_rate=CONTROL_RATE,
        # DART clips the velocities that are commanded.
        limited_joints=True,
        odometry=OdometryConfig(
            topic=gz_name(plugin, config.odom_topic, "odometry"),
            frame=config.frame or model_frame(part, "odom"),
            base=config.child_frame or model_frame(part, part.description.canonical_link),
            rate=config.rate,
            tf_topic=gz_name(plugin, config.tf_topic, "tf"),
        ),
    )
