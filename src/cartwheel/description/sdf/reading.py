"""SDF 1.0 to 1.11 into descriptions: a model is a robot, a world a world.

What Gazebo does not say in one place is split over the files beside this one: ``sdf_frames``
resolves who is placed relative to whom, ``sdf_model``, ``sdf_link``, ``sdf_joint`` and
``sdf_shapes`` read a model, ``sdf_world``, ``sdf_include`` and ``sdf_state`` what surrounds it.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import replace
from pathlib import Path

from cartwheel.description.model import RobotDescription, WorldDescription
from cartwheel.description.packages import Packages
from cartwheel.description.sdf.context import MODERN, NEWEST, Context, read_version
from cartwheel.description.sdf.harmless import HARMLESS
from cartwheel.description.sdf.model import read_model
from cartwheel.description.sdf.oldest import as_modern
from cartwheel.description.sdf.unplaced import Model
from cartwheel.description.sdf.world import read_world
from cartwheel.description.xml import Node, unread
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
        raise root.fail(f"expected <sdf>, but the file begins with <{root.tag}>")
    including = () if packages.file is None else (Path(packages.file).resolve(),)
    ctx = Context(packages, read_version(root), including=including)
    if ctx.version < MODERN:
        root = as_modern(root)
    if ctx.version > NEWEST:
        ctx.tell(
            "info",
            f"SDF {ctx.version[0]}.{ctx.version[1]} is newer than {NEWEST[0]}.{NEWEST[1]}: "
            "what is new in it is not understood",
            root.origin,
        )
    worlds, models = root.all("world"), root.all("model")
    described: RobotDescription | WorldDescription
    if worlds:
        for further in worlds[1:]:
            further.mark()
            ctx.tell(
                "warning",
                f'one world is run at a time: "{further.attributes.get("name", "")}" is left out',
                further.origin,
            )
        if models:
            raise models[0].fail("a model beside a world", "Put it into the <world>.")
        described = read_world(worlds[0], ctx)
    elif len(models) == 1:
        model = _whole(models[0], ctx)
        described = model.describe(model.frames.placed(model.pose, "", model.origin), ctx, text)
        if model.relative_to:
            ctx.tell(
                "warning",
                f'model "{model.name}" is placed relative to "{model.relative_to}", '
                "which only a world could know",
                model.origin,
            )
    elif models:
        raise models[1].fail(
            f"{len(models)} models without a world", "One is a robot; put several into a <world>."
        )
    else:
        raise root.fail("there is neither a <model> nor a <world> in it")
    diagnostics = tuple(_distinct([*ctx.diagnostics, *unread(root, HARMLESS)]))
    return replace(described, diagnostics=diagnostics)


def _whole(node: Node, ctx: Context) -> Model:
    """A model that stands alone; where it lacks a file, that is its error."""
    try:
        return read_model(node, ctx)
    except DescriptionError as error:
        lacking = next((told for told in ctx.diagnostics if told.severity == "error"), None)
        if lacking is None:
            raise
        raise DescriptionError(
            lacking.message, origin=lacking.origin, hint=f"Without it: {error.message}."
        ) from error


def _distinct(diagnostics: Iterable[Diagnostic]) -> Iterable[Diagnostic]:
    """Each once: a file included ten times has the same to say ten times.

    An info is told once, wherever it applies.
    """
    infos: set[str] = set()
    for told in dict.fromkeys(diagnostics):
        if told.severity == "info":
            if told.message in infos:
                continue
            infos.add(told.message)
        yield told
