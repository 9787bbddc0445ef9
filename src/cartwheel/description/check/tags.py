"""Tags without effect: what the readers told while they read, and what only Gazebo ignores.

The readers know best what they passed over. Their diagnostics come here under a rule each, by
what they say, unless another rule says it with more detail.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator

from cartwheel.description.check import nodes
from cartwheel.description.check.finding import Finder, Remark, Rule, rule
from cartwheel.description.check.subject import IMPOSSIBLE, MISSING, Subject
from cartwheel.errors import Diagnostic

_ELSEWHERE = re.compile(
    r"has no <limit>|has no <inertial>|watches the collision|counts as a frame without mass"
    r"|: the (visual|collision) is left out|is a point mass|^the texture .* does not exist"
    r"|^the package .* was not found|; (visual|collision) \"[^\"]*\" is left out"
    r"|; a (visual|collision) of link \"[^\"]*\" is left out"
)
"""What other rules say with more detail."""

_KINDS: tuple[tuple[str, str, str], ...] = (
    # A rule's name, what its diagnostics say, one line about it.
    ("material-unknown", r"is none of Gazebo's", "a material that Gazebo does not have"),
    ("material-undefined", r"^the material .* (is not defined|was not found)",
     "a material that nobody defines"),
    ("material-differs", r"is defined twice, differently", "a material defined in two ways"),
    ("argument-unknown", r"is not declared there|has no effect: the file is no xacro",
     "an argument given that the file does not have"),
    ("sensor-twice", r"two sensors of the name", "two sensors of a link have one name"),
    ("tag-misplaced", r"in a <gazebo> without a reference|acts on a (link|joint), but"
     r"|Classic does not load it", "a tag where it has no effect"),
    ("tag-repeated", r"^a further <", "a tag of which only the first counts"),
    ("tag-empty", r"> is empty: ", "an empty tag: the default counts"),
    ("not-simulated",
     r"has no effect here|^<plugin> in <visual>|(is|are) not (simulated|run|restored|applied)"
     r"|nothing to preserve|needs no <axis>|is newer than|names the unknown model",
     "something that is read, but does nothing here"),
    ("tag-ignored", r"is not understood and is ignored|has no effect: write",
     "a tag or attribute that nobody reads, a misspelt one mostly"),
    ("value-ignored", r"is below 0: the default counts|is not within 0 and 1|has the size"
     r"|is left out", "a value that cannot count"),
    ("xacro-namespace", r"xmlns:xacro", "the declaration that ROS's own xacro wants is missing"),
)  # fmt: skip
_MEANT = re.compile(r"\.? Did you mean (?:<([^>]+)>|\"([^\"]+)\")\?")
_REST = "reader"


@rule("gazebo-ignores", "warning", "a tag that is read here, and that Gazebo ignores")
def gazebo_ignores(subject: Subject) -> Iterator[Remark]:
    if not subject.is_urdf:
        return
    for node in nodes.children(subject.root, "gazebo"):
        on_link = bool(nodes.text_of(node, "reference"))
        for child in node.children:
            value = child.text or child.attributes.get("value", "")
            if on_link and child.tag == "mu":
                yield Remark(
                    message="Gazebo does not know <mu> here: the friction stays 1",
                    origin=child.origin,
                    instead=f"<mu1>{value}</mu1><mu2>{value}</mu2>",
                    place="element",
                )
            elif not on_link and child.tag == "selfCollide":
                yield Remark(
                    message="Gazebo knows <selfCollide> of links only; of the whole robot it is "
                    "<self_collide>",
                    origin=child.origin,
                    instead=f"<self_collide>{value}</self_collide>",
                    place="element",
                )


def told(subject: Subject, name: str) -> Iterator[Remark]:
    """What the readers told that belongs to a rule."""
    for diagnostic in _diagnostics(subject):
        if _kind(diagnostic.message) == name:
            yield _remark(subject, diagnostic)


def _kind(message: str) -> str | None:
    for name, pattern, _ in _KINDS:
        if re.search(pattern, message) and not _ELSEWHERE.search(message):
            return name
    return None if _ELSEWHERE.search(message) else _REST


def _diagnostics(subject: Subject) -> Iterable[Diagnostic]:
    return () if subject.read is None else subject.read.diagnostics


def _remark(subject: Subject, diagnostic: Diagnostic) -> Remark:
    match = _MEANT.search(diagnostic.message)
    message = diagnostic.message
    node = nodes.at(subject.root, diagnostic.origin) if diagnostic.origin is not None else None
    if match is not None and node is not None and (match[2] or "") in node.attributes:
        message = message[: match.start()]  # it is written already: not a misspelt one
        match = None
    # An attribute too many is mostly a note of its author's; one that is misspelt is a fault.
    idle = _kind(message) == "not-simulated" or (
        message.startswith("the attribute") and match is None
    )
    if "is none of Gazebo's" in message and not message.startswith('the material "Gazebo/'):
        # A name such as PR2/Black is of a script that a robot brings along.
        idle, match = True, None
        message = message.partition(" Did you mean")[0]
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
    return Remark(
        severity="info" if idle else diagnostic.severity,
        message=message.strip(),
        origin=diagnostic.origin,
        instead=instead or (f"<{near}>" if match is not None and match[1] else near),
        place="element" if place == "element" else "attribute" if place else "",
    )


def _finder(name: str) -> Finder:
    return lambda subject: told(subject, name)


def _rules() -> Iterator[Rule]:
    for name, _, summary in _KINDS:
        yield rule(name, "info" if name == "not-simulated" else "warning", summary)(_finder(name))
    yield rule(_REST, "warning", "whatever else the readers told")(_finder(_REST))


@rule("unreadable", "error", "something that cannot be read; the rest is checked without it")
def unreadable(subject: Subject) -> Iterable[Remark]:
    for failure in subject.failures:
        if not MISSING.search(failure.message) and not IMPOSSIBLE.search(failure.message):
            yield failure


RULES = (unreadable, gazebo_ignores, *_rules())
