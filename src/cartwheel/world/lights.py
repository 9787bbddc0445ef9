"""Lights in a world and on links."""

from __future__ import annotations

import math
from typing import Any

import mujoco

from cartwheel.description.model import Light
from cartwheel.geometry import rotate

_KIND = mujoco.mjtLightType
_ALL_AROUND = 180.0
"""Degrees; a point light is added as a spot without an edge, because the renderer skips others."""

_STEEPEST = 128.0
"""OpenGL's maximum spot exponent."""


def shine(light: Light) -> dict[str, tuple[float, float, float]]:
    """Properties of a light that can change in a compiled model, by MuJoCo's ``light_…`` field."""
    x, y, z = rotate(light.pose.orientation, light.direction)
    length = math.sqrt(x * x + y * y + z * z)
    return {
        "pos": light.pose.position,
        "dir": (x / length, y / length, z / length),
        "diffuse": _brightness(light),
        "attenuation": light.attenuation,
    }


def _brightness(light: Light) -> tuple[float, float, float]:
    factor = light.intensity if light.on else 0.0
    r, g, b = (min(1.0, factor * value) for value in light.diffuse[:3])
    return r, g, b


def add_light(body: Any, name: str, light: Light) -> None:
    """Adds a light that moves with a body in a spec; a world's lights are on its ``worldbody``.

    Args:
        body: The body in whose frame the light's pose is given.
        name: Unique in the spec.
        light: The light. It never casts shadows, even if the description enables them.
    """
    body.add_light(
        name=name,
        type=_KIND.mjLIGHT_DIRECTIONAL if light.type == "directional" else _KIND.mjLIGHT_SPOT,
        ambient=[0, 0, 0],
        specular=[0, 0, 0],
        **{field: list(value) for field, value in shine(light).items()},
        cutoff=math.degrees(light.spot_angle) / 2 if light.type == "spot" else _ALL_AROUND,
        exponent=_exponent(light),
        castshadow=False,
    )


def _exponent(light: Light) -> float:
    """OpenGL's spot exponent of the cosine of the angle from the axis.

    The brightness matches the description's halfway between the inner and outer angle.
    """
    inner, outer = (min(angle, math.pi) / 4 for angle in (light.spot_inner, light.spot_angle))
    middle = math.cos(inner + outer)
    if light.spot_falloff <= 0 or inner >= outer or not 0 < middle < 1:
        return 0.0
    return min(light.spot_falloff * math.log(0.5) / math.log(middle), _STEEPEST)
