"""SDF's ``<include>``: finds the model's file, and what the includer changes about it."""

from __future__ import annotations

import re
from dataclasses import dataclass
from pathlib import Path

from cartwheel.description.model import PluginTag
from cartwheel.description.sdf.context import MAX_INCLUDES, Context, read_version
from cartwheel.description.sdf.sensors import read_plugin
from cartwheel.description.xml import Node, read_file
from cartwheel.errors import DescriptionError, Origin

_FUEL = re.compile(r"https?://[^/]+/(?:[\d.]+/)?[^/]+/models/([^/]+)", re.IGNORECASE)


@dataclass(frozen=True, slots=True)
class Included:
    """The included element and what its includer says of it."""

    node: Node
    """A ``<model>`` or ``<light>``."""
    root: Node
    """Of the included file."""
    ctx: Context
    origin: Origin
    """The ``<include>``."""
    name: str | None = None
    pose: Node | None = None
    static: bool | None = None
    placement_frame: str = ""
    plugins: tuple[PluginTag, ...] = ()
    merge: bool = False


def open_include(node: Node, ctx: Context) -> Included:
    """Reads the file that an ``<include>`` names.

    Raises:
        DescriptionError: it is missing, includes itself, or holds nothing to include.
    """
    uri = node.require_child("uri")
    path = _file(uri, ctx).resolve()
    if path in ctx.including or len(ctx.including) >= MAX_INCLUDES:
        raise node.fail(f'"{uri.text}" includes itself')
    root = read_file(path)
    if root.tag == "robot":
        raise node.fail(
            f'"{uri.text}" is a URDF, which SDF cannot include', "Spawn it into the world instead."
        )
    if root.tag not in ("sdf", "gazebo"):
        raise root.fail(f"expected <sdf>, but the file begins with <{root.tag}>")
    inner = Context(ctx.packages, read_version(root), ctx.diagnostics, (*ctx.including, path))
    chosen = root.child("model") or root.child("light")
    if chosen is None:
        if (actor := root.child("actor")) is not None:
            actor.mark()
            raise node.fail(f'"{uri.text}" is an actor, which is not simulated')
        raise root.fail("there is neither a <model> nor a <light> to include")
    name = node.child("name")
    static = node.child("static")
    ignored = node.child("allow_auto_disable")
    if ignored is not None:
        ignored.mark()
    return Included(
        node=chosen,
        root=root,
        ctx=inner,
        origin=node.origin,
        name=name.text.strip() or None if name is not None else None,
        pose=node.child("pose"),
        static=static.boolean() if static is not None else None,
        placement_frame=node.text_at("placement_frame").strip(),
        plugins=tuple(read_plugin(plugin) for plugin in node.all("plugin")),
        merge=node.boolean_of("merge", False),
    )


def _file(uri: Node, ctx: Context) -> Path:
    """The SDF file of a model's folder, or the file itself."""
    text = uri.text.strip()
    if not text:
        raise uri.fail("<uri> is empty", "Write <uri>model://sun</uri>, for example.")
    fuel = _FUEL.match(text)
    if fuel is not None:
        # Nothing is downloaded; a local model of the same name is what the user means.
        found = _fuel_model(fuel[1].replace("%20", " "), uri, ctx)
    else:
        found = ctx.packages.resolve(text, uri.origin, what="model", folder=True)
    return _in_folder(found, uri) if found.is_dir() else found


def _fuel_model(name: str, uri: Node, ctx: Context) -> Path:
    for spelling in dict.fromkeys((name, name.lower(), name.lower().replace(" ", "_"))):
        try:
            return ctx.packages.find_model(spelling, uri.origin)
        except DescriptionError:
            continue
    raise uri.fail(
        f'"{uri.text}" is on the network; nothing is downloaded',
        f'Download the model and put the folder "{name}" where GAZEBO_MODEL_PATH points.',
    )


def _in_folder(folder: Path, uri: Node) -> Path:
    """The file that ``model.config`` names for the newest version that is understood."""
    config = folder / "model.config"
    if config.is_file():
        best: tuple[float, str] | None = None
        for each in read_file(config).all("sdf"):
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
    raise uri.fail(
        f'the folder of "{uri.text}" has no model.sdf', f"It is {folder}, found by its name."
    )
