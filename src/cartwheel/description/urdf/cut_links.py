"""Links of which ROS and Gazebo read only a part, and Cartwheel reads more.

They read URDFs with urdfdom, which reads the inertial of a link, then its visuals, then its
collisions. At the first error, it leaves the link as it is then, and continues with the next link.
What the readers of Cartwheel refuse is not repeated here.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field

from cartwheel.codes.tags import LINK_CUT_SHORT
from cartwheel.description.elements import numbers
from cartwheel.description.elements.node import Node
from cartwheel.description.model import MOMENTS
from cartwheel.description.urdf.refusals import trimmed
from cartwheel.errors import Diagnostic, Place, Value, enumerated

_SHAPES: Mapping[str, Sequence[str]] = {
    "box": (),
    "sphere": ("radius",),
    "cylinder": ("length", "radius"),
    "mesh": (),
}
"""The shapes that urdfdom knows, with their attributes that are single numbers.

The releases up to ROS Kilted know no others. Later ones know a capsule in URDF 1.2, which the
earlier ones do not load.
"""
_CAPSULE = (
    "Write a <cylinder> and two <sphere> elements, each in its own <collision> or <visual>: no "
    "release of ROS up to Kilted knows <capsule>."
)
_MOST_TEXT = 200


@dataclass(kw_only=True, slots=True)
class _Stop:
    """Where urdfdom stops reading a link."""

    part: Node
    """The inertial, visual or collision."""
    at: Node
    message: str
    """What is wrong there, as a sentence without a full stop."""
    hint: str = ""
    instead: str = ""
    place: Place = ""
    mark: str = ""
    values: dict[str, Value] = field(default_factory=dict)
    loses_inertia: bool = False
    """Whether the link then has another mass or inertia than its ``<inertial>`` states."""


def cut_links(root: Node) -> Iterator[Diagnostic]:
    """Reports the links that ROS and Gazebo read only partly.

    The value ``cut`` of each diagnostic is true. It is an error if collisions are lost, or the
    inertia of a link that is not fixed to another one.

    Args:
        root: The ``<robot>``, with all xacro expanded.
    """
    fixed = {
        child.attributes.get("link", "").strip()
        for joint in _all(root, "joint")
        if joint.attributes.get("type", "").strip() == "fixed"
        for child in _all(joint, "child")
    }
    shapes = _SHAPES
    if root.attributes.get("version", "").strip().startswith("1.2"):
        shapes = {**_SHAPES, "capsule": ("length", "radius")}
    for link in _all(root, "link"):
        stop = _stop_of(link, shapes)
        if stop is not None:
            yield from _report(link, stop, fixed)


def _report(link: Node, stop: _Stop, fixed: set[str]) -> Iterator[Diagnostic]:
    name, kind = link.attributes.get("name", "").strip(), stop.part.tag
    visuals, collisions = _all(link, "visual"), _all(link, "collision")
    if kind == "visual":
        visuals = visuals[visuals.index(stop.part) :]
    elif kind == "collision":
        visuals, collisions = [], collisions[collisions.index(stop.part) :]
    inertia = kind == "inertial" and stop.loses_inertia
    lost = {
        "inertia": ["the inertia"] if inertia else [],
        "visual": _shown(visuals, "visual", stop.part),
        "collision": _shown(collisions, "collision", stop.part),
    }
    shown = [words for each in lost.values() for words in each]
    if not shown:
        return
    matters = bool(collisions) or (inertia and name not in fixed)
    yield LINK_CUT_SHORT.diagnostic(
        f'{stop.message}, so ROS and Gazebo stop there and load link "{name}" without '
        f"{enumerated(shown)}; Cartwheel reads the rest of it",
        severity="error" if matters else "warning",
        origin=stop.at.origin,
        hint=stop.hint,
        instead=stop.instead,
        place=stop.place,
        mark=stop.mark,
        values={
            "link": name,
            "lost": tuple(each for each in lost if lost[each]),
            "cut": True,
            **stop.values,
        },
    )


def _shown(lost: Sequence[Node], kind: str, stop: Node) -> list[str]:
    """Words for the visuals or collisions that are lost."""
    this = [f"this {kind}"] if stop in lost else []
    count = len(lost) - len(this)
    the = "the later" if this else "the"
    return [*this, *([f"{the} {kind}{'s' if count > 1 else ''}"] if count else [])]


def _stop_of(link: Node, shapes: Mapping[str, Sequence[str]]) -> _Stop | None:
    """Where urdfdom stops reading a link; None if it reads all of it."""
    for inertial in _all(link, "inertial")[:1]:
        if (stop := _stop_in_inertial(inertial)) is not None:
            return stop
    for part in (*_all(link, "visual"), *_all(link, "collision")):
        if (stop := _stop_in_shape(part, shapes)) is not None:
            return stop
        nameless = part.tag == "visual" and any(
            "name" not in each.attributes for each in _all(part, "material")[:1]
        )
        if nameless:
            # The reader of links stops there as well, and reports it.
            return None
    return None


def _stop_in_inertial(inertial: Node) -> _Stop | None:
    masses, tensors = _all(inertial, "mass")[:1], _all(inertial, "inertia")[:1]
    if not masses or "value" not in masses[0].attributes:
        name = "value" if masses else "mass"
        near = numbers.likely(
            name, masses[0].attributes if masses else [each.tag for each in inertial.children]
        )
        return _Stop(
            part=inertial,
            at=masses[0] if masses else inertial,
            message="a <mass> has no value" if masses else "an <inertial> has no <mass>",
            hint=f'Is "{near}" a misspelling of "{name}"?'
            if near
            else 'Write the mass in kg as an attribute, such as <mass value="1"/>.',
            values={
                "tag": "mass" if masses else "inertial",
                "missing": name,
                "meant": near or "",
            },
            loses_inertia=True,
        )
    if (stop := _stop_at_number(inertial, masses[0], ["value"])) is not None:
        stop.loses_inertia = True
        return stop
    if not tensors:
        return _Stop(
            part=inertial,
            at=inertial,
            message="an <inertial> has no <inertia>",
            hint="Add an <inertia> with the six attributes ixx, ixy, ixz, iyy, iyz and izz.",
            values={"tag": "inertial", "missing": "inertia"},
        )
    tensor = tensors[0]
    some = any(tensor.attributes.get(key, "").strip(" 0.+-") for key in MOMENTS)
    missing = [key for key in MOMENTS if key not in tensor.attributes]
    if missing:
        stated = {key: tensor.attributes.get(key, "0").strip() for key in MOMENTS}
        written = " ".join(f'{key}="{value}"' for key, value in stated.items())
        return _Stop(
            part=inertial,
            at=tensor,
            message=f"an <inertia> has no {enumerated(missing)}",
            instead=f"<inertia {written}/>",
            place="element",
            values={"tag": "inertia", "missing": tuple(missing)},
            loses_inertia=some,
        )
    if (stop := _stop_at_number(inertial, tensor, MOMENTS)) is not None:
        stop.loses_inertia = some
    return stop


def _stop_in_shape(part: Node, known: Mapping[str, Sequence[str]]) -> _Stop | None:
    geometries = _all(part, "geometry")[:1]
    shapes = geometries[0].children[:1] if geometries else []
    if not shapes:
        what = "an empty" if geometries else "no"
        return _Stop(
            part=part,
            at=part,
            message=f"a <{part.tag}> has {what} <geometry>",
            hint=f"Add <geometry> with one of: {', '.join(known)}.",
            values={"missing": "geometry", "left_out": part.tag},
        )
    shape = shapes[0]
    if shape.tag not in known:
        return _Stop(
            part=part,
            at=shape,
            message=f"a <geometry> begins with <{shape.tag}>",
            hint=_CAPSULE if shape.tag == "capsule" else f"Begin with one of: {enumerated(known)}.",
            values={"name": shape.tag},
        )
    return _stop_at_number(part, shape, known[shape.tag])


def _stop_at_number(part: Node, node: Node, attributes: Sequence[str]) -> _Stop | None:
    """Where a number is followed by white space."""
    for name in attributes:
        text = node.attributes.get(name, "")
        number = trimmed(text)
        if number is not None:
            return _Stop(
                part=part,
                at=node,
                message=f'{node.tag} {name} "{text[:_MOST_TEXT]}" ends with white space',
                instead=f'{name}="{number}"',
                place="attribute",
                mark=name,
                values={"name": f"{node.tag} {name}", "stated": text[:_MOST_TEXT]},
            )
    return None


def _all(node: Node, tag: str) -> list[Node]:
    return [child for child in node.children if child.tag == tag]
