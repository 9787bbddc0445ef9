"""Tags that plugins of all dialects share: joints, sizes, frames, rates, noise and poses."""

from __future__ import annotations

from typing import Any

from cartwheel.dialects.tag_roles import Role
from cartwheel.dialects.tags import SMALLEST, tag
from cartwheel.geometry import Vec3
from cartwheel.simulation.limits import FARTHEST

# The functions return Any, as `tag` does, because a field with a tag can have any type. Each takes
# the names of the tag, because plugins differ in the spellings that they accept.
ZEROS = (0.0, 0.0, 0.0)


def joint_tag(name: str, *, role: Role = "joint", optional: bool = False, doc: str) -> Any:
    """A joint that by default has the name of the tag."""
    return tag(name, default=name, role=role, optional=optional, doc=doc)


def joints_tag(name: str, *, role: Role = "joint", doc: str) -> Any:
    """Joints in a tag that can be repeated; by default one joint with the name of the tag."""
    return tag(name, default=(name,), role=role, doc=doc)


def size_tag(
    *names: str, default: float, role: Role = "", wheels: tuple[str, ...] = (), doc: str
) -> Any:
    """A positive length, m."""
    return tag(
        *names,
        default=default,
        unit="m",
        least=SMALLEST,
        most=FARTHEST,
        role=role,
        wheels=wheels,
        doc=doc,
    )


def sensor_frame_tag(*names: str) -> Any:
    """The frame ID of a sensor's messages."""
    return tag(
        *names,
        default="",
        role="frame",
        doc="Frame ID of the messages. Default: the sensor's link.",
    )


def link_frame_tag(*names: str) -> Any:
    """The frame ID of the messages about the link in ``<bodyName>``."""
    return tag(
        *names,
        default="",
        role="frame",
        doc="Frame ID of the messages. Default: the link in `<bodyName>`.",
    )


def publish_rate_tag(*names: str, default: float = 0.0, of: str = "") -> Any:
    """The publish rate, Hz, `of` certain topics or of the only one."""
    return tag(
        *names,
        default=default,
        unit="Hz",
        least=0.0,
        doc=f"Publish rate{of and f' of {of}'}. If 0, messages are published at every simulation "
        "step.",
    )


def sensor_rate_tag(*names: str, what: str = "Publish rate", least: float | None = None) -> Any:
    """A rate, Hz, that does not exceed that of the sensor."""
    return tag(
        *names,
        default=0.0,
        unit="Hz",
        least=least,
        doc=f"{what}, limited to the sensor's `<update_rate>`. If 0, the sensor's rate applies.",
    )


def idle_rate_tag(*names: str) -> Any:
    """A rate without effect, because the sensor has one as well."""
    return tag(
        *names,
        default=0.0,
        unit="Hz",
        doc="No effect: the sensor's `<update_rate>` applies.",
    )


def deviation_tag(*names: str, default: float | Vec3 = 0.0, unit: str = "", of: str) -> Any:
    """The standard deviation `of` a noise or a drift."""
    return tag(*names, default=default, unit=unit, least=0.0, doc=f"Standard deviation of {of}.")


def position_tag(*names: str, of: str) -> Any:
    """A position, m, by default the origin."""
    return tag(*names, default=ZEROS, unit="m", doc=f"Position of {of}.")


def rotation_tag(*names: str, of: str) -> Any:
    """An orientation, rad, by default none."""
    return tag(*names, default=ZEROS, unit="rad", doc=f"Roll, pitch and yaw of {of}.")
