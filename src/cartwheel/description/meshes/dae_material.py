"""Reads COLLADA materials as a diffuse colour with alpha, or an image."""

from __future__ import annotations

import xml.etree.ElementTree as ET
from dataclasses import dataclass
from pathlib import Path
from urllib.parse import unquote

from cartwheel.description.model import Rgba

_SHADERS = ("phong", "lambert", "blinn", "constant")


@dataclass(frozen=True, slots=True)
class MaterialLook:
    rgba: Rgba | None = None
    texture: Path | None = None


class Library:
    """Elements of a COLLADA document by id."""

    def __init__(self, root: ET.Element) -> None:
        self._by_id: dict[str, ET.Element] = {}
        for element in root.iter():
            name = element.get("id")
            if name is not None:
                self._by_id.setdefault(name, element)

    def get(self, url: str) -> ET.Element | None:
        """The element with an id, with or without a leading ``#``."""
        return self._by_id.get(url.removeprefix("#"))


def read_look(library: Library, material: str, path: Path, notes: list[str]) -> MaterialLook:
    """Colour and texture of a material; empty if it has neither.

    Args:
        library: The document.
        material: The material's id.
        path: The document's file; images are relative to it.
        notes: Receives notes about missing parts.
    """
    element = library.get(material)
    instance = element.find("instance_effect") if element is not None else None
    effect = library.get(instance.get("url", "")) if instance is not None else None
    profile = effect.find("profile_COMMON") if effect is not None else None
    technique = profile.find("technique") if profile is not None else None
    if profile is None or technique is None:
        return MaterialLook()
    shader = next((child for child in technique if child.tag in _SHADERS), None)
    if shader is None:
        return MaterialLook()
    alpha = _alpha(shader)
    texture = shader.find("diffuse/texture")
    if texture is not None:
        image = _image(library, profile, texture.get("texture", ""), path, notes)
        return MaterialLook((1.0, 1.0, 1.0, alpha) if image else None, image)
    # A constant shader has no diffuse colour, only emission.
    colour = shader.find("diffuse/color")
    if colour is None:
        colour = shader.find("emission/color")
    if colour is None:
        return MaterialLook()
    r, g, b = (_clamp(c) for c in _numbers(colour, 3)[:3])
    return MaterialLook((r, g, b, alpha))


def _alpha(shader: ET.Element) -> float:
    """Opacity by COLLADA's two rules; 1 if they would make the mesh invisible.

    Exporters disagree on whether transparency 0 or 1 means opaque. An invisible mesh is never
    intended, so zero opacity indicates the other convention.
    """
    transparent = shader.find("transparent")
    colour = transparent.find("color") if transparent is not None else None
    amount = shader.find("transparency/float")
    factor = _numbers(amount, 1)[0] if amount is not None else 1.0
    if colour is None or transparent is None:
        alpha = factor if amount is not None else 1.0
    else:
        r, g, b, a = (*_numbers(colour, 3), 1.0)[:4]
        mode = transparent.get("opaque", "A_ONE")
        luminance = 0.212671 * r + 0.715160 * g + 0.072169 * b
        alpha = {
            "A_ONE": a * factor,
            "A_ZERO": 1 - a * factor,
            "RGB_ZERO": 1 - luminance * factor,
            "RGB_ONE": luminance * factor,
        }.get(mode, 1.0)
    alpha = _clamp(alpha)
    return alpha if alpha > 0 else 1.0


def _image(
    library: Library, profile: ET.Element, name: str, path: Path, notes: list[str]
) -> Path | None:
    """The image file of a texture, found through its sampler, surface and image by sid or id."""
    parameters = {each.get("sid", ""): each for each in profile.iter("newparam")}
    sampler = parameters.get(name)
    if sampler is not None:
        source = sampler.find("sampler2D/source")
        direct = sampler.find("sampler2D/instance_image")
        if direct is not None:
            name = direct.get("url", "")
        elif source is not None:
            surface = parameters.get((source.text or "").strip())
            initial = surface.find("surface/init_from") if surface is not None else None
            name = (initial.text or "").strip() if initial is not None else name
    image = library.get(name)
    initial = image.find("init_from") if image is not None else None
    if initial is not None and initial.find("ref") is not None:  # COLLADA 1.5
        initial = initial.find("ref")
    written = (initial.text or "").strip() if initial is not None else ""
    if not written:
        notes.append(f'texture "{name}" does not refer to an image file')
        return None
    relative = unquote(written.removeprefix("file://")).replace("\\", "/")
    # Absolute paths are from the exporter's machine, so the file is searched near the mesh.
    candidates = [path.parent / relative, path.parent / Path(relative).name]
    candidates += [path.parent.parent / "materials" / "textures" / Path(relative).name]
    for candidate in candidates:
        if candidate.is_file():
            return candidate
    notes.append(f'texture "{written}" does not exist')
    return None


def _numbers(element: ET.Element, least: int) -> tuple[float, ...]:
    values = tuple(float(word) for word in (element.text or "").split())
    if len(values) < least or not all(abs(v) < 1e6 for v in values):
        raise ValueError(
            f"the COLLADA element <{element.tag}> must contain at least {least} numbers, and the "
            "absolute value of each must be below 1,000,000"
        )
    return values


def _clamp(value: float) -> float:
    return max(0.0, min(1.0, value))
