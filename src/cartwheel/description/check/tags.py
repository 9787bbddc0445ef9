"""Tags without effect: what the readers told while they read, and what only Gazebo ignores.

The readers know best what they passed over. Their diagnostics come here under a rule each, by
what they say, unless another rule says it with more detail.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator
from dataclasses import replace

from cartwheel.codes import code_named
from cartwheel.codes import files as files_codes
from cartwheel.codes import tags as tags_codes
from cartwheel.description.check import meshes, nodes, spelling, xacro_use
from cartwheel.description.check.rule import Finder, Rule, rule
from cartwheel.description.check.subject import IMPOSSIBLE, MISSING, Subject
from cartwheel.description.node import Node
from cartwheel.errors import Code, Diagnostic

_ELSEWHERE = re.compile(
    r"has no <limit>|has no <inertial>|have no <inertial>|watches the collision"
    r"|counts as a frame without mass|is a point mass|all its mass lies in a point"
    r"|^the texture .* does not exist|^the package .* was not found|principal moments"
    r"|; (visual|collision) \"[^\"]*\" is left out|; it is left out|is on the network"
    r"|; a (visual|collision) of link \"[^\"]*\" is left out"
    r"|, as the (model|package) .* was not found|none of its links has a <collision>"
)
"""What other rules say with more detail."""

_KINDS: tuple[tuple[str, str, str], ...] = (
    # A rule's name, what its diagnostics say, one line about it.
    ("material-unknown", r"is none of Gazebo's", "a material that Gazebo does not have"),
    ("material-undefined", r"^the material .* (is not defined|was not found|is not in its scripts)",
     "a material that nobody defines"),
    ("material-differs", r"is defined twice, differently", "a material defined in two ways"),
    ("argument-unknown", r"is not declared there|has no effect: the file is no xacro",
     "an argument given that the file does not have"),
    ("sensor-twice", r"two sensors of the name", "two sensors of a link have one name"),
    ("tag-misplaced", r"Classic does not load it|it belongs to the model",
     "a tag where it has no effect"),
    ("tag-repeated", r"^a further <", "a tag of which only the first counts"),
    ("tag-empty", r"> is empty: ", "an empty tag: the default counts"),
    ("not-simulated",
     r"has no effect here|^<plugin> in <visual>|(is|are) not (simulated|run|restored|applied)"
     r"|nothing to preserve|needs no <axis>|is newer than|names the unknown model"
     r"|is not needed: |is for other programs|is deprecated",
     "something that is read, but does nothing here"),
    ("tag-ignored", r"is not understood and is ignored|has no effect: |tag are ignored"
     r"|has no effect$|, on which .* would act",
     "a tag or attribute that nobody reads, a misspelt one mostly"),
    ("value-ignored", r"is below 0: (the default counts|there is none)|is not within 0 and 1"
     r"|has the size|is made \S+ mm thick|is left out", "a value that cannot count"),
    ("xacro-namespace", r"xmlns:xacro", "the declaration that ROS's own xacro wants is missing"),
    ("xacro-prefix", r"is taken as <xacro:", "a tag of xacro's without its prefix"),
)  # fmt: skip
_IN_ROBOT = re.compile(r"<([^>]*)> in <robot> is not understood")
_OF_URDF = (
    "inertial", "visual", "collision", "geometry", "origin", "mass", "inertia", "mesh", "parent",
    "child", "axis", "limit", "dynamics", "mimic", "plugin", "color", "texture",
    "hardwareInterface",
)  # fmt: skip
"""Tags that stand somewhere in a URDF, but not in its <robot>."""
_QUOTED = re.compile(r'"([^"]*)"')
_MISPLACED = re.compile(
    r"acts on a (link|joint), but .*: it has no effect|has no effect in a <gazebo> without a "
    r"reference: it needs"
)
_MEANT = re.compile(r"\.? Did you mean (?:<([^>]+)>|\"([^\"]+)\")\?")
_REST = "reader"
_ANY = Code("CW000", "unclassified", "warning", "what takes the code of its rule")
_MOMENTS = ("ixx", "ixy", "ixz", "iyy", "iyz", "izz")
_NAMESPACE = 'xmlns:xacro="http://www.ros.org/wiki/xacro"'


@rule(tags_codes.GAZEBO_IGNORES)
def gazebo_ignores(subject: Subject) -> Iterator[Diagnostic]:
    if not subject.is_urdf:
        return
    for node in nodes.children(subject.root, "gazebo"):
        on_link = bool(nodes.text_of(node, "reference"))
        for child in node.children:
            value = child.text or child.attributes.get("value", "")
            if on_link and child.tag == "mu":
                yield _ANY.diagnostic(
                    message="Gazebo does not know <mu> here: the friction stays 1",
                    origin=child.origin,
                    instead=f"<mu1>{value}</mu1><mu2>{value}</mu2>",
                    place="element",
                )
            elif not on_link and child.tag == "selfCollide":
                yield _ANY.diagnostic(
                    message="Gazebo knows <selfCollide> of links only; of the whole robot it is "
                    "<self_collide>",
                    origin=child.origin,
                    instead=f"<self_collide>{value}</self_collide>",
                    place="element",
                )


@rule(tags_codes.TAG_MISPLACED)
def tag_misplaced(subject: Subject) -> Iterator[Diagnostic]:
    yield from told(subject, "tag-misplaced")
    blocks: dict[tuple[int, str], list[tuple[Node, Diagnostic]]] = {}
    for diagnostic in _diagnostics(subject):
        match = _MISPLACED.search(diagnostic.message)
        node = nodes.at(subject.root, diagnostic.origin) if match and diagnostic.origin else None
        block = nodes.parent_of(subject.root, node) if node is not None else None
        if match is not None and node is not None and block is not None:
            blocks.setdefault((id(block), match[0]), []).append((node, diagnostic))
    for (_, why), found in blocks.items():
        first, diagnostic = found[0]
        block = nodes.parent_of(subject.root, first) or first
        names = ", ".join(dict.fromkeys(f"<{node.tag}>" for node, _ in found))
        meant = _meant_by(subject, nodes.text_of(block, "reference"), why)
        alone = len(found) == len(block.children)
        if len(found) == 1:
            said = diagnostic.message
        else:
            said = why.replace("it has no effect", "they have no effect").replace(": it needs", "")
            said = f"{names} {said.replace('acts on', 'act on').replace('has no', 'have no')}"
        yield _ANY.diagnostic(
            message=said.strip(),
            origin=block.origin if meant and alone else first.origin,
            instead=f'reference="{meant}"' if meant else "",
            place="attribute" if meant and alone else "",
            mark="reference" if meant and alone else "",
            hint="" if meant else 'Write them into a <gazebo reference="…"> of their own.',
        )


def _meant_by(subject: Subject, reference: str, why: str) -> str:
    """The link that a joint moves, or the joint that moves a link: the other of the two."""
    on_link = why.startswith("acts on a link")
    for joint in nodes.children(subject.root, "joint"):
        child = nodes.text_of(nodes.child(joint, "child"), "link")
        if on_link and nodes.name_of(joint) == reference:
            return child
        if not on_link and child == reference:
            return nodes.name_of(joint)
    return ""


def told(subject: Subject, name: str) -> Iterator[Diagnostic]:
    """What the readers told that belongs to a rule."""
    holed = {f'link "{link}" has no ' for robot in subject.robots for link in robot.cut}
    for diagnostic in _diagnostics(subject):
        if name == "value-ignored" and diagnostic.severity == "error":
            continue  # what is left out because it cannot be read is told as such
        if _kind(diagnostic.message) == name and not diagnostic.message.startswith(tuple(holed)):
            yield _remark(subject, diagnostic)


def _kind(message: str) -> str | None:
    if _MISPLACED.search(message):
        return None
    for name, pattern, _ in _KINDS:
        if re.search(pattern, message) and not _ELSEWHERE.search(message):
            return name
    return None if _ELSEWHERE.search(message) else _REST


def _diagnostics(subject: Subject) -> Iterable[Diagnostic]:
    return () if subject.read is None else subject.read.diagnostics


def _remark(subject: Subject, diagnostic: Diagnostic) -> Diagnostic:
    match = _MEANT.search(diagnostic.message)
    message = diagnostic.message
    found = nodes.at(subject.root, diagnostic.origin) if diagnostic.origin is not None else None
    if found is not None and (written := _from_urdf(subject, found, message)):
        return _ANY.diagnostic(
            message=f"{message}: SDF writes elements where URDF has attributes",
            origin=diagnostic.origin,
            instead=written,
            place="element",
        )
    if _NAMESPACE in message:
        return _ANY.diagnostic(
            message=message, origin=diagnostic.origin, instead=_NAMESPACE, place="attribute"
        )
    node = nodes.at(subject.root, diagnostic.origin) if diagnostic.origin is not None else None
    if match is not None and node is not None and (match[2] or "") in node.attributes:
        message = message[: match.start()]  # it is written already: not a misspelt one
        match = None
    # An attribute too many is mostly a note of its author's; one that is misspelt is a fault.
    idle = _kind(message) == "not-simulated" or (
        match is None and (message.startswith("the attribute") or _is_extension(message))
    )
    if (
        node is not None
        and "in <robot> is not understood" in message
        and node.tag in xacro_use.macro_names(subject)
    ):
        call = nodes.changed(node).replace(f"<{node.tag}", f"<xacro:{node.tag}", 1)
        return _ANY.diagnostic(
            message=f"<{node.tag}> is not expanded, and does nothing: a macro is called by "
            f"<xacro:{node.tag}>",
            origin=node.origin,
            instead=call if not node.children else f"<xacro:{node.tag}>",
            place="element" if not node.children else "",
        )
    if "is none of Gazebo's" in message and not message.startswith('the material "Gazebo/'):
        # A name such as PR2/Black is of a script that a robot brings along.
        idle, match = True, None
        message = message.partition(" Did you mean")[0]
    if match is not None and match[2]:
        name = _QUOTED.search(message)
        if name is None or not spelling.meant(name[1], [match[2]]):
            message = message[: match.start()] + message[match.end() :]
            match = None
    near = ""
    if match is not None:
        near = match[1] or match[2]
        message = message[: match.start()] + message[match.end() :]
    instead, place = "", ""
    if near and node is not None and not node.children:
        if match is not None and match[1]:
            instead, place = nodes.written(near, node.attributes, node.text), "element"
        elif node.tag == "material" and "name" in node.attributes:
            instead, place = f'name="{near}"', "attribute"
        elif node.tag in ("material", "name"):
            instead, place = nodes.written(node.tag, node.attributes, near), "element"
    return _ANY.diagnostic(
        severity="info" if idle else diagnostic.severity,
        message=message.strip(),
        origin=diagnostic.origin,
        instead=instead or (f"<{near}>" if match is not None and match[1] else near),
        place="element" if place == "element" else "attribute" if place else "",
    )


def _from_urdf(subject: Subject, node: Node, message: str) -> str:
    """What SDF writes for an element that has URDF's attributes; empty for any other."""
    known = {"box": ("size",), "sphere": ("radius",), "cylinder": ("radius", "length"),
             "axis": ("xyz",), "inertia": _MOMENTS}.get(node.tag, ())  # fmt: skip
    attributes = {key: value for key, value in node.attributes.items() if key in known}
    if subject.is_urdf or not message.startswith("the attribute") or node.children:
        return ""
    if node.tag == "mass" and "value" in node.attributes:
        return nodes.written("mass", {}, node.attributes["value"].strip())
    inner = "".join(nodes.written(key, {}, value.strip()) for key, value in attributes.items())
    return nodes.written(node.tag, {}, inner) if inner else ""


def _is_extension(message: str) -> bool:
    """Whether it is of a tag of <robot> that URDF has nowhere: it is for another program."""
    found = _IN_ROBOT.match(message)
    return found is not None and found[1] not in _OF_URDF


def _finder(name: str) -> Finder:
    return lambda subject: told(subject, name)


def _rules() -> Iterator[Rule]:
    for name, _, _ in _KINDS:
        if name == "tag-misplaced":
            yield tag_misplaced
            continue
        yield rule(code_named(name))(_finder(name))
    yield rule(Code("CW000", _REST, "warning", "whatever else the readers told"))(_finder(_REST))


@rule(files_codes.UNREADABLE)
def unreadable(subject: Subject) -> Iterable[Diagnostic]:
    for failure in subject.failures:
        if not MISSING.search(failure.message) and not IMPOSSIBLE.search(failure.message):
            yield replace(failure, code=files_codes.UNREADABLE)
    yield from meshes.left_out_otherwise(subject)


RULES = (unreadable, gazebo_ignores, *_rules())
