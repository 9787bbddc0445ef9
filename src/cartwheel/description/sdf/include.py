"""SDF's ``<include>``: finds the model's file, and applies the includer's changes."""

from __future__ import annotations

import contextlib
from dataclasses import dataclass
from pathlib import Path

from cartwheel.codes import files, tags
from cartwheel.description.elements.xml import Node, read_file
from cartwheel.description.files import fuel
from cartwheel.description.files.made_files import maker_of
from cartwheel.description.losses import loss
from cartwheel.description.model import PluginTag
from cartwheel.description.sdf.context import (
    MAX_INCLUDES,
    MODERN,
    Context,
    read_version,
    simulator_for,
)
from cartwheel.description.sdf.oldest import as_modern
from cartwheel.description.sdf.sensors import read_plugins
from cartwheel.errors import DescriptionError, Origin


@dataclass(frozen=True, slots=True)
class Included:
    """The included element and the includer's changes."""

    node: Node
    """A ``<model>``, a ``<light>``, or the ``<robot>`` of a URDF."""
    root: Node
    """Root of the included file."""
    ctx: Context
    origin: Origin
    """The ``<include>``."""
    name: str | None = None
    pose: Node | None = None
    static: bool | None = None
    placement_frame: str = ""
    plugins: tuple[PluginTag, ...] = ()
    merge: bool = False


class NotThereError(DescriptionError):
    """The target of an ``<include>`` is missing on this machine, or is not supported."""


def open_include(node: Node, ctx: Context) -> Included:
    """Reads the file of an ``<include>``.

    Raises:
        NotThereError: The file is missing, or contains an actor.
        DescriptionError: The file includes itself, or contains nothing to include.
    """
    uri = node.child("uri")
    if uri is None:
        raise NotThereError(
            "<include> has no <uri>",
            code=tags.TAG_MISSING,
            origin=node.origin,
            values={"missing": "uri"},
        )
    path = _file(uri, ctx).resolve()
    if path in ctx.including or len(ctx.including) >= MAX_INCLUDES:
        raise node.fail(f'"{uri.text}" includes itself', code=files.INCLUDE_RECURSIVE)
    root = read_file(path)
    if root.tag not in ("sdf", "gazebo", "robot"):
        raise root.fail(
            f"expected <sdf>, but the file begins with <{root.tag}>", code=files.NOT_A_DESCRIPTION
        )
    version = ctx.version if root.tag == "robot" else read_version(root)
    if root.tag != "robot" and version < MODERN:
        root = as_modern(root)
    including = (*ctx.including, path)
    simulator = simulator_for(root, version, ctx.simulator)
    inner = Context(ctx.packages, version, ctx.diagnostics, including, simulator)
    name = node.child("name")
    static = node.child("static")
    return Included(
        node=root if root.tag == "robot" else _chosen(root, uri),
        root=root,
        ctx=inner,
        origin=node.origin,
        name=name.text.strip() or None if name is not None else None,
        pose=node.child("pose"),
        static=static.boolean() if static is not None else None,
        placement_frame=node.text_at("placement_frame").strip(),
        plugins=tuple(read_plugins(node)),
        merge=node.boolean_of("merge"),
    )


def _chosen(root: Node, uri: Node) -> Node:
    """The element that an SDF file provides for includes."""
    chosen = root.child("model") or root.child("light")
    if chosen is not None:
        return chosen
    if (actor := root.child("actor")) is not None:
        actor.mark()
        raise NotThereError(
            f'"{uri.text}" is an actor, and actors are not simulated',
            code=tags.NOT_SIMULATED,
            origin=uri.origin,
        )
    raise root.fail(
        "the file has neither a <model> nor a <light> to include", code=files.NOT_A_DESCRIPTION
    )


def _file(uri: Node, ctx: Context) -> Path:
    """The SDF file of a model's folder, or the file itself."""
    text = uri.text.strip()
    if not text:
        hint = "For example: <uri>model://sun</uri>"
        raise NotThereError(
            "<uri> is empty",
            code=tags.TAG_MISSING,
            origin=uri.origin,
            hint=hint,
            values={"missing": "uri"},
        )
    name = fuel.model_name(text)
    if name is not None:
        found = _fuel_model(name, uri, ctx)
    else:
        try:
            found = ctx.packages.resolve(text, uri.origin, what="model", folder=True, use="model")
        except DescriptionError as error:
            plain = text.removeprefix("file://")
            try:
                # Gazebo also searches its model folders for a bare name.
                found = ctx.packages.find_model(plain, uri.origin)
            except DescriptionError:
                raise NotThereError.of(error, uri.origin) from error
    return _in_folder(found, uri, ctx) if found.is_dir() else found


def _fuel_model(name: str, uri: Node, ctx: Context) -> Path:
    """The model downloaded by Gazebo; otherwise a local model with the same name."""
    with contextlib.suppress(DescriptionError):
        return ctx.packages.resolve(uri.text, uri.origin, what="model", folder=True, use="model")
    for spelling in dict.fromkeys((name, name.lower(), name.lower().replace(" ", "_"))):
        try:
            return ctx.packages.find_model(spelling, uri.origin)
        except DescriptionError:
            continue
    raise NotThereError(
        f'"{uri.text}" is on the network, and Cartwheel does not download models',
        code=files.FILE_ON_NETWORK,
        origin=uri.origin,
        values={"kind": "model", "name": uri.text},
        hint=f'Download the model: gz fuel download -u "{uri.text}". Or put the model '
        f'folder "{name}" into a folder in GZ_SIM_RESOURCE_PATH.',
    )


def _in_folder(folder: Path, uri: Node, ctx: Context) -> Path:
    """The file that ``model.config`` lists for the newest supported version."""
    config = folder / "model.config"
    best: tuple[float, str] | None = None
    if config.is_file():
        try:
            versions = read_file(config).all("sdf")
        except DescriptionError as error:
            # Only the file's name is needed, and it has a default.
            ctx.report(loss(error, "the model.config is ignored", severity="info"))
            versions = []
        for each in versions:
            version = each.get("version") or "0"
            try:
                rank = float(version.partition(".")[2] or 0)
            except ValueError:
                rank = 0.0
            if best is None or rank > best[0]:
                best = (rank, each.text.strip())
        if best is not None and best[1] and (folder / best[1]).is_file():
            return folder / best[1]
    if (folder / "model.sdf").is_file():
        return folder / "model.sdf"
    wanted = best[1] if best is not None and best[1] else "model.sdf"
    maker = maker_of(folder / wanted)
    made = f' Build its package: the build makes the file by "{maker.name}".' if maker else ""
    raise NotThereError(
        f'the model folder for "{uri.text}" contains no {wanted}',
        code=files.FILE_MISSING,
        origin=uri.origin,
        values={"kind": "model", "name": uri.text, "template": str(maker or "")},
        hint=f"The folder is {folder}.{made}",
    )
