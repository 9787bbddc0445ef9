"""Diagnostics from the readers, with replacement text where it is known.

The diagnostics keep their codes. Those for which a rule gives more detail are left to that rule.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator
from dataclasses import replace
from functools import partial

from cartwheel.checks import nodes, spelling
from cartwheel.checks.rule import limited
from cartwheel.checks.subject import ABSENT, Subject
from cartwheel.codes import codes_of, devices, files
from cartwheel.codes import tags as codes
from cartwheel.description.elements.node import Node
from cartwheel.description.files.package_folders import is_in_stand_in
from cartwheel.description.model import MOMENTS
from cartwheel.errors import Diagnostic, Origin

_ELSEWHERE = frozenset({*codes_of("robot"), devices.CONTACT_COLLISION_UNKNOWN})
"""Codes of warnings for which a rule gives more detail."""
_OF_GAPS = (codes.DEFAULT_USED, codes.TAG_EMPTY)
"""Codes for elements with a missing part."""
_GUESSED = frozenset({
    codes.TAG_IGNORED, codes.MATERIAL_UNKNOWN, codes.MATERIAL_UNDEFINED, files.ARGUMENT_UNKNOWN,
})  # fmt: skip
"""Codes for possibly misspelt names, with the likely name in their values."""
_OF_URDF = (
    "inertial", "visual", "collision", "geometry", "origin", "mass", "inertia", "mesh", "parent",
    "child", "axis", "limit", "dynamics", "mimic", "plugin", "color", "texture",
    "hardwareInterface",
)  # fmt: skip
"""Tags that are valid in URDF, but not directly in <robot>."""
_SINGLE = ("inertial", "mass", "inertia", "geometry", "axis", "limit", "dynamics", "mimic")
"""Elements of URDF that their parents contain once."""
_ATTRIBUTES = {"mass": ("value",), "inertia": MOMENTS}
_CALL = re.compile(r"(.+):(\d+) \S+")
"""A call of a macro in `Origin.stack`."""
_NAMESPACE = 'xmlns:xacro="http://www.ros.org/wiki/xacro"'


def passed(subject: Subject) -> Iterator[Diagnostic]:
    """Diagnostics and errors from the readers that no rule reports in more detail."""
    for failure in subject.failures:
        if failure.code not in ABSENT and "moments" not in failure.values:
            yield failure
    yield from (each for _, selected in subject.launched for each in selected.problems)
    yield from subject.unexpanded
    yield from limited(_relevant(subject), partial(_finished, subject))


def _relevant(subject: Subject) -> Iterator[Diagnostic]:
    """Unchanged diagnostics from the readers that no rule reports in more detail."""
    gaps = {id(origin) for origin in subject.gaps}
    lacking = {link for robot in subject.robots for link in robot.incomplete}
    for diagnostic in diagnostics_of(subject):
        if diagnostic.code in ABSENT or has_place(diagnostic):
            continue
        if diagnostic.code is codes.LINK_CUT_SHORT and id(diagnostic.origin) in gaps:
            continue
        # Omit elements that are incomplete only because a part was unreadable.
        follows = "missing" in diagnostic.values and diagnostic.values.get("link") in lacking
        follows |= diagnostic.code in _OF_GAPS and id(diagnostic.origin) in gaps
        if diagnostic.severity == "error" or (diagnostic.code not in _ELSEWHERE and not follows):
            yield diagnostic


def diagnostics_of(subject: Subject) -> tuple[Diagnostic, ...]:
    """What the readers report about a description."""
    return () if subject.read is None else subject.read.diagnostics


def _finished(subject: Subject, diagnostic: Diagnostic) -> Diagnostic:
    """A reader's diagnostic with its mark or replacement text."""
    finish = _marked if diagnostic.severity == "error" else _advised
    return finish(subject, diagnostic)


def _marked(subject: Subject, diagnostic: Diagnostic) -> Diagnostic:
    """An error with the marked text, or with the misspelt parent or child of a joint."""
    node = subject.node_at(diagnostic.origin)
    if node is None:
        return diagnostic
    values = diagnostic.values
    name, meant = str(values.get("name", "")), str(values.get("meant", ""))
    if "end" in values and meant and spelling.meant(name, [meant]):
        end = node if node.tag == values["end"] else nodes.child(node, str(values["end"]))
        if end is not None and end.text.strip() == name:
            return replace(
                diagnostic,
                origin=end.origin,
                instead=nodes.written(end.tag, {}, meant),
                place="element",
                mark=name,
            )
    return replace(diagnostic, mark=diagnostic.mark or nodes.text_of(node, "filename"))


def _advised(subject: Subject, diagnostic: Diagnostic) -> Diagnostic:
    """A warning with replacement text, at a lower severity if it is rarely a fault."""
    if diagnostic.code is files.XACRO_NAMESPACE:
        return replace(diagnostic, instead=_NAMESPACE, place="attribute", hint="")
    if diagnostic.code is codes.NOT_SIMULATED:
        return replace(diagnostic, severity="info")
    if diagnostic.code not in _GUESSED:
        return diagnostic
    node = subject.node_at(diagnostic.origin)
    values = diagnostic.values
    attribute = str(values.get("attribute", ""))
    if node is not None and attribute and (written := _from_urdf(subject, node)):
        hint = "SDF uses elements where URDF uses attributes."
        return replace(diagnostic, instead=written, place="element", hint=hint)
    if node is not None and _calls_macro(subject, node, diagnostic):
        call = nodes.changed(node).replace(f"<{node.tag}", f"<xacro:{node.tag}", 1)
        return replace(
            diagnostic,
            message=f"<{node.tag}> is not expanded because a macro is called with "
            f"<xacro:{node.tag}>",
            instead=call if not node.children else f"<xacro:{node.tag}>",
            place="element" if not node.children else "",
            hint="",
        )
    meant = _likely(node, diagnostic)
    # An unknown attribute is usually an author's note; a misspelt attribute is a fault.
    idle = diagnostic.code is codes.TAG_IGNORED and not meant and (
        bool(attribute) or _is_extension(diagnostic)
    )  # fmt: skip
    # Names such as PR2/Black refer to a material script in the robot's package.
    if diagnostic.code is codes.MATERIAL_UNKNOWN:
        idle = not str(values["name"]).startswith("Gazebo/")
    is_tag = diagnostic.code is codes.TAG_IGNORED and not attribute
    hint = "" if meant or values.get("meant") else diagnostic.hint
    if is_tag and meant and node is not None and not _fits(subject, node, meant):
        meant = ""
        if subject.is_urdf and subject.files[0].endswith(".xacro"):
            hint = f"If it is a macro, define it and write <xacro:{node.tag}>."
    instead, attached = "", ""
    if meant and node is not None and not node.children:
        if is_tag:
            instead, attached = nodes.written(meant, node.attributes, node.text), "element"
        elif node.tag == "material" and "name" in node.attributes:
            instead, attached = f'name="{meant}"', "attribute"
        elif node.tag in ("material", "name"):
            instead, attached = nodes.written(node.tag, node.attributes, meant), "element"
    return replace(
        diagnostic,
        severity="info" if idle else diagnostic.severity,
        instead=instead or (f"<{meant}>" if is_tag and meant else meant),
        place="element" if attached == "element" else "attribute" if attached else "",
        hint=hint,
    )


def _likely(node: Node | None, diagnostic: Diagnostic) -> str:
    """The name that was clearly meant; empty if names are only similar."""
    values = diagnostic.values
    meant = str(values.get("meant", ""))
    if diagnostic.code is codes.TAG_IGNORED and "attribute" not in values:
        return meant
    if node is not None and meant in node.attributes:
        return ""  # the attribute already exists, so it was not misspelt
    name = str(values.get("attribute", values.get("name", "")))
    if diagnostic.code is codes.MATERIAL_UNKNOWN and not name.startswith("Gazebo/"):
        return ""
    return meant if meant and spelling.meant(name, [meant]) else ""


def _calls_macro(subject: Subject, node: Node, diagnostic: Diagnostic) -> bool:
    in_robot = diagnostic.values.get("parent") == "robot"
    return node.tag in subject.macros and (in_robot or node.tag not in _OF_URDF)


def _fits(subject: Subject, node: Node, meant: str) -> bool:
    """Whether an element with another tag would be valid in the place of an unknown one."""
    holder = subject.holder_of(node)
    if meant in _SINGLE and holder is not None and nodes.child(holder, meant) is not None:
        return False
    others = (each for each in nodes.walk(subject.root) if each.tag == meant)
    known = set(_ATTRIBUTES.get(meant, ())).union(*(each.attributes for each in others))
    return not known or known.issuperset(node.attributes)


def _from_urdf(subject: Subject, node: Node) -> str:
    """SDF text for an element with URDF attributes; empty for any other element."""
    known = {"box": ("size",), "sphere": ("radius",), "cylinder": ("radius", "length"),
             "axis": ("xyz",), "inertia": MOMENTS}.get(node.tag, ())  # fmt: skip
    attributes = {key: value for key, value in node.attributes.items() if key in known}
    if subject.is_urdf or node.children:
        return ""
    if node.tag == "mass" and "value" in node.attributes:
        return nodes.written("mass", {}, node.attributes["value"].strip())
    inner = "".join(nodes.written(key, {}, value.strip()) for key, value in attributes.items())
    return nodes.written(node.tag, {}, inner) if inner else ""


def _is_extension(diagnostic: Diagnostic) -> bool:
    """Whether the diagnostic is about a <robot> child unknown to URDF, for another program."""
    values = diagnostic.values
    return values.get("parent") == "robot" and values["tag"] not in _OF_URDF


def has_place(diagnostic: Diagnostic) -> bool:
    """Whether the diagnostic is about a tag that belongs in a link or joint."""
    return diagnostic.code is codes.TAG_MISPLACED and "needs" in diagnostic.values


def outside_stand_ins(file: str, findings: Iterable[Diagnostic]) -> Iterator[Diagnostic]:
    """The findings without those in Cartwheel's stand-ins for packages that are not installed.

    No user can change a stand-in. Errors in it are kept, at the user's call.

    Args:
        file: The file that is checked. If it is a stand-in itself, all findings are kept.
        findings: The findings.
    """
    own = is_in_stand_in(file)
    for each in findings:
        if own or each.origin is None or not is_in_stand_in(each.origin.file):
            yield each
        elif each.severity == "error" and (call := _call(each.origin)) is not None:
            yield replace(each, origin=call, mark="", instead="", place="")


def _call(origin: Origin) -> Origin | None:
    """The innermost call of a macro in the user's files that leads to a place."""
    for index, text in enumerate(origin.stack):
        call = _CALL.fullmatch(text)
        if call is not None and not is_in_stand_in(call[1]):
            return Origin(file=call[1], line=int(call[2]), stack=origin.stack[index + 1 :])
    return None
