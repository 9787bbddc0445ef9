"""Types of ``<noise>`` in sensors that Gazebo does not know.

sdformat reports such a type as an error for most sensors, and gz-sim's UserCommands spawns no model
whose SDF has errors. For the other sensors, the noise is ignored. Gazebo Classic creates no noise
model, but its sensors use it, so it crashes.
"""

from __future__ import annotations

from cartwheel.codes.devices import NOISE_TYPE_UNKNOWN
from cartwheel.description.elements.node import Node
from cartwheel.description.sdf.context import Context
from cartwheel.similar_names import meant, suggestion

GAUSSIAN = ("gaussian", "gaussian_quantized")
"""Types with a mean and a standard deviation."""
_OF_GZ = ("none", *GAUSSIAN)
_OF_CLASSIC = (*_OF_GZ, "custom")
"""A plugin of the user makes the noise of the type ``custom``."""
_NOT_READ = (
    "air_pressure",
    "gps",
    "gpu_lidar",
    "gpu_ray",
    "lidar",
    "magnetometer",
    "navsat",
    "ray",
)
"""Types of sensors whose errors in ``<noise>`` sdformat does not pass on."""


def noise_type(stated: str) -> str:
    """The type of noise, as gz-sim reads it: in small letters."""
    return stated.strip().lower()


def report_noises(sensor: Node, ctx: Context) -> None:
    """Reports the first ``<noise>`` of a sensor whose type Gazebo does not know."""
    classic = ctx.simulator == "classic"
    left = [sensor]
    while left:
        node = left.pop()
        left += reversed(node.children)
        if node.tag != "noise" or node.child("rate") or node.child("accel"):
            continue
        stated = (node.attributes.get("type") or node.text_at("type")).strip()
        known = _OF_CLASSIC if classic else _OF_GZ
        if not stated or (stated if classic else noise_type(stated)) in known:
            continue
        kind = sensor.attributes.get("type", "").strip()
        ignored = kind in _NOT_READ and not classic
        effect = "gz-sim does not spawn the model"
        if classic:
            effect = "Gazebo Classic crashes when the sensor measures"
        elif ignored:
            effect = "the sensor has no noise"
        ctx.warn(
            NOISE_TYPE_UNKNOWN,
            f'noise of the type "{stated}" does not exist, so {effect}',
            origin=node.origin,
            hint=suggestion(stated, known),
            severity="warning" if ignored else "error",
            values={
                "sensor": sensor.attributes.get("name", ""),
                "type": stated,
                "meant": meant(stated, known),
            },
        )
        return
