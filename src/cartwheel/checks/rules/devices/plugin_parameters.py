"""Parameters of plugins, compared with those that the plugins read."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

from cartwheel.checks import nodes, plugin_tags, spelling
from cartwheel.checks.rule import rule
from cartwheel.checks.subject import Subject, is_known
from cartwheel.codes import devices as devices_codes
from cartwheel.description.model import PluginTag
from cartwheel.errors import Diagnostic


@rule(devices_codes.PLUGIN_PARAMETER_UNKNOWN)
def plugin_parameter(subject: Subject) -> Iterator[Diagnostic]:
    for robot in subject.robots:
        for tag, _ in robot.plugins():
            for diagnostic in plugin_tags.diagnostics_of(tag):
                yield _advised(tag, diagnostic)


@rule(devices_codes.PLUGIN_PARAMETER_MISSING)
def joint_missing(subject: Subject) -> Iterator[Diagnostic]:
    """Plugins without a joint parameter whose default joint does not exist either."""
    for robot in subject.robots:
        for tag, _ in robot.plugins():
            defaults = plugin_tags.default_joints(tag)
            if all(is_known(joint, robot, subject) for _, joint in defaults):
                continue
            # Misspelt tags are reported by another rule.
            misspelt = {each.values.get("meant") for each in plugin_tags.diagnostics_of(tag)}
            for spellings, joint in defaults:
                if not is_known(joint, robot, subject) and misspelt.isdisjoint(spellings):
                    yield devices_codes.PLUGIN_PARAMETER_MISSING.diagnostic(
                        f'<{spellings[0]}> is missing, and its default, the joint "{joint}", '
                        "does not exist",
                        values={"parameter": spellings[0], "joint": joint},
                        origin=tag.origin,
                        hint=spelling.nearest(joint, robot.joint_names),
                    )


def _advised(tag: PluginTag, diagnostic: Diagnostic) -> Diagnostic:
    """A diagnostic about a plugin's parameters, with the corrected tag if it is misspelt."""
    near = str(diagnostic.values.get("meant") or "")
    # A tag that already exists, also in another spelling, is not the intended one.
    spelled = plugin_tags.spellings(tag.filename, near) or (near,)
    written = bool(near) and any(tag.element.find(each) is not None for each in spelled)
    if written:
        near = ""
    element = next((e for e in tag.element.walk() if e.origin is diagnostic.origin), None)
    unknown = diagnostic.code is devices_codes.PLUGIN_PARAMETER_UNKNOWN
    instead, place = f"<{near}>" if near else "", False
    if near and element is not None and not element.children:
        instead = nodes.written(near, dict(element.attributes), element.text.strip())
        place = True
    return replace(
        diagnostic,
        # Gazebo's plugin may support a tag that ours ignores; a misspelt tag is an error.
        severity="info" if unknown and not near else diagnostic.severity,
        hint="" if near or written else diagnostic.hint,
        instead=instead,
        place="element" if place else "",
        mark=element.tag if element is not None and element is not tag.element else "",
    )
