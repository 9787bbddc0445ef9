"""SDF's ``<world>``: its models and lights, gravity, physics, scene and plugins."""

from __future__ import annotations

import contextlib
from collections.abc import Iterator
from dataclasses import replace

from cartwheel.codes import tags
from cartwheel.description.elements.xml import Node, to_element, unread
from cartwheel.description.losses import loss
from cartwheel.description.model import Light, Physics, WorldDescription
from cartwheel.description.sdf.context import (
    Context,
    not_simulated,
    read_pose,
    read_rgba,
    reference_of,
    require_name,
)
from cartwheel.description.sdf.frames import WORLD, Frames
from cartwheel.description.sdf.harmless import HARMLESS
from cartwheel.description.sdf.include import Included, NotThereError, open_include
from cartwheel.description.sdf.light import read_light
from cartwheel.description.sdf.links.link import named_apart
from cartwheel.description.sdf.model import NoLinksError, read_included, read_model
from cartwheel.description.sdf.sensors import read_plugins
from cartwheel.description.sdf.unplaced import Model, name_apart
from cartwheel.description.sdf.worlds.state import apply_state
from cartwheel.description.sdf.worlds.world_joints import join_models
from cartwheel.errors import DescriptionError
from cartwheel.geometry import Pose, Vec3

_NOT_SIMULATED = ("actor", "population", "road")

SHORTEST_STEP, LONGEST_STEP = 1e-6, 1.0
"""Limits of the physics time step, s."""


def read_world(node: Node, ctx: Context) -> WorldDescription:
    """A world.

    Args:
        node: The ``<world>``.
        ctx: Shared state of the document.

    Raises:
        DescriptionError: The world cannot be used.
    """
    default = WorldDescription(name="")
    name = (node.get("name") or "").strip() or "default"
    frames = Frames(WORLD, name)
    models, light_nodes = _contents(node, ctx)
    name_apart(models, ctx)
    for model in models:
        frames.add_scope(model.name, model.frames, model.pose, model.relative_to, model.origin)
    for each in node.all("frame"):
        stated = each.child("pose")
        frames.add(
            "frame",
            require_name(each),
            read_pose(stated),
            relative_to=reference_of(stated),
            attached_to=(each.get("attached_to") or "").strip(),
            origin=each.origin,
        )
    placed = []
    for model in models:
        with _tolerant(ctx, model.name):
            placed.append(model.describe(frames.pose(model.name, model.origin), ctx))
    lights = named_apart(
        "light", [_light(each, included, frames) for each, included in light_nodes], ctx
    )
    placed, joints = join_models(node, placed, frames, ctx)
    for state in node.all("state"):
        placed, lights = apply_state(state, placed, lights, ctx)
    for tag in _NOT_SIMULATED:
        for each in node.all(tag):
            each.mark()
            name_of = each.attributes.get("name", "")
            what = f'<{tag}> "{name_of}"' if name_of else f"<{tag}>"
            ctx.report(not_simulated(f"{what} is not simulated and is ignored", each))
    for each in node.all("atmosphere"):
        each.mark()
        if each.children:
            ctx.report(not_simulated("<atmosphere> is not simulated", each))
    for each in node.all("gui"):
        each.mark()  # only affects Gazebo's window
    physics = _default_physics(node, ctx)
    field = node.child("magnetic_field")
    wind = node.child("wind")
    velocity = wind.child("linear_velocity") if wind is not None else None
    scene = node.child("scene")
    coordinates = node.child("spherical_coordinates")
    return WorldDescription(
        name=name,
        models=tuple(placed),
        lights=tuple(lights),
        joints=joints,
        places=tuple(_places(node, frames, ctx)),
        gravity=_gravity(node, physics, default.gravity),
        wind=velocity.vec3() if velocity is not None else default.wind,
        magnetic_field=field.vec3() if field is not None else default.magnetic_field,
        ambient=_scene_colour(scene, "ambient", default.ambient),
        background=_scene_colour(scene, "background", default.background),
        shadows=node.boolean_at("scene/shadows", True),
        physics=_physics(physics, ctx) if physics is not None else Physics(),
        plugins=tuple(read_plugins(node)),
        spherical_coordinates=to_element(coordinates) if coordinates is not None else None,
        origin=node.origin,
    )


def _contents(node: Node, ctx: Context) -> tuple[list[Model], list[tuple[Node, Included | None]]]:
    """Models, and lights with the pose from an ``<include>``."""
    models: list[Model] = []
    lights: list[tuple[Node, Included | None]] = []
    for each in node.children:
        if each.tag == "model":
            with _tolerant(ctx, each.attributes.get("name", ""), each):
                models.append(read_model(each, ctx))
        elif each.tag == "light":
            lights.append((each, None))
        elif each.tag == "include":
            try:
                included = open_include(each, ctx)
            except NotThereError as missing:
                # It only affects this model, not the whole world; it is an error, so that strict
                # callers can stop.
                each.mark()
                ctx.report(loss(missing, "the model is ignored", of="include"))
                continue
            if included.node.tag == "light":
                lights.append((included.node, included))
            else:
                with _tolerant(ctx, included.name or included.node.attributes.get("name", "")):
                    models.append(read_included(included))
    for tag in ("model", "light", "include"):
        node.all(tag)  # marks them as read
    return models, lights


@contextlib.contextmanager
def _tolerant(ctx: Context, name: str, node: Node | None = None) -> Iterator[None]:
    """Skips a model that has no links or refers to missing files.

    The model's file may be correct, and the rest of the world is still useful.
    """
    try:
        yield
    except DescriptionError as error:
        lacking = any(each.severity == "error" for each in ctx.diagnostics)
        if not lacking and not isinstance(error, NoLinksError):
            raise
        if node is not None:
            node.mark()
        if lacking and isinstance(error, NoLinksError):
            return  # all its parts were reported as skipped
        what = "it" if isinstance(error, NoLinksError) else f'the model "{name}"'
        ctx.report(
            loss(
                error,
                f"{what} is ignored",
                of="model",
                severity="error" if lacking else "warning",
            )
        )


def _places(node: Node, frames: Frames, ctx: Context) -> Iterator[tuple[str, Pose]]:
    """The fixed frames; a frame without a pose is reported."""
    for each in node.all("frame"):
        name = require_name(each)
        if not frames.stays(name):
            continue
        try:
            yield name, frames.pose(name, each.origin)
        except DescriptionError as error:
            ctx.report(
                loss(
                    error,
                    f'the pose of the frame "{name}" cannot be determined',
                    severity="warning",
                )
            )


def _light(node: Node, included: Included | None, frames: Frames) -> Light:
    stated = node.child("pose")
    if included is not None and included.pose is not None:
        stated = included.pose
    light = read_light(node, frames.placed(read_pose(stated), reference_of(stated), node.origin))
    if included is None:
        return light
    included.ctx.diagnostics.extend(unread(included.root, HARMLESS))
    return replace(light, name=included.name or light.name)


def _default_physics(node: Node, ctx: Context) -> Node | None:
    profiles = node.all("physics")
    if not profiles:
        return None
    chosen = next((each for each in profiles if each.boolean_of("default")), profiles[0])
    for each in profiles:
        each.get("name"), each.get("type")
        if each is not chosen:
            each.mark()
            ctx.warn(
                tags.TAG_REPEATED,
                "<physics> is repeated, so only the default or first <physics> is used",
                origin=each.origin,
                severity="info",
                values={"tag": "physics", "parent": "world"},
            )
    return chosen


def _gravity(node: Node, physics: Node | None, default: Vec3) -> Vec3:
    """Gravity in the world (since 1.6) or in the physics element (before)."""
    own = node.child("gravity")
    older = physics.child("gravity") if physics is not None else None
    if own is not None:
        return own.vec3()
    return older.vec3() if older is not None else default


def _physics(node: Node, ctx: Context) -> Physics:
    step = node.child("max_step_size")
    if step is None and ctx.version < (1, 4):
        step = node.find("ode/solver/dt")
        if step is not None:
            ode = node.require_child("ode").mark()
            ctx.warn(
                tags.TAG_IGNORED,
                "only <dt> of the <ode> in <physics> has an effect",
                origin=ode.origin,
                severity="info",
                values={"tag": "ode", "parent": "physics"},
            )
    if step is not None and not SHORTEST_STEP <= step.number() <= LONGEST_STEP:
        raise step.fail(
            f"the step must be between {SHORTEST_STEP:g} and {LONGEST_STEP:g} s (got {step.text})"
        )
    rate = node.child("real_time_update_rate") or node.child("update_rate")
    return Physics(
        max_step_size=step.number() if step is not None else None,
        real_time_factor=node.optional_number_at("real_time_factor"),
        real_time_update_rate=rate.number() if rate is not None else None,
    )


def _scene_colour(
    scene: Node | None, tag: str, default: tuple[float, float, float, float]
) -> tuple[float, float, float, float]:
    if scene is None:
        return default
    found = scene.child(tag)
    return read_rgba(found) if found is not None else default
