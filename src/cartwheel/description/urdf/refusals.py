"""What the URDF parser of ROS and Gazebo refuses, and Cartwheel reads nevertheless.

ROS, Gazebo Classic and gz-sim read URDFs with urdfdom, which returns no robot at all after these
errors. What the readers of Cartwheel refuse too, or report themselves, is not repeated here.
Numbers are as in urdfdom since ROS Noetic; the one in ROS Melodic reads the beginning of a text.
"""

from __future__ import annotations

import math
import re
from collections.abc import Iterator, Mapping
from itertools import islice

from cartwheel.codes import robot, tags
from cartwheel.description.elements.node import Node
from cartwheel.errors import Diagnostic, Value

REFUSED = "ROS and Gazebo do not load the robot"
_NUMBER = re.compile(r"\s*+([+-]?(?:\d++\.?+\d*+|\.\d++)(?:[eE][+-]?\d++)?+)\s*+", re.ASCII)
"""Possessive: otherwise there would be many ways to separate the digits of a long number."""
_INFINITE = re.compile(r"\s*[+-]?inf(inity)?\s*", re.IGNORECASE)
_VERSION = re.compile(r"1\.[012]\.?")
"""Versions of URDF; most releases of ROS only know 1.0."""
_LARGE = "1e9"
_NUMBERS = {
    "limit": ("lower", "upper", "effort", "velocity"),
    "dynamics": ("damping", "friction"),
    "mimic": ("multiplier", "offset"),
    "safety_controller": ("soft_lower_limit", "soft_upper_limit", "k_position", "k_velocity"),
    "calibration": ("rising", "falling"),
}
_LONGEST = 200


def refusals(root: Node) -> Iterator[Diagnostic]:
    """Why ROS and Gazebo do not load a URDF; every diagnostic has the value ``refused``.

    Args:
        root: The ``<robot>``, which Cartwheel can read, with all xacro expanded.
    """
    yield from _version(root)
    yield from _nameless_materials(root)
    links: dict[str, str] = {}
    for node in _all(root, "link"):
        if name := node.attributes.get("name"):
            links.setdefault(name.strip(), name)
    for joint in _all(root, "joint"):
        yield from _joint(joint, links)


def trimmed(text: str) -> str | None:
    """The number that a text would be without the white space after it; None for other texts."""
    number = _NUMBER.fullmatch(text)
    return number[1] if number and text != text.rstrip() else None


def _version(root: Node) -> Iterator[Diagnostic]:
    version = root.attributes.get("version")
    if version is not None and not _VERSION.fullmatch(version):
        yield _invalid(root, "version", version, "is not a version of URDF", "1.0")


def _nameless_materials(root: Node) -> Iterator[Diagnostic]:
    nameless = (node for node in _all(root, "material") if "name" not in node.attributes)
    for node in islice(nameless, 1, 2):
        yield tags.TAG_MISSING.diagnostic(
            f"two materials of the robot have no name, so {REFUSED}",
            origin=node.origin,
            hint="Add the attribute name to each <material>.",
            values={"tag": "material", "missing": "name", "refused": True},
        )


def _joint(joint: Node, links: Mapping[str, str]) -> Iterator[Diagnostic]:
    name = joint.attributes.get("name", "").strip()
    kind = joint.attributes.get("type", "")
    if kind != kind.strip():
        yield _invalid(joint, "type", kind, "contains white space", kind.strip())
    for tag in ("parent", "child"):
        end = _first(joint, tag)
        link = end.attributes.get("link", "") if end is not None else ""
        stated = links.get(link.strip(), link)
        if end is not None and stated != link:
            yield _invalid(end, "link", link, f'is not the name of the link "{stated}"', stated)
    limit = _first(joint, "limit")
    for what in ("effort", "velocity"):
        if limit is not None and what not in limit.attributes:
            yield robot.LIMIT_INCOMPLETE.diagnostic(
                f'the <limit> of joint "{name}" has no {what}, so {REFUSED}',
                origin=limit.origin,
                hint=f'Add {what}="10", for example.',
                # `cartwheel check` reports it as an error.
                severity="warning",
                values={"joint": name, "attribute": what, "refused": True},
            )
    dynamics = _first(joint, "dynamics")
    if dynamics is not None and not dynamics.attributes.keys() & {"damping", "friction"}:
        yield _missing(dynamics, name, "damping", "has neither damping nor friction")
    safety = _first(joint, "safety_controller")
    if safety is not None and "k_velocity" not in safety.attributes:
        yield _missing(safety, name, "k_velocity", "has no k_velocity")
    for tag, attributes in _NUMBERS.items():
        part = _first(joint, tag)
        # Of these, the readers report what is not a number.
        read = tag != "calibration" and not (
            tag in ("limit", "dynamics") and kind.strip() in ("fixed", "floating")
        )
        for attribute in attributes:
            text = part.attributes.get(attribute) if part is not None else None
            if part is not None and text is not None:
                yield from _number(part, attribute, text, read=read)


def _number(node: Node, attribute: str, text: str, *, read: bool) -> Iterator[Diagnostic]:
    number = _NUMBER.fullmatch(text)
    if _INFINITE.fullmatch(text) or (number and math.isinf(float(number[1]))):
        sign = "-" if text.lstrip().startswith("-") else ""
        yield _invalid(node, attribute, text, "is not a finite number", f"{sign}{_LARGE}")
    elif (instead := trimmed(text)) is not None:
        yield _invalid(node, attribute, text, "ends with white space", instead)
    elif not number and not read:
        yield _invalid(node, attribute, text, "is not a number", "0")


def _invalid(node: Node, attribute: str, text: str, what: str, instead: str) -> Diagnostic:
    label = f"{node.tag} {attribute}"
    return tags.VALUE_INVALID.diagnostic(
        f'{label} "{text[:_LONGEST]}" {what}, so {REFUSED}',
        origin=node.origin,
        instead=f'{attribute}="{instead}"',
        place="attribute",
        mark=attribute,
        values={"name": label, "stated": text[:_LONGEST], "refused": True},
    )


def _missing(node: Node, joint: str, attribute: str, what: str) -> Diagnostic:
    values: dict[str, Value] = {"tag": node.tag, "joint": joint, "missing": attribute}
    return tags.TAG_MISSING.diagnostic(
        f'the <{node.tag}> of joint "{joint}" {what}, so {REFUSED}',
        origin=node.origin,
        instead=f'{attribute}="0"',
        place="attribute",
        values={**values, "refused": True},
    )


def _all(node: Node, tag: str) -> Iterator[Node]:
    return (child for child in node.children if child.tag == tag)


def _first(node: Node, tag: str) -> Node | None:
    return next(_all(node, tag), None)
