"""SDF's ``<model>``: links, joints and nested models, with all poses in the model's frame."""

from __future__ import annotations

from collections.abc import Collection, Iterator
from contextlib import contextmanager
from dataclasses import replace

from cartwheel.codes import files, tags
from cartwheel.description.elements.xml import Node, to_element, unread
from cartwheel.description.losses import loss
from cartwheel.description.model import Element, Joint, Sensor
from cartwheel.description.sdf.context import Context, read_pose, reference_of, require_name
from cartwheel.description.sdf.frames import MODEL, WORLD, Frames
from cartwheel.description.sdf.gearbox import mesh_gears
from cartwheel.description.sdf.harmless import HARMLESS
from cartwheel.description.sdf.include import Included, NotThereError, open_include
from cartwheel.description.sdf.joint import (
    GEARBOX,
    NoLinkError,
    add_joint,
    read_joint,
    read_joint_sensors,
)
from cartwheel.description.sdf.links.link import read_link
from cartwheel.description.sdf.parts import add_frame, attach, check_mimic, left_out
from cartwheel.description.sdf.sensors import read_plugins
from cartwheel.description.sdf.unplaced import Model, name_apart
from cartwheel.errors import DescriptionError
from cartwheel.similar_names import meant, suggestion

MAX_NESTING = 32


class NoLinksError(DescriptionError):
    """A model without links."""

    code = tags.MODEL_EMPTY


def read_included(included: Included) -> Model:
    """The model of an ``<include>``, with warnings for unused parts of its file."""
    if included.node.tag == "robot":
        # Imported here: the URDF reader imports parts of this package.
        from cartwheel.description.sdf.robot import read_robot

        return read_robot(included)
    model = read_model(included.node, included.ctx, included)
    included.ctx.diagnostics.extend(unread(included.root, HARMLESS))
    return model


def read_model(node: Node, ctx: Context, included: Included | None = None, depth: int = 0) -> Model:
    """A model.

    Args:
        node: The ``<model>``.
        ctx: Shared state of the containing document.
        included: Changes by the ``<include>``.
        depth: Nesting depth.

    Raises:
        DescriptionError: The model cannot be used.
    """
    if depth > MAX_NESTING:
        raise node.fail(
            f"models are nested more than {MAX_NESTING} levels deep", code=files.INCLUDE_RECURSIVE
        )
    name = require_name(node)
    if included is not None and included.name:
        name = included.name
    frames = Frames("model", name)
    link_nodes = node.all("link")
    for link in link_nodes:
        add_frame(frames, "link", link)
    for gripper in node.all("gripper"):
        gripper.mark()
        ctx.warn(
            tags.NOT_SIMULATED,
            "<gripper> has no effect because contacts do not attach objects",
            origin=gripper.origin,
            hint="Use the plugin libgazebo_grasp_fix.so to attach objects.",
            severity="warning",
            values={"tag": "gripper"},
        )
    nested = [read_model(each, ctx, depth=depth + 1) for each in node.all("model")]
    for each in node.all("include"):
        try:
            found = open_include(each, ctx)
        except NotThereError as missing:
            each.mark()
            values = {"instance": _instance(each)}
            ctx.report(loss(missing, "the model is ignored", of="include", values=values))
            continue
        if found.node.tag == "light":
            raise each.fail(
                "a light cannot be included in a model",
                "Include the light in the <world>.",
                code=tags.TAG_MISPLACED,
            )
        nested.append(read_included(found))
    name_apart((inner for inner in nested if not inner.merge), ctx)
    for inner in nested:
        _add_nested(frames, inner)
    _set_canonical(node, frames, link_nodes, nested)
    for each in node.all("frame"):
        add_frame(frames, "frame", each)
    later = [each.attributes.get("name", "") for each in node.all("joint")]
    joint_nodes: list[tuple[Node, str]] = []
    for each in node.all("joint"):
        with _linked(each, ctx):
            joint_nodes.append((each, add_joint(frames, each, ctx, later)))
    for known in frames.names():
        frames.pose(known, node.origin)  # a cycle is an error even if the pose is not needed
    links = [read_link(each, ctx, frames) for each in link_nodes]
    if node.boolean_at("enable_wind", False):
        links = [replace(link, wind=True) for link in links]
    joints: list[Joint] = []
    sensors: list[Sensor] = []
    for each, frame in joint_nodes:
        with _linked(each, ctx):
            joint = read_joint(each, ctx, frames, frame)
            if joint is not None:
                joints.append(joint)
                sensors += read_joint_sensors(each, joint, frames, ctx)
    gears = [(each, frame) for each, frame in joint_nodes if each.get("type") == GEARBOX]
    joints = mesh_gears(gears, joints, ctx, frames)
    stated = included.pose if included is not None and included.pose else node.child("pose")
    placement = (node.get("placement_frame") or "").strip()
    if included is not None and included.pose:
        node.child("pose")
        placement = included.placement_frame or placement
    static = node.boolean_at("static", False)
    model = Model(
        name=name,
        frames=frames,
        links=links,
        joints=joints,
        plugins=read_plugins(node),
        static=included.static if included is not None and included.static is not None else static,
        self_collide=node.boolean_at("self_collide", False),
        pose=read_pose(stated) @ frames.pose(placement, node.origin).inverse(),
        relative_to=reference_of(stated),
        origin=included.origin if included is not None else node.origin,
        merge=included.merge if included is not None else False,
        ros2_control=tuple(to_element(each) for each in node.all("ros2_control")),
    )
    if included is not None:
        model.plugins.extend(included.plugins)
    if nested and not links and all(inner.static for inner in nested):
        model.static = True
    for inner in nested:
        _flatten(model, inner)
        if inner.static and not model.static:
            _hold(model, inner)
    attach(model.links, sensors)
    if not model.links and not model.static:
        raise NoLinksError(
            f'model "{name}" has no links', origin=node.origin, values={"name": name}
        )
    by_name = {joint.name: joint for joint in model.joints}
    for joint in model.joints:
        check_mimic(joint, by_name)
    return model


def _instance(include: Node) -> str:
    """The name that an included model would have, unless its file states another one."""
    stated = include.text_at("name").strip()
    uri = include.text_at("uri").strip()
    return stated or uri.removesuffix("/model.sdf").rstrip("/").rpartition("/")[2]


@contextmanager
def _linked(node: Node, ctx: Context) -> Iterator[None]:
    """Reports a joint that refers to a missing link, and continues without the joint.

    Gazebo Classic also loads the rest.
    """
    try:
        yield
    except NoLinkError as missing:
        left_out(node, missing, ctx)


def _add_nested(frames: Frames, inner: Model) -> None:
    if not inner.merge:
        frames.add_scope(inner.name, inner.frames, inner.pose, inner.relative_to, inner.origin)
        return
    # Adds its frames, all relative to a frame that represents the nested model.
    proxy = f"_merged__{inner.name}__model__"
    inner_link = inner.frames.link_of("", inner.origin) if inner.links else ""
    frames.add(
        "frame",
        proxy,
        inner.pose,
        relative_to=inner.relative_to or MODEL,
        attached_to=inner_link,
        origin=inner.origin,
    )
    links = {link.name for link in inner.links}
    for name in inner.frames.names():
        frames.add(
            "link" if name in links else "frame",
            name,
            inner.frames.pose(name, inner.origin),
            relative_to=proxy,
            attached_to="" if name in links else inner.frames.link_of(name, inner.origin),
            origin=inner.origin,
        )


def _set_canonical(node: Node, frames: Frames, link_nodes: list[Node], nested: list[Model]) -> None:
    stated = (node.get("canonical_link") or "").strip()
    if stated:
        if stated not in frames.names():
            raise node.fail(
                f'the canonical link "{stated}" does not exist',
                suggestion(stated, frames.links()),
                code=tags.NAME_UNKNOWN,
                values={"name": stated, "meant": meant(stated, frames.links())},
            )
        frames.default_link = frames.link_of(stated, node.origin)
    elif link_nodes:
        frames.default_link = require_name(link_nodes[0])
    elif nested := [inner for inner in nested if inner.links]:
        inner = nested[0]
        first = inner.frames.link_of("", inner.origin)
        frames.default_link = first if inner.merge else f"{inner.name}::{first}"


def _flatten(model: Model, inner: Model) -> None:
    """Adds a nested model's parts, with the prefix ``name::`` unless it is merged."""
    prefix = "" if inner.merge else f"{inner.name}::"
    base = model.frames.pose(
        f"_merged__{inner.name}__model__" if inner.merge else inner.name, inner.origin
    )

    def scoped(name: str) -> str:
        return name if name == WORLD else prefix + name

    model.links += [
        replace(
            link,
            name=scoped(link.name),
            pose=base @ link.pose,
            self_collide=_own_collide(model, inner)
            if link.self_collide is None
            else link.self_collide,
            collisions=tuple(
                replace(each, surface=replace(each.surface, fdir1_frame=scoped(frame)))
                if (frame := each.surface.fdir1_frame)
                else each
                for each in link.collisions
            ),
            sensors=tuple(
                replace(
                    each, link=scoped(each.link), joint=scoped(each.joint) if each.joint else None
                )
                for each in link.sensors
            ),
        )
        for link in inner.links
    ]
    model.joints += [
        replace(
            joint,
            name=scoped(joint.name),
            parent=scoped(joint.parent),
            child=scoped(joint.child),
            mimic=replace(joint.mimic, joint=scoped(joint.mimic.joint)) if joint.mimic else None,
        )
        for joint in inner.joints
    ]
    names = {link.name for link in inner.links} | {joint.name for joint in inner.joints}
    model.plugins += [
        replace(plugin, element=_renamed(plugin.element, names, prefix)) if prefix else plugin
        for plugin in inner.plugins
    ]
    model.ros2_control += inner.ros2_control


def _own_collide(model: Model, inner: Model) -> bool | None:
    """A nested model's self-collision setting if it differs from the outer model's."""
    return inner.self_collide if inner.self_collide != model.self_collide else None


def _hold(model: Model, inner: Model) -> None:
    """A static model in a movable model stays in place: each link is fixed to the world."""
    prefix = "" if inner.merge else f"{inner.name}::"
    model.joints += [
        Joint(
            name=f"{prefix}{link.name}_static",
            type="fixed",
            parent=WORLD,
            child=prefix + link.name,
            origin=link.origin,
        )
        for link in inner.links
    ]


def _renamed(element: Element, names: Collection[str], prefix: str) -> Element:
    """A nested model's plugin with the outer model's link and joint names.

    Frame ids in messages keep their names.
    """
    own = element.text in names and "frame" not in element.tag.lower()
    return replace(
        element,
        text=prefix + element.text if own else element.text,
        children=tuple(_renamed(child, names, prefix) for child in element.children),
    )
