"""The ``<gazebo>`` tags in a URDF, for links, joints and the whole robot.

Every element has an effect, or a diagnostic with the reason.
"""

from __future__ import annotations

from collections.abc import Collection, Mapping
from dataclasses import dataclass, field, replace
from typing import Any

from cartwheel.codes import robot as robot_codes
from cartwheel.codes import tags as codes
from cartwheel.description.elements.xml import Node
from cartwheel.description.model import Joint, Link, PluginTag
from cartwheel.description.sdf.inserting import INSERTED
from cartwheel.description.sdf.sensors import read_plugin, read_sensor, read_sensors
from cartwheel.description.urdf.context import UrdfContext
from cartwheel.description.urdf.gazebo_link_tags import (
    LINK_TAGS,
    LinkTags,
    read_link_tags,
    warn_idle,
)
from cartwheel.similar_names import meant, suggestion

JOINT_TAGS = (
    "stopCfm", "stopErp", "springReference", "springStiffness", "fudgeFactor", "provideFeedback",
    "implicitSpringDamper", "cfmDamping", "disableFixedJointLumping", "preserveFixedJoint",
    "sensor", "physics",
)  # fmt: skip
_OF_JOINTS = "force_torque"
"""The type of joint sensors."""
_WITH_PARTS = ("sensor", "plugin", "light", "visual", "collision")
ROBOT_TAGS = ("plugin", "static", "self_collide", "selfCollide", "enable_wind", *INSERTED)

_ROBOT_IDLE = {
    "gripper": "grippers are not supported: use libgazebo_grasp_fix.so",
    "allow_auto_disable": "bodies at rest are put to sleep automatically",
    "pose": "the pose is set when the robot is spawned",
    "model": "models inside a URDF are not supported",
    "verbose": "Gazebo ignores this tag too",
}


@dataclass(slots=True)
class GazeboTags:
    """All ``<gazebo>`` tags of a robot, by reference."""

    links: dict[str, LinkTags] = field(default_factory=dict)
    joints: dict[str, dict[str, Any]] = field(default_factory=dict)
    """The stated fields of `Joint` and, under ``axis``, of `Axis`."""
    robot_plugins: list[PluginTag] = field(default_factory=list)
    inserted: list[Node] = field(default_factory=list)
    """SDF links, joints and frames to add to the model."""
    static: bool = False
    self_collide: bool = False
    wind: bool = False

    @property
    def plugins(self) -> tuple[PluginTag, ...]:
        """Plugins of the robot, in file order."""
        return tuple(self.robot_plugins)

    def apply_to_link(self, link: Link) -> Link:
        """The link with its tags applied."""
        tags = self.links.get(link.name)
        applied = tags.apply(link) if tags is not None else link
        return replace(applied, wind=True) if self.wind else applied

    def apply_to_joint(self, joint: Joint) -> Joint:
        """The joint with its tags applied."""
        fields = dict(self.joints.get(joint.name, {}))
        axis = fields.pop("axis", None)
        if axis:
            fields["axis"] = replace(joint.axis, **axis)
        return replace(joint, **fields) if fields else joint


def read_gazebo_tags(
    robot: Node, links: Collection[str], joints: Mapping[str, Joint], ctx: UrdfContext
) -> GazeboTags:
    """Reads all ``<gazebo>`` tags of a robot.

    Args:
        robot: The root.
        links: Link names.
        joints: Joints by name.
        ctx: Receives the diagnostics.

    Raises:
        DescriptionError: A reference does not exist, or a value is invalid.
    """
    tags = GazeboTags()
    for node in robot.all("gazebo"):
        _settle(node, ctx)
        reference = (node.get("reference") or "").strip()
        if not reference:
            _read_robot_tags(node, tags, ctx)
            continue
        if reference not in links and reference not in joints:
            # Gazebo ignores it silently, and published robots contain such tags.
            names = referable(node, links, joints)
            ctx.warn(
                robot_codes.REFERENCE_UNKNOWN,
                f'<gazebo> refers to "{reference}", which is neither a link nor a joint, so '
                "everything in it is ignored",
                origin=node.origin,
                hint=suggestion(reference, names),
                mark="reference",
                values={"name": reference, "meant": meant(reference, names)},
            )
            # Reported as a whole, not by part.
            node.children.clear()
            continue
        if reference in links:
            of_link = tags.links.setdefault(reference, LinkTags())
            read_link_tags(node, reference, of_link, ctx)
            if reference in joints:
                # If both a link and a joint exist, only the joint measures forces.
                of_link.sensors = [one for one in of_link.sensors if one.type != _OF_JOINTS]
        if reference in joints:
            of_both = reference in links
            _read_joint_tags(node, joints[reference], tags, ctx, of_both=of_both)
        tags.robot_plugins.extend(_misplaced_plugins(node, reference, ctx))
        if (reference in links) != (reference in joints):
            _warn_misplaced(node, reference, reference in links, ctx)
    return tags


def referable(node: Node, links: Collection[str], joints: Collection[str]) -> list[str]:
    """The names that a ``<gazebo>`` may refer to: only links if its tags are only for links."""
    tags = {child.tag for child in node.children}
    of_link, of_joint = (
        bool(tags & set(own) - set(other))
        for own, other in ((LINK_TAGS, JOINT_TAGS), (JOINT_TAGS, LINK_TAGS))
    )
    if of_link != of_joint:
        return sorted(links if of_link else joints)
    return sorted({*links, *joints})


def _settle(node: Node, ctx: UrdfContext) -> None:
    """Converts ``<mu1 value="1"/>`` to ``<mu1>1</mu1>``.

    Empty tags such as ``<mu1></mu1>``, which result from empty macro parameters, are removed.
    """
    for child in list(node.children):
        if child.text or child.children or child.tag in INSERTED:
            continue
        if child.attributes.get("value", "").strip() and child.tag not in _WITH_PARTS:
            child.text = (child.get("value") or "").strip()
        elif not child.attributes or list(child.attributes) == ["value"]:
            ctx.warn(
                codes.TAG_EMPTY,
                f"<{child.tag}> is empty, so its default is used",
                origin=child.origin,
                values={"tag": child.tag},
            )
            node.drop(child)


def _read_robot_tags(node: Node, tags: GazeboTags, ctx: UrdfContext) -> None:
    tags.robot_plugins.extend(read_plugin(plugin) for plugin in node.all("plugin"))
    tags.static = node.boolean_at("static", tags.static)
    tags.self_collide = node.boolean_at("self_collide", tags.self_collide)
    tags.self_collide = node.boolean_at("selfCollide", tags.self_collide)
    tags.wind = node.boolean_at("enable_wind", tags.wind)
    inserted = {id(part) for tag in INSERTED for part in node.all(tag)}
    tags.inserted.extend(child for child in node.children if id(child) in inserted)
    warn_idle(node, _ROBOT_IDLE, ctx)
    for child in node.children:
        if child.tag in ROBOT_TAGS or child.tag in _ROBOT_IDLE:
            continue
        if child.tag in LINK_TAGS or child.tag in JOINT_TAGS:
            kind = "link" if child.tag in LINK_TAGS else "joint"
            node.all(child.tag)
            child.mark()
            ctx.warn(
                codes.TAG_MISPLACED,
                f"<{child.tag}> has no effect in a <gazebo> without a reference",
                origin=child.origin,
                hint=f'Move it to a <gazebo reference="…"> with the name of a {kind}.',
                values={"tag": child.tag, "needs": kind, "reference": ""},
            )


def _misplaced_plugins(node: Node, reference: str, ctx: UrdfContext) -> list[PluginTag]:
    plugins = [read_plugin(plugin) for plugin in node.all("plugin")]
    for plugin in plugins:
        ctx.warn(
            codes.TAG_MISPLACED,
            f'plugin "{plugin.name}" is in the <gazebo> of "{reference}", where Gazebo Classic '
            "does not load it; Cartwheel loads it as a plugin of the robot",
            origin=plugin.origin,
            hint="Move it to a <gazebo> without a reference.",
            values={"tag": "plugin", "name": plugin.name, "reference": reference},
        )
    return plugins


def _read_joint_tags(
    node: Node, joint: Joint, tags: GazeboTags, ctx: UrdfContext, *, of_both: bool
) -> None:
    fields = tags.joints.setdefault(joint.name, {})
    axis = fields.setdefault("axis", {})
    fields |= node.stated_numbers({"stopCfm": "stop_cfm", "stopErp": "stop_erp"})
    springs = {"springStiffness": "spring_stiffness", "springReference": "spring_reference"}
    axis |= node.stated_numbers(springs)
    for tag, name in (
        ("provideFeedback", "provide_feedback"),
        ("implicitSpringDamper", "implicit_spring_damper"),
        ("cfmDamping", "implicit_spring_damper"),
        ("preserveFixedJoint", "preserve_fixed"),
        ("disableFixedJointLumping", "preserve_fixed"),
        ("physics/provide_feedback", "provide_feedback"),
        ("physics/ode/provide_feedback", "provide_feedback"),
        ("physics/ode/implicit_spring_damper", "implicit_spring_damper"),
    ):
        found = node.find(tag)
        if found is not None:
            # Either of two tags preserves a fixed joint; a false value does not cancel the other
            # tag.
            fields[name] = found.boolean() or fields.get(name, False)
    for fudge in node.all("fudgeFactor"):
        fudge.mark()
        ctx.warn(
            codes.NOT_SIMULATED,
            "<fudgeFactor> has no effect: it corrects an error of ODE that does not exist in "
            "MuJoCo",
            origin=fudge.origin,
            values={"tag": "fudgeFactor"},
        )
    child_tags = tags.links.setdefault(joint.child, LinkTags())
    for read in read_sensors(
        node.all("sensor"),
        lambda each: replace(read_sensor(each, joint.child), joint=joint.name),
        ctx,
    ):
        if not of_both or read.type == _OF_JOINTS:
            child_tags.sensors.append(read)
    if joint.type != "fixed" and fields.get("preserve_fixed"):
        ctx.warn(
            codes.NOT_SIMULATED,
            f'joint "{joint.name}" is not fixed, so <preserveFixedJoint> has no effect',
            origin=node.origin,
            values={"joint": joint.name},
        )


def _warn_misplaced(node: Node, reference: str, is_link: bool, ctx: UrdfContext) -> None:
    here, there = (LINK_TAGS, JOINT_TAGS) if is_link else (JOINT_TAGS, LINK_TAGS)
    kinds = ("joint", "link") if is_link else ("link", "joint")
    for child in node.children:
        if child.tag in there and child.tag not in here:
            node.all(child.tag)
            child.mark()
            ctx.warn(
                codes.TAG_MISPLACED,
                f"<{child.tag}> has no effect because it applies only to {kinds[0]}s, but "
                f'"{reference}" is a {kinds[1]}',
                origin=child.origin,
                values={"tag": child.tag, "needs": kinds[0], "reference": reference},
            )
