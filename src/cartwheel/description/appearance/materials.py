"""The colours of Gazebo's named materials, and the warning for unknown names.

The names and diffuse colours are from Gazebo Classic 11's scripts. For materials with an image, the
image's mean colour is used, because the images belong to Gazebo.
"""

from __future__ import annotations

from cartwheel.codes.tags import MATERIAL_UNKNOWN
from cartwheel.description.elements import numbers
from cartwheel.description.model import Material, Rgba
from cartwheel.errors import Diagnostic, Origin

_PREFIX = "Gazebo/"

_COLOURS: dict[str, tuple[float, float, float]] = {
    "Grey": (0.7, 0.7, 0.7),
    "DarkGrey": (0.175, 0.175, 0.175),
    "White": (1.0, 1.0, 1.0),
    "FlatBlack": (0.1, 0.1, 0.1),
    "Black": (0.0, 0.0, 0.0),
    "Red": (1.0, 0.0, 0.0),
    "RedBright": (0.87, 0.26, 0.07),
    "Green": (0.0, 1.0, 0.0),
    "Blue": (0.0, 0.0, 1.0),
    # Its diffuse colour is pure blue; in Gazebo's lighting, it looks like its ambient colour.
    "SkyBlue": (0.13, 0.44, 0.70),
    "Yellow": (1.0, 1.0, 0.0),
    "ZincYellow": (0.9725, 0.9529, 0.2078),
    "DarkYellow": (0.7, 0.7, 0.0),
    "Purple": (1.0, 0.0, 1.0),
    "Turquoise": (0.0, 1.0, 1.0),
    "Orange": (1.0, 0.5088, 0.0468),
    "Indigo": (0.33, 0.0, 0.5),
    "JointAnchor": (1.0, 1.0, 1.0),
    "PioneerBody": (1.0, 0.0, 0.0),
    "Pioneer2Body": (0.681, 0.001, 0.001),
    "Gold": (0.8, 0.6487, 0.1208),
    "PointCloud": (0.7, 0.7, 0.7),
}
_GLOWING: dict[str, tuple[float, float, float]] = {
    "WhiteGlow": (1.0, 1.0, 1.0),
    "RedGlow": (1.0, 0.0, 0.0),
    "GreenGlow": (0.0, 1.0, 0.0),
    "BlueGlow": (0.0, 0.0, 1.0),
    "YellowGlow": (1.0, 1.0, 0.0),
    "PurpleGlow": (1.0, 0.0, 1.0),
    "TurquoiseGlow": (0.0, 1.0, 1.0),
    "TurquoiseGlowOutline": (0.0, 1.0, 1.0),
    "LightOn": (0.0, 1.0, 0.0),
    "LightOff": (1.0, 0.0, 0.0),
}
_TRANSPARENT: dict[str, Rgba] = {
    "RedTransparent": (1.0, 0.0, 0.0, 0.5),
    "GreenTransparent": (0.0, 1.0, 0.0, 0.5),
    "BlueTransparent": (0.0, 0.0, 1.0, 0.5),
    "GreyTransparent": (0.5, 0.5, 0.5, 0.5),
    "BlackTransparent": (0.0, 0.0, 0.0, 0.5),
    "YellowTransparent": (1.0, 1.0, 0.0, 0.5),
    "RedTransparentOverlay": (1.0, 0.0, 0.0, 0.5),
    "BlueTransparentOverlay": (0.0, 0.0, 1.0, 0.5),
    "GreenTransparentOverlay": (0.0, 1.0, 0.0, 0.5),
    "OrangeTransparentOverlay": (1.0, 0.44, 0.0, 0.5),
    "DarkOrangeTransparentOverlay": (0.6, 0.3, 0.0, 0.5),
    "OrangeTransparent": (1.0, 0.44, 0.0, 0.4),
    "DarkOrangeTransparent": (0.6, 0.3, 0.0, 0.4),
    "DarkMagentaTransparent": (0.6, 0.0, 0.6, 0.5),
    "BlueLaser": (0.0, 0.0, 1.0, 0.4),
}
_PICTURES: dict[str, tuple[float, float, float]] = {
    "WoodFloor": (0.60, 0.45, 0.30),
    "CeilingTiled": (0.82, 0.82, 0.80),
    "PaintedWall": (0.86, 0.84, 0.78),
    "GrayWall": (0.60, 0.60, 0.60),
    "GreyGradientSky": (0.60, 0.60, 0.62),
    "CloudySky": (0.60, 0.70, 0.85),
    "WoodPallet": (0.66, 0.52, 0.36),
    "Wood": (0.55, 0.38, 0.22),
    "WoodTile": (0.58, 0.42, 0.27),
    "Bricks": (0.58, 0.30, 0.23),
    "WindowFrame": (0.70, 0.70, 0.68),
    "Grass": (0.30, 0.45, 0.18),
    "Asphalt": (0.25, 0.25, 0.26),
    "Road": (0.30, 0.30, 0.31),
    "Residential": (0.32, 0.32, 0.33),
    "Tertiary": (0.32, 0.32, 0.33),
    "Pedestrian": (0.62, 0.60, 0.57),
    "Footway": (0.62, 0.60, 0.57),
    "Motorway": (0.28, 0.28, 0.29),
    "Lanes_6": (0.28, 0.28, 0.29),
    "Trunk": (0.29, 0.29, 0.30),
    "Lanes_4": (0.29, 0.29, 0.30),
    "Primary": (0.30, 0.30, 0.31),
    "Lanes_2": (0.30, 0.30, 0.31),
    "Secondary": (0.31, 0.31, 0.32),
    "Lane_1": (0.31, 0.31, 0.32),
    "Steps": (0.55, 0.53, 0.50),
    "Runway": (0.35, 0.35, 0.36),
}
_DARK: Rgba = (0.0, 0.0, 0.0, 1.0)


def gazebo_material(name: str) -> Material | None:
    """The material with a name such as ``Gazebo/Blue``; None if Gazebo has no such material."""
    if not name.startswith(_PREFIX):
        return None
    short = name.removeprefix(_PREFIX)
    if short in _TRANSPARENT:
        return Material(name=name, diffuse=_TRANSPARENT[short])
    glowing = short in _GLOWING
    colour = _COLOURS.get(short) or _GLOWING.get(short) or _PICTURES.get(short)
    if colour is None:
        return None
    rgba = (*colour, 1.0)
    return Material(name=name, diffuse=rgba, emissive=rgba if glowing else _DARK)


def material_names() -> tuple[str, ...]:
    """All names accepted by `gazebo_material`."""
    known = (*_COLOURS, *_GLOWING, *_TRANSPARENT, *_PICTURES)
    return tuple(sorted(_PREFIX + name for name in known))


def unknown_material(name: str, origin: Origin) -> Diagnostic:
    """The warning for a name that `gazebo_material` does not accept."""
    # Without the common prefix, which would make any two names similar.
    short = [each.removeprefix(_PREFIX) for each in material_names()]
    near = numbers.likely(name.rpartition("/")[2], short)
    meant = f"{_PREFIX}{near}" if near else ""
    return MATERIAL_UNKNOWN.diagnostic(
        f'Gazebo has no material "{name}", so the colour is unchanged',
        origin=origin,
        hint=f'Did you mean "{meant}"?' if meant else "",
        values={"name": name, "meant": meant},
    )
