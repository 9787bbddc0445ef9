"""Looks into a tree of elements without counting anything in it as read."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping

from cartwheel.description.node import Node
from cartwheel.errors import Origin


def child(node: Node | None, tag: str) -> Node | None:
    """The first child of that tag."""
    if node is None:
        return None
    return next((each for each in node.children if each.tag == tag), None)


def children(node: Node | None, tag: str) -> list[Node]:
    """All children of that tag."""
    return [] if node is None else [each for each in node.children if each.tag == tag]


def walk(node: Node) -> Iterator[Node]:
    """The element and all below it, in the file's order."""
    stack = [node]
    while stack:
        found = stack.pop()
        yield found
        stack.extend(reversed(found.children))


def copy(node: Node) -> Node:
    """A tree of its own; its origins are the same objects."""
    return Node(node.tag, node.attributes, node.origin, map(copy, node.children), node.text)


def name_of(node: Node) -> str:
    """The name, empty where there is none."""
    return node.attributes.get("name", "").strip()


def text_of(node: Node | None, attribute: str) -> str:
    """An attribute without the white space around it, empty where there is none."""
    return "" if node is None else node.attributes.get(attribute, "").strip()


def number(text: str | None) -> float | None:
    """A finite number, None for all else."""
    try:
        value = float(text or "")
    except ValueError:
        return None
    return value if math.isfinite(value) else None


def numbers(text: str | None, size: int) -> tuple[float, ...] | None:
    """`size` finite numbers, None for all else."""
    values = [number(word) for word in (text or "").split()]
    found = tuple(value for value in values if value is not None)
    return found if len(found) == len(values) == size else None


def at(root: Node | None, origin: Origin) -> Node | None:
    """The element of that very place."""
    if root is None:
        return None
    return next((node for node in walk(root) if node.origin is origin), None)


def parent_of(root: Node, wanted: Node) -> Node | None:
    """The element that holds another."""
    return next((node for node in walk(root) if any(c is wanted for c in node.children)), None)


def written(tag: str, attributes: Mapping[str, str], text: str = "") -> str:
    """An element without children as text."""
    inner = "".join(f' {name}="{value}"' for name, value in attributes.items())
    return f"<{tag}{inner}>{text}</{tag}>" if text else f"<{tag}{inner}/>"


def changed(node: Node, **values: str) -> str:
    """An element without its children as text, some of its attributes changed."""
    return written(node.tag, {**node.attributes, **values})


def short(value: float) -> str:
    """A number in as many digits as a description needs."""
    return f"{value:.6g}"
