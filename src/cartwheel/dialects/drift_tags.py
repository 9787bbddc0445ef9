"""Tags of sensors whose error drifts: a constant offset, a drift, noise and a scale factor."""

from __future__ import annotations

from typing import Any

import numpy as np

from cartwheel.devices.noise import DriftingErrorConfig
from cartwheel.dialects.plugin import Plugin
from cartwheel.dialects.tags import tag
from cartwheel.geometry import Vec3

UNSCALED = (1.0, 1.0, 1.0)
HOUR = 1 / 3600.0
"""Inverse of the default time constant of a drift, 1/s."""
HOURS = (HOUR, HOUR, HOUR)


def offset_tag(*names: str, default: float | Vec3 = 0.0, unit: str = "", of: str) -> Any:
    """The constant error `of` a quantity."""
    return tag(*names, default=default, unit=unit, doc=f"Constant error of {of}.")


def frequency_tag(*names: str, default: float | Vec3 = HOUR, of: str = "") -> Any:
    """The inverse of the time constant of a drift, 1/s, `of` one quantity or of the only one."""
    doc = (
        f"Inverse of the time constant of {of}." if of else "Inverse of the drift's time constant."
    )
    return tag(*names, default=default, unit="1/s", least=0.0, doc=doc)


def drifting_error(
    plugin: Plugin[Any], name: str, *, prefix: str = "", **instead: Any
) -> DriftingErrorConfig:
    """Returns the error that the tags describe.

    Args:
        plugin: The plugin, whose parameters have the fields `offset`, `drift`, `frequency`, `noise`
            and `scale`, and `update_rate`.
        name: Name of the random sequence.
        prefix: Prefix of the five fields.
        instead: Values that replace those of the fields.
    """
    fields = ("offset", "drift", "frequency", "noise", "scale")
    values = {each: getattr(plugin.config, prefix + each) for each in fields} | instead
    lists = {each: np.atleast_1d(value).tolist() for each, value in values.items()}
    return DriftingErrorConfig(name=name, rate=plugin.config.update_rate, **lists)
