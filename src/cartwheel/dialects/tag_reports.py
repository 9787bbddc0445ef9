"""Reports about tags that a plugin does not read, or not as they are written."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

from cartwheel.codes import devices
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
