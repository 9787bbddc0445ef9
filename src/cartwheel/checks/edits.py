"""The usual changes that findings suggest, as arguments of `Code.diagnostic`."""

from __future__ import annotations

from typing import TypedDict

from cartwheel.checks import nodes
from cartwheel.description.elements.node import Node
from cartwheel.description.model import Element, PluginTag
from cartwheel.errors import Origin, Place


class Edit(TypedDict):
    """A location, and what to write there instead."""

    origin: Origin
    instead: str
    place: Place
    mark: str


def text(element: Node | Element, new: str) -> Edit:
    """Replaces the text of an element without attributes."""
    return Edit(
        origin=element.origin,
        instead=nodes.written(element.tag, {}, new),
        place="element",
        mark=element.text.strip(),
    )


def attribute(
    element: Node | Element | PluginTag, name: str, new: str, *, mark: str | None = None
) -> Edit:
    """Replaces or adds an attribute; the caret points to it or to `mark`."""
    return Edit(
        origin=element.origin,
        instead=f'{name}="{new}"',
        place="attribute",
        mark=name if mark is None else mark,
    )


def whole(element: Node | Element, new: str, *, mark: str = "") -> Edit:
    """Replaces an element."""
    return Edit(origin=element.origin, instead=new, place="element", mark=mark)
