"""The trees on which the xacro package works. Their elements keep file and line."""

from __future__ import annotations

import re
from itertools import pairwise
from typing import Any, Protocol
from xml.dom import minidom

from cartwheel.codes import files as codes
from cartwheel.description.elements.xml import Node
from cartwheel.errors import DescriptionError, Origin

_PART_SIZE = 200
"""Memory of an element, attribute or text, in characters."""
_NOT_XML = re.compile(r"[^\t\n\r\x20-\ud7ff\ue000-\ufffd\U00010000-\U0010ffff]")


class Copies(Protocol):
    """Counts the copies of elements that an expansion makes."""

    def copy_body(self, body: Element) -> Element:
        """Copies the body of a macro for the current call."""

    def count(self, copy: Element) -> None:
        """Counts the elements of a copy."""


class Document(minidom.Document):
    """The tree of a file."""

    def __init__(self, copies: Copies) -> None:
        super().__init__()
        self.copies = copies


class Element(minidom.Element):
    """An element with its origin, which copies keep."""

    origin: Origin

    def cloneNode(self, deep: bool) -> Element:  # noqa: N802, ARG002 (the DOM's signature)
        """Copies a macro's body for a call, or an inserted block."""
        if self.tagName == "xacro:macro" and isinstance(self.ownerDocument, Document):
            return self.ownerDocument.copies.copy_body(self)
        copy = clone(self, None)
        if isinstance(self.ownerDocument, Document):
            self.ownerDocument.copies.count(copy)
        return copy


class DomBuilder:
    """Builds the tree of a file from parser events; comments are ignored."""

    def __init__(self, file: str, copies: Copies) -> None:
        self.document = Document(copies)
        self._file = file
        self._open: list[Any] = [self.document]

    def start(self, tag: str, attributes: dict[str, str], line: int) -> None:
        element = Element(tag)
        element.ownerDocument = self.document
        element.origin = Origin(file=self._file, line=line)
        for name, value in attributes.items():
            _set(element, name, value)
        self._open[-1].appendChild(element)
        self._open.append(element)

    def end(self) -> None:
        self._open.pop()

    def data(self, text: str) -> None:
        self._open[-1].appendChild(self.document.createTextNode(text))


def _set(element: Element, name: str, value: str) -> None:
    """Sets an attribute. ``xacro:name`` and ``name`` are different attributes."""
    prefix, colon, _ = name.partition(":")
    if colon:
        # The prefix serves as the namespace, which is all that the DOM compares.
        element.setAttributeNS(prefix, name, value)
    else:
        element.setAttribute(name, value)


def clone(element: Any, stack: tuple[str, ...] | None) -> Element:
    """Copies an element and everything in it.

    Args:
        element: The element.
        stack: The macro calls that the copies get as part of their origin; None keeps the origins.
    """
    copy = Element(element.tagName)
    copy.ownerDocument = element.ownerDocument
    origin = element.origin
    copy.origin = (
        origin if stack is None else Origin(file=origin.file, line=origin.line, stack=stack)
    )
    for name, value in element.attributes.items():
        _set(copy, name, value)
    for child in element.childNodes:
        if isinstance(child, Element):
            copy.appendChild(clone(child, stack))
        else:
            copy.appendChild(element.ownerDocument.createTextNode(child.data))
    return copy


def size_of(element: Any) -> tuple[int, int, int]:
    """Returns the size of a tree.

    Returns:
        The number of elements; the number of all parts, including attributes and texts; and the
        number of characters, including those that stand for the memory of the parts.
    """
    elements, parts, characters, left = 0, 0, 0, [element]
    while left:
        each = left.pop()
        parts += 1
        if isinstance(each, Element):
            elements += 1
            parts += each.attributes.length
            characters += sum(len(value) for _, value in each.attributes.items())
            left.extend(each.childNodes)
        else:
            characters += len(each.data)
    return elements, parts, characters + _PART_SIZE * parts


def to_node(element: Any) -> Node:
    """Converts an expanded tree.

    Raises:
        DescriptionError: A text contains a character that XML does not allow.
    """
    children, texts = [], []
    for child in element.childNodes:
        if isinstance(child, Element):
            children.append(to_node(child))
        else:
            texts.append(child.data)
    # <xacro:attribute> can set a number.
    values = {name: str(value) for name, value in element.attributes.items()}
    text = "".join(texts).strip()
    for each in (*values, *values.values(), text):
        if found := _NOT_XML.search(each):
            raise DescriptionError(
                f"the expanded text contains the character {found[0]!a}, which XML does not allow",
                code=codes.XACRO_INVALID,
                values={"character": f"U+{ord(found[0]):04X}"},
                origin=element.origin,
            )
    return Node(element.tagName, values, element.origin, children, text)


def replace_node(node: Any, by: Any, content_only: bool = False) -> None:
    """Replaces a node by elements, or by their contents.

    xacro's own function moves them one by one, and each move takes a time proportional to the
    number of siblings.
    """
    parent = node.parentNode
    new: list[Any] = []
    for source in by if isinstance(by, list) else [by] if by is not None else []:
        if content_only:
            new.extend(source.childNodes)
            del source.childNodes[:]
        else:
            if source.parentNode is not None:
                source.parentNode.removeChild(source)
            new.append(source)
    index = parent.childNodes.index(node)
    parent.childNodes[index : index + 1] = new
    ends = [node.previousSibling, *new, node.nextSibling]
    for before, after in pairwise(ends):
        if before is not None:
            before.nextSibling = after
        if after is not None:
            after.previousSibling = before
    for child in new:
        child.parentNode = parent
    node.parentNode = node.previousSibling = node.nextSibling = None
