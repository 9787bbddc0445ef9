"""Reads an element tree without marking any element as used."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping

from cartwheel.description.elements.node import Node
from cartwheel.errors import Origin


def child(node: Node | None, tag: str) -> Node | None:
    """The first child with this tag."""
    if node is None:
        return None
    return next((each for each in node.children if each.tag == tag), None)


def children(node: Node | None, tag: str) -> list[Node]:
    """All children with this tag."""
    return [] if node is None else [each for each in node.children if each.tag == tag]


def walk(node: Node) -> Iterator[Node]:
    """An element and all its descendants, in file order."""
    stack = [node]
    while stack:
        found = stack.pop()
        yield found
        stack.extend(reversed(found.children))


def copy(node: Node) -> Node:
    """A copy of a tree; the origins are shared."""
    made = Node(node.tag, node.attributes, node.origin, map(copy, node.children), node.text)
    made.notes = node.notes
    return made


def name_of(node: Node) -> str:
    """The ``name`` attribute, or an empty string."""
    return node.attributes.get("name", "").strip()


def text_of(node: Node | None, attribute: str) -> str:
    """An attribute without surrounding white space, or an empty string."""
    return "" if node is None else node.attributes.get(attribute, "").strip()


def number(text: str | None) -> float | None:
    """The text as a finite number, otherwise None."""
    try:
        value = float(text or "")
    except ValueError:
        return None
    return value if math.isfinite(value) else None


def numbers(text: str | None, size: int) -> tuple[float, ...] | None:
    """Exactly `size` finite numbers, otherwise None."""
    values = [number(word) for word in (text or "").split()]
    found = tuple(value for value in values if value is not None)
    return found if len(found) == len(values) == size else None


def at(root: Node | None, origin: Origin) -> Node | None:
    """The element with exactly this origin."""
    if root is None:
        return None
    return next((node for node in walk(root) if node.origin is origin), None)


def parent_of(root: Node, wanted: Node) -> Node | None:
    """The parent of an element."""
    return next((node for node in walk(root) if any(c is wanted for c in node.children)), None)


def written(tag: str, attributes: Mapping[str, str], text: str = "") -> str:
    """XML text of an element without children."""
    inner = "".join(f' {name}="{value}"' for name, value in attributes.items())
    return f"<{tag}{inner}>{text}</{tag}>" if text else f"<{tag}{inner}/>"


def changed(node: Node, **values: str) -> str:
    """XML text of an element without its children, with some attributes changed."""
    return written(node.tag, {**node.attributes, **values})


def short(value: float) -> str:
    """A number with as many digits as a description needs."""
    return f"{value:.6g}"
