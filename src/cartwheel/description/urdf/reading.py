"""Reads expanded URDF into a `RobotDescription`.

The information is in three places: links and joints, the ``<gazebo>`` tags that refer to them, and
the tree of joints. This module combines them; each has its own module.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import replace
from pathlib import Path

from cartwheel.codes import files, robot
from cartwheel.codes import tags as tag_codes
from cartwheel.description.elements.simulator import simulator_of
from cartwheel.description.elements.xml import Node, to_element, unread
from cartwheel.description.files.packages import Packages
from cartwheel.description.inertia import LIGHTEST
from cartwheel.description.model import Inertial, Joint, Link, RobotDescription
from cartwheel.description.sdf.harmless import HARMLESS as HARMLESS_IN_SDF
from cartwheel.description.sdf.inserting import insert
from cartwheel.description.urdf.collision_names import check_contact_sensors, name_collisions
from cartwheel.description.urdf.context import UrdfContext
from cartwheel.description.urdf.cut_links import cut_links
from cartwheel.description.urdf.estimate import warn_held, with_masses
from cartwheel.description.urdf.gazebo_tags import GazeboTags, read_gazebo_tags
from cartwheel.description.urdf.harmless import HARMLESS
from cartwheel.description.urdf.inertia import judged_inertia, mark_refused
from cartwheel.description.urdf.joint import directed, read_joint, without_invalid_mimics
from cartwheel.description.urdf.link import ReadLink, read_link
from cartwheel.description.urdf.material import read_materials
from cartwheel.description.urdf.merged_gravity import merge_gravity
from cartwheel.description.urdf.refusals import refusals
from cartwheel.description.urdf.tree import WORLD, Tree, build_tree
from cartwheel.errors import DescriptionError, Diagnostic, Origin
from cartwheel.geometry import Pose


def read_urdf(
    root: Node,
    packages: Packages,
    *,
    text: str = "",
    diagnostics: Iterable[Diagnostic] = (),
) -> RobotDescription:
    """Reads a ``<robot>``.

    Args:
        root: Its root, with all xacro expanded.
        packages: Resolves meshes and textures.
        text: The expanded XML, stored in the description.
        diagnostics: Diagnostics of the expansion.

    Raises:
        DescriptionError: The element is not a valid robot.
    """
    if root.tag != "robot":
        raise root.fail(
            f"expected <robot>, but the file begins with <{root.tag}>",
            code=files.NOT_A_DESCRIPTION,
        )
    root.get("version")
    ctx = UrdfContext(packages=packages, diagnostics=list(diagnostics))
    name = _name(root, ctx)
    ctx.diagnostics.extend(refusals(root))
    ctx.diagnostics.extend(cut_links(root))
    read_materials(root, ctx)
    link_nodes = root.all("link")
    if not link_nodes:
        raise root.fail(
            f'the robot "{name}" has no links',
            "Is the robot a xacro macro that is defined, but never called?",
            code=tag_codes.MODEL_EMPTY,
            values={"name": name},
        )
    _check_unique("link", link_nodes)
    joint_nodes = root.all("joint")
    _check_unique("joint", joint_nodes)

    ctx.simulator = simulator_of(root)
    parts = [read_link(node, ctx) for node in link_nodes]
    names = [part.link.name for part in parts]
    known = frozenset(names)
    read = [read_joint(node, known, ctx) for node in joint_nodes]
    joints = without_invalid_mimics([joint for joint, _ in read], ctx)
    tree = build_tree([(part.link.name, part.link.origin) for part in parts], joints)
    poses = tree.poses({joint.name: frame for joint, frame in read})
    joints = directed(joints, poses, ctx.undirected)

    tags = read_gazebo_tags(root, known, {joint.name: joint for joint in joints}, ctx)
    links = [_complete(part, tree, poses[part.link.name], tags, ctx) for part in parts]
    joints = [tags.apply_to_joint(joint) for joint in joints if not _is_free(joint)]
    preserved = [joint.name for joint in joints if joint.preserve_fixed]
    stated_inertials = {part.link.name: part.inertial for part in parts if part.inertial}
    mark_refused(stated_inertials, poses, tree.lumps(preserved), ctx)
    links = name_collisions(links, tree, preserved)
    stated = {name: each.gravity for name, each in tags.links.items()}
    links, overruled = merge_gravity(links, tree, preserved, stated)
    ctx.diagnostics.extend(overruled)
    ctx.diagnostics.extend(check_contact_sensors(links))
    links = _without_world(links, tree, ctx)
    if not tags.static:
        warn_held(links, joints, ctx)
    links = list(with_masses(links, tree, ctx, static=tags.static))
    canonical_link = links[0].name if tree.root == WORLD else tree.root
    links, joints, inserted = insert(
        tags.inserted,
        links,
        joints,
        packages,
        name=name,
        canonical_link=canonical_link,
        static=tags.static,
    )
    ctx.diagnostics.extend(inserted)
    if not tags.static and tree.root != WORLD:
        _warn_untouchable(links, ctx)

    transmissions = tuple(to_element(node) for node in root.all("transmission"))
    ros2_control = tuple(to_element(node) for node in root.all("ros2_control"))
    _warn_unprefixed(root, ctx)
    ctx.diagnostics.extend(unread(root, HARMLESS_IN_SDF | HARMLESS))
    return RobotDescription(
        name=name,
        links=tuple(links),
        joints=tuple(joints),
        plugins=tags.plugins,
        static=tags.static,
        self_collide=tags.self_collide,
        canonical_link=canonical_link,
        transmissions=transmissions,
        ros2_control=ros2_control,
        diagnostics=distinct(ctx.diagnostics),
        text=text,
        origin=root.origin,
    )


def _name(root: Node, ctx: UrdfContext) -> str:
    """The name of a robot; that of its file if it is empty, which ROS and Gazebo accept."""
    if root.attributes.get("name", "unnamed").strip() == "":
        root.get("name")
        name = Path(root.origin.file).name.partition(".")[0] or "robot"
        ctx.warn(
            tag_codes.TAG_MISSING,
            f'the attribute "name" of <robot> is empty, so "{name}" is used',
            origin=root.origin,
            severity="warning",
            values={"missing": "name"},
        )
        return name
    if "name" not in root.attributes and not root.all("link"):
        raise root.fail(
            "<robot> has neither a name nor links",
            "If this file only defines macros, load the file that includes it.",
            code=files.NOT_A_DESCRIPTION,
        )
    return root.require("name").strip()


def _check_unique(kind: str, nodes: Sequence[Node]) -> None:
    seen: dict[str, Origin] = {}
    for node in nodes:
        name = node.require("name").strip()
        if name in seen:
            raise node.fail(
                f'the {kind} "{name}" is defined twice',
                f"The first definition is at {seen[name]}.",
                code=robot.DUPLICATE_NAME,
                values={"name": name},
            )
        seen[name] = node.origin


def _warn_unprefixed(root: Node, ctx: UrdfContext) -> None:
    """Warns about xacro elements without a prefix, which ROS no longer supports."""
    for tag in ("include", "property", "macro", "arg", "if", "unless"):
        for node in root.all(tag):
            node.mark()
            ctx.warn(
                files.XACRO_PREFIX,
                f"<{tag}> has no effect because it lacks the prefix xacro:",
                origin=node.origin,
                hint=f"Use <xacro:{tag}>.",
                values={"tag": tag, "meant": f"xacro:{tag}"},
            )


def distinct(diagnostics: Iterable[Diagnostic]) -> tuple[Diagnostic, ...]:
    """Removes duplicates on each line: a macro that is called ten times repeats its diagnostics."""
    unique: dict[tuple[object, ...], Diagnostic] = {}
    for each in diagnostics:
        unique.setdefault(each.identity, each)
    return tuple(unique.values())


def _complete(part: ReadLink, tree: Tree, pose: Pose, tags: GazeboTags, ctx: UrdfContext) -> Link:
    link = replace(part.link, pose=pose, inertial=_judged(part, tree, ctx))
    if (stated := tags.links.get(link.name)) is not None:
        ctx.diagnostics.extend(stated.idle(link))
    return tags.apply_to_link(link)


def _judged(part: ReadLink, tree: Tree, ctx: UrdfContext) -> Inertial | None:
    """The link's inertia; None if it has none, or an unusable one that does no harm there."""
    inertial, name = part.inertial, part.link.name
    if inertial is None:
        return None
    holder = tree.inbound.get(name)
    fixed = holder is not None and holder.type == "fixed"
    if inertial.mass < LIGHTEST:
        ctx.warn(
            robot.MASS_NOT_POSITIVE,
            f'link "{name}" has a mass of {inertial.mass:g} kg, so it is simulated without a mass',
            origin=inertial.origin,
            severity="info" if fixed and inertial.mass >= 0 else "warning",
            values={"link": name, "stated": inertial.mass},
        )
        return None
    rigid = fixed or any(joint.type == "fixed" for joint in tree.children[name])
    return judged_inertia(inertial, name, rigid=rigid, ctx=ctx)


def _is_free(joint: Joint) -> bool:
    """Whether a joint lets a link move freely in the world, as it does without the joint.

    Gazebo leaves the joint out too.
    """
    return joint.type == "floating" and joint.parent == WORLD


def _without_world(links: list[Link], tree: Tree, ctx: UrdfContext) -> list[Link]:
    """The links without the one that represents the world."""
    if tree.root != WORLD:
        return links
    kept = [link for link in links if link.name != WORLD]
    world = next(link for link in links if link.name == WORLD)
    if not kept:
        raise DescriptionError(
            'the only link is "world", which represents the world itself',
            code=tag_codes.MODEL_EMPTY,
            origin=world.origin,
        )
    if world.visuals or world.collisions or world.inertial or world.sensors:
        ctx.warn(
            tag_codes.ELEMENT_LEFT_OUT,
            'the link "world" represents the world itself, so its shapes, mass and sensors are '
            "ignored",
            origin=world.origin,
            values={"tag": "link", "name": WORLD},
        )
    return [link for name in tree.order for link in kept if link.name == name]


def _warn_untouchable(links: Sequence[Link], ctx: UrdfContext) -> None:
    """Warns about a robot for rviz only, without collisions."""
    seen = next((link for link in links if link.visuals), None)
    falls = any(link.gravity for link in links)
    if seen is not None and falls and not any(link.collisions for link in links):
        ctx.warn(
            robot.BASE_WITHOUT_COLLISION,
            "no link of the robot has a <collision>, so the robot falls through the ground",
            origin=seen.visuals[0].origin,
            hint="Add a <collision> next to each <visual>, with the same <origin> and "
            f'<geometry>. Start with link "{seen.name}".',
            values={"link": seen.name},
        )
