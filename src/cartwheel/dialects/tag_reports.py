"""Reports about tags that a plugin does not read, or not as they are written."""

from __future__ import annotations

from collections.abc import Collection, Iterable, Sequence

from cartwheel.codes import devices
from cartwheel.codes import tags as tag_codes
from cartwheel.description.elements import numbers
from cartwheel.description.model import Element
from cartwheel.errors import Diagnostic, PluginError
from cartwheel.similar_names import meant_one

_OF_SENSORS = {"imu", "ray", "lidar", "camera", "gps", "magnetometer", "altimeter", "noise"}
"""Elements of a ``<sensor>``, which some descriptions place in a ``<plugin>``."""


def unknown(element: Element, known: Iterable[str]) -> Diagnostic:
    """The warning about a tag that a plugin does not read."""
    meant = meant_one(element.tag, sorted(known))
    hint = f"Did you mean <{meant}>?" if meant else ""
    of_sensor = element.tag in _OF_SENSORS
    if of_sensor:
        noise = next((each for each in ("gaussianNoise", "gaussian_noise") if each in known), "")
        hint = (
            f"<{element.tag}> is an element of <sensor>: place it beside the <plugin> in a sensor."
        )
        if noise:
            hint += f" The noise of this plugin is <{noise}>."
    return devices.PLUGIN_PARAMETER_UNKNOWN.diagnostic(
        f"<{element.tag}> has no effect: the plugin does not support this tag",
        origin=element.origin,
        hint=hint,
        values={"parameter": element.tag, "meant": meant, "of_sensor": of_sensor},
        mark=f"<{element.tag}",
    )


def repeated(used: Element, siblings: Collection[Element]) -> list[Diagnostic]:
    """The warning about a tag that is stated again with another value.

    Gazebo's plugins get the first element of a name (``sdf::Element::GetElement``).

    Args:
        used: The first tag.
        siblings: The tags in the plugin, in which nested tags are not found.
    """
    value = used.text.strip()
    other = next(
        (each for each in siblings if each.tag == used.tag and _differ(each.text.strip(), value)),
        None,
    )
    if other is None or all(each is not used for each in siblings):
        return []
    return [
        tag_codes.TAG_REPEATED.diagnostic(
            f"<{used.tag}> is repeated with another value, so only the first is used",
            origin=other.origin,
            hint=f"The first is at {used.origin}." if used.origin is not None else "",
            values={"tag": used.tag, "used": value, "value": other.text.strip()},
            mark=f"<{used.tag}",
        )
    ]


def _differ(one: str, other: str) -> bool:
    """Whether two texts are different values; 1.0 and 1 are not."""
    try:
        return float(one) != float(other)
    except ValueError:
        return one != other


def kept(error: PluginError, element: Element, default: str, allowed: Sequence[str]) -> Diagnostic:
    """The warning about a word that is not allowed, instead of which the default is used."""
    near = numbers.likely(element.text.strip().lower(), allowed)
    return devices.PLUGIN_PARAMETER_INVALID.diagnostic(
        f"{error.message}, so {default} is used",
        severity="warning",
        origin=element.origin,
        hint=f'Did you mean "{near}"?' if near else "",
        values={"parameter": element.tag, "value": element.text.strip(), "used": default},
        mark=f"<{element.tag}",
    )
