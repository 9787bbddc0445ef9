"""SDF's ``<material>``: colours, textures, and Gazebo's named scripts."""

from __future__ import annotations

from pathlib import Path

from cartwheel.codes import files, tags
from cartwheel.description.appearance.materials import gazebo_material, unknown_material
from cartwheel.description.elements.xml import Node
from cartwheel.description.losses import loss
from cartwheel.description.model import Material, Rgba
from cartwheel.description.sdf.context import Context, read_rgba
from cartwheel.description.sdf.links.material_script import find_script
from cartwheel.errors import DescriptionError


def read_material(node: Node | None, ctx: Context) -> Material:
    """A material; without a colour if the mesh's colours are to be used."""
    if node is None:
        return Material()
    script = node.child("script")
    name = ""
    scripted = Material()
    if script is not None:
        name = script.text_at("name").strip()
        uris = script.all("uri")
        if name:
            scripted = _scripted(name, uris, script, ctx)
    diffuse = _colour(node, "diffuse") or scripted.diffuse
    specular = _colour(node, "specular")
    emissive = _colour(node, "emissive")
    texture = _albedo(node, ctx) or scripted.texture
    ambient = next((each for each in node.children if each.tag == "ambient"), None)
    if ambient is not None and (
        diffuse == read_rgba(ambient) or (diffuse is None and texture is None)
    ):
        # Other colours stay unread, and are reported.
        diffuse = _colour(node, "ambient")
    return Material(
        name=name,
        diffuse=diffuse,
        specular=sum(specular[:3]) / 3 if specular else scripted.specular,
        emissive=emissive or scripted.emissive,
        texture=texture,
        texture_scale=scripted.texture_scale,
    )


def _colour(node: Node, tag: str) -> Rgba | None:
    found = node.child(tag)
    return read_rgba(found) if found is not None else None


def _albedo(node: Node, ctx: Context) -> Path | None:
    """The colour image of a physically based material; its other properties are not rendered."""
    pbr = node.child("pbr")
    if pbr is None:
        return None
    image = pbr.find("metal/albedo_map") or pbr.find("specular/albedo_map")
    if image is None or not image.text.strip():
        return None
    try:
        return ctx.packages.resolve(image.text, image.origin, what="texture")
    except DescriptionError as error:
        ctx.report(error.diagnostic("warning"))
        return None


def _scripted(name: str, uris: list[Node], script: Node, ctx: Context) -> Material:
    """The appearance of a named material: built into Gazebo, or in a material script."""
    known = gazebo_material(name)
    if known is not None:
        return known
    places: list[Path] = []
    lost: list[DescriptionError] = []
    for uri in uris:
        try:
            places.append(ctx.packages.resolve(uri.text, uri.origin, what="script", folder=True))
        except DescriptionError as error:
            lost.append(error)
    packages = ctx.packages
    may_read = packages.may_read if packages.reach is not None else lambda _: True
    found = find_script(name, places, may_read)
    if found is None:
        if places and not name.startswith("Gazebo/"):
            ctx.warn(
                tags.MATERIAL_UNDEFINED,
                f'the scripts of the <material> do not define "{name}", so the colour is unchanged',
                origin=script.origin,
                values={"name": name, "meant": ""},
            )
        elif lost and not name.startswith("Gazebo/"):
            ctx.report(
                loss(
                    lost[0],
                    f'the material "{name}" is unknown',
                    of="material",
                    severity="warning",
                    origin=script.origin,
                )
            )
        else:
            ctx.report(unknown_material(name, script.origin))
        return Material(name=name)
    if found.missing is not None:
        ctx.warn(
            files.FILE_MISSING,
            f'the texture "{found.missing}" of material "{name}" does not exist',
            origin=script.origin,
            severity="warning",
            values={"kind": "texture", "name": found.missing, "left_out": "texture"},
        )
    return Material(
        name=name,
        diffuse=found.diffuse,
        emissive=found.emissive or Material().emissive,
        texture=found.texture,
        texture_scale=found.texture_scale,
    )
