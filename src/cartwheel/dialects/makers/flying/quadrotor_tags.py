"""The tags of quadrotors that follow velocities without propellers."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Literal

from cartwheel.codes import running
from cartwheel.devices.air.filtered_pid import FilteredPidConfig
from cartwheel.devices.air.velocity_control import VelocityControlConfig
from cartwheel.dialects.plugin import Plugin
from cartwheel.dialects.tags import tag
from cartwheel.errors import UnknownNameError

_TILT, _YAW = "roll and pitch", "the yaw rate"
_LEVEL, _CLIMB = "the horizontal velocity", "the vertical velocity"


def gain_tag(prefix: str, kind: str, what: str) -> Any:
    """Declares the gain of a controller.

    Args:
        prefix: First part of the tag's name.
        kind: ``Proportional``, ``Integral`` or ``Differential``.
        what: What the controller controls.
    """
    return tag(f"{prefix}{kind}Gain", default=None, doc=f"{kind} gain of {what}.")


def filter_tag(prefix: str, what: str) -> Any:
    """Declares the time constant of a controller; see `gain_tag`."""
    return tag(
        f"{prefix}TimeConstant",
        default=0.0,
        unit="s",
        least=0.0,
        doc=f"Time constant of the filter of {what}'s target.",
    )


def limit_tag(prefix: str, what: str) -> Any:
    """Declares the limit of a controller; see `gain_tag`."""
    return tag(
        f"{prefix}Limit",
        default=-1.0,
        doc=f"Largest magnitude of {what}'s target; not limited if 0 or negative.",
    )


@dataclass(frozen=True, kw_only=True, slots=True)
class QuadrotorTags:
    """The tags that these plugins share."""

    body: str = tag(
        "bodyName",
        default="",
        role="link",
        doc="Link on which the force and the torque act. Default: the root link.",
    )
    max_force: float = tag(
        "maxForce", default=-1.0, unit="N", doc="Largest force; not limited if 0 or negative."
    )
    tilt_p: float | None = gain_tag("rollpitch", "Proportional", _TILT)
    tilt_i: float | None = gain_tag("rollpitch", "Integral", _TILT)
    tilt_d: float | None = gain_tag("rollpitch", "Differential", _TILT)
    tilt_time: float = filter_tag("rollpitch", _TILT)
    tilt_limit: float = limit_tag("rollpitch", _TILT)
    yaw_p: float | None = gain_tag("yaw", "Proportional", _YAW)
    yaw_i: float | None = gain_tag("yaw", "Integral", _YAW)
    yaw_d: float | None = gain_tag("yaw", "Differential", _YAW)
    yaw_time: float = filter_tag("yaw", _YAW)
    yaw_limit: float = limit_tag("yaw", _YAW)
    level_p: float | None = gain_tag("velocityXY", "Proportional", _LEVEL)
    level_i: float | None = gain_tag("velocityXY", "Integral", _LEVEL)
    level_d: float | None = gain_tag("velocityXY", "Differential", _LEVEL)
    level_time: float = filter_tag("velocityXY", _LEVEL)
    level_limit: float = limit_tag("velocityXY", _LEVEL)
    climb_p: float | None = gain_tag("velocityZ", "Proportional", _CLIMB)
    climb_i: float | None = gain_tag("velocityZ", "Integral", _CLIMB)
    climb_d: float | None = gain_tag("velocityZ", "Differential", _CLIMB)
    climb_time: float = filter_tag("velocityZ", _CLIMB)
    climb_limit: float = limit_tag("velocityZ", _CLIMB)


def read_pid(tags: QuadrotorTags, name: str, *, p: float, d: float) -> FilteredPidConfig:
    """Returns the controller whose fields begin with a name.

    Args:
        tags: The tags.
        name: First part of the names of the fields.
        p: Default of the proportional gain.
        d: Default of the differential gain.
    """
    p_stated, i_stated, d_stated = (getattr(tags, f"{name}_{each}") for each in "pid")
    return FilteredPidConfig(
        p=p if p_stated is None else p_stated,
        i=i_stated or 0.0,
        d=d if d_stated is None else d_stated,
        time_constant=getattr(tags, f"{name}_time"),
        limit=getattr(tags, f"{name}_limit"),
    )


def read_control(
    plugin: Plugin[Any],
    *,
    p: float,
    d: float,
    acts_at: Literal["origin", "centre of mass"],
    leads: bool,
) -> VelocityControlConfig:
    """Returns the controllers that a plugin describes.

    Args:
        plugin: The plugin, whose parameters are `QuadrotorTags`.
        p: Default of the proportional gains.
        d: Default of the differential gains.
        acts_at: Point at which the force acts.
        leads: See `FilteredPid`.

    Raises:
        UnknownNameError: The link does not exist.
    """
    config: QuadrotorTags = plugin.config
    part = plugin.part
    link = config.body.strip() or part.description.canonical_link
    if part.description.link(link) is None:
        raise UnknownNameError(
            "link",
            link,
            [each.name for each in part.description.links],
            code=running.UNKNOWN_LINK,
            origin=plugin.scope.place_of("bodyName"),
        )
    tilt, yaw, level, climb = (
        read_pid(config, name, p=p, d=d) for name in ("tilt", "yaw", "level", "climb")
    )
    return VelocityControlConfig(
        link=link,
        tilt=tilt,
        yaw=yaw,
        level=level,
        climb=climb,
        max_force=config.max_force,
        acts_at=acts_at,
        leads=leads,
    )
