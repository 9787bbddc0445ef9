"""Reports parts of a description that are not built as they are written."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

from cartwheel.codes import tags
from cartwheel.description.idle_settings import idle_settings, without_effect
from cartwheel.description.meshes import known_size, load_mesh, standing_parts
from cartwheel.description.model import Mesh, RobotDescription
from cartwheel.description.paint import paint_of
from cartwheel.errors import Diagnostic
from cartwheel.world.shapes import picture_error
from cartwheel.world.visuals import SMALL, invisible


def unused(description: RobotDescription) -> Iterator[Diagnostic]:
    """A note for each kind of element without effect, at its first occurrence."""
    if description.static:
        yield from _surfaces_as_hulls(description)
    yield from idle_settings([description])


def _surfaces_as_hulls(description: RobotDescription) -> Iterator[Diagnostic]:
    found = [
        collision.origin
        for link in description.links
        for collision in link.collisions
        if isinstance(collision.shape, Mesh) and standing_parts(collision.shape).hulls
    ]
    if found:
        why = "a connected component has too many facets and collides as its convex hull"
        yield without_effect("the triangle surface of a mesh", found[0], len(found), why)


def unreadable(description: RobotDescription) -> Iterator[Diagnostic]:
    """A warning for each visual that cannot be shown, or not with its image.

    Each image is reported at the first visual that uses it.
    """
    seen: set[Path | bytes | None] = {None}
    for visual in (visual for link in description.links for visual in link.visuals):
        images: set[Path | bytes | None] = {visual.material.texture}
        if isinstance(visual.shape, Mesh):
            if (known_size(visual.shape) or 0.0) > SMALL:
                continue
            parts = load_mesh(visual.shape)
            images = {paint_of(visual.material, part).image for part in parts}
            if any(invisible(part) for part in parts):
                yield tags.VALUE_IGNORED.diagnostic(
                    f'a part of the mesh of visual "{visual.name}" has an area below 1 µm², so it '
                    "is ignored",
                    origin=visual.origin,
                    hint="Check the scale of the mesh.",
                    values={"visual": visual.name, "stated": visual.shape.scale},
                )
        for image in images - seen:
            assert image is not None
            seen.add(image)
            error = picture_error(image)
            if error is not None:
                yield error.code.diagnostic(
                    f"{error.message}, so the surface is rendered in its plain colour",
                    severity="warning",
                    origin=visual.origin,
                    hint=error.hint or "",
                    values=error.values,
                )
