"""Reads SDF 1.0 to 1.11: a model becomes a `RobotDescription`, a world a `WorldDescription`.

``frames.py`` resolves poses relative to frames. ``model.py``, ``joint.py`` and the folder ``links``
read a model, ``include.py`` reads ``<include>``, and the folder ``worlds`` reads a world.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import replace
from pathlib import Path

from cartwheel.codes import files, tags
from cartwheel.description.elements.xml import Node, unread
from cartwheel.description.files.packages import Packages
from cartwheel.description.model import RobotDescription, WorldDescription
from cartwheel.description.sdf.context import MODERN, NEWEST, Context, read_version, simulator_for
from cartwheel.description.sdf.harmless import HARMLESS
from cartwheel.description.sdf.model import read_model
from cartwheel.description.sdf.oldest import as_modern
from cartwheel.description.sdf.unplaced import Model
from cartwheel.description.sdf.worlds.world import read_world
from cartwheel.errors import DescriptionError, Diagnostic

__all__ = ["read_sdf"]


def read_sdf(
    root: Node, packages: Packages, *, text: str = ""
) -> RobotDescription | WorldDescription:
    """What an ``<sdf>`` document describes.

    Args:
        root: Its root.
        packages: Finds the files that it names.
        text: The document as written, kept with a robot.

    Raises:
        DescriptionError: it describes neither one model nor one world, or something in it is
            wrong; names the place and the likely fix.
    """
    if root.tag not in ("sdf", "gazebo"):
        raise root.fail(
            f"expected <sdf>, but the file begins with <{root.tag}>", code=files.NOT_A_DESCRIPTION
        )
    including = () if packages.file is None else (Path(packages.file).resolve(),)
    version = read_version(root)
    simulator = simulator_for(root, version)
    ctx = Context(packages, version, including=including, simulator=simulator)
    if ctx.version < MODERN:
        root = as_modern(root)
    if ctx.version > NEWEST:
        ctx.warn(
            files.SDF_VERSION,
            f"SDF {ctx.version[0]}.{ctx.version[1]} is newer than {NEWEST[0]}.{NEWEST[1]}: "
            "new elements are ignored",
            origin=root.origin,
            severity="info",
            values={"stated": f"{ctx.version[0]}.{ctx.version[1]}"},
        )
    worlds, models = root.all("world"), root.all("model")
    described: RobotDescription | WorldDescription
    if worlds:
        for further in worlds[1:]:
            further.mark()
            name = further.attributes.get("name", "")
            ctx.warn(
                tags.ELEMENT_LEFT_OUT,
                f'only one world can run at a time, so world "{name}" is ignored',
                origin=further.origin,
                values={"tag": "world", "name": name},
            )
        if models:
            raise models[0].fail(
                "a <model> is outside the <world>",
                "Move the <model> into the <world>.",
                code=tags.TAG_MISPLACED,
            )
        described = read_world(worlds[0], ctx)
    elif len(models) == 1:
        model = _whole(models[0], ctx)
        described = model.describe(model.frames.placed(model.pose, "", model.origin), ctx, text)
        if model.relative_to:
            ctx.warn(
                tags.NAME_UNKNOWN,
                f'the pose of model "{model.name}" is relative to "{model.relative_to}", '
                "which exists only in a world",
                origin=model.origin,
                severity="warning",
                values={"name": model.relative_to, "meant": ""},
            )
    elif models:
        raise models[1].fail(
            f"the file contains {len(models)} models, but no <world>",
            "Put the models into a <world>. A file with a single model describes a robot.",
            code=files.WRONG_KIND,
        )
    else:
        raise root.fail(
            "the file has neither a <model> nor a <world>", code=files.NOT_A_DESCRIPTION
        )
    diagnostics = tuple(_distinct([*ctx.diagnostics, *unread(root, HARMLESS)]))
    return replace(described, diagnostics=diagnostics)


_SHAPES = ("visual", "collision")


def _whole(node: Node, ctx: Context) -> Model:
    """A model that stands alone; where it lacks an included model, that is its error."""
    try:
        return read_model(node, ctx)
    except DescriptionError as error:
        # A missing mesh makes no name unknown.
        lacking = next(
            (
                each
                for each in ctx.diagnostics
                if each.severity == "error" and each.values.get("left_out") not in _SHAPES
            ),
            None,
        )
        if lacking is None:
            raise
        why = f"{error.message}. {lacking.hint}"
        raise DescriptionError(
            lacking.message,
            code=lacking.code,
            origin=lacking.origin,
            hint=f"For this reason, the model cannot be loaded: {why}".strip(),
            values={**lacking.values, "without": error.values.get("name")},
        ) from error


def _distinct(diagnostics: Iterable[Diagnostic]) -> Iterable[Diagnostic]:
    """Each once: a file that is included ten times repeats its diagnostics.

    An info occurs once, wherever it applies.
    """
    seen: set[tuple[object, ...]] = set()
    for each in diagnostics:
        origin = None if each.severity == "info" else each.origin
        key = (*each.kind, each.sorted_values, origin)
        if key not in seen:
            seen.add(key)
            yield each
