"""SDF's ``<light>``, in a world or in a link."""

from __future__ import annotations

from typing import Literal

from cartwheel.codes.tags import TYPE_UNKNOWN
from cartwheel.description.elements.xml import Node
from cartwheel.description.model import Light
from cartwheel.description.sdf.context import read_rgba, require_name
from cartwheel.geometry import Pose

Kind = Literal["directional", "point", "spot"]


def read_light(node: Node, pose: Pose) -> Light:
    """A light.

    Args:
        node: The element.
        pose: Its resolved pose in the world or link.
    """
    default = Light(name="", origin=node.origin)
    kinds: dict[str, Kind] = {"directional": "directional", "point": "point", "spot": "spot"}
    kind = kinds.get(node.require("type").strip())
    if kind is None:
        raise node.fail(
            f'the light type "{node.attributes["type"]}" is unknown',
            "Valid types: directional, point, spot.",
            code=TYPE_UNKNOWN,
            values={"name": node.attributes["type"]},
        )
    diffuse, specular = node.child("diffuse"), node.child("specular")
    direction = node.vec3_at("direction", (0.0, 0.0, -1.0))
    if not any(direction):
        raise node.fail("the direction of a light must not be 0 0 0")
    return Light(
        name=require_name(node),
        type=kind,
        pose=pose,
        diffuse=read_rgba(diffuse) if diffuse is not None else default.diffuse,
        specular=read_rgba(specular) if specular is not None else default.specular,
        direction=direction,
        range=node.number_at("attenuation/range", default.range),
        attenuation=(
            node.number_at("attenuation/constant", default.attenuation[0]),
            node.number_at("attenuation/linear", default.attenuation[1]),
            node.number_at("attenuation/quadratic", default.attenuation[2]),
        ),
        spot_angle=node.number_at("spot/outer_angle", default.spot_angle),
        spot_inner=node.number_at("spot/inner_angle", default.spot_inner),
        spot_falloff=node.number_at("spot/falloff", default.spot_falloff),
        intensity=max(0.0, node.number_at("intensity", 1.0)),
        on=node.boolean_at("light_on", True),
        cast_shadows=node.boolean_at("cast_shadows", kind == "directional"),
        origin=node.origin,
    )
