"""XML as a small read-only tree that knows its places and what was read of it.

Expat reads the text: its line is that of an element's first character, it fetches nothing,
and it is at hand without an import that a quick start would feel. Tags and attributes keep
their prefixes as written, as Gazebo's own reader does.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from pathlib import Path
from typing import Protocol
from xml.parsers import expat

from cartwheel.description import numbers
from cartwheel.description.model import Element
from cartwheel.errors import DescriptionError, Diagnostic, Origin
from cartwheel.geometry import Pose, Vec3

MAX_BYTES = 64 * 1024 * 1024
"""Larger than any description; a mesh or a bag given by mistake stops here."""
MAX_DEPTH = 100
"""Deeper nesting is damage, and would end in Python's own recursion limit."""


class Node:
    """One element: its parts, its place, and which of its parts a parser asked for.

    Reading a child or an attribute marks it; `unread` then lists what nobody understood.
    """

    __slots__ = (
        "_asked_attributes", "_asked_children", "_attributes", "_read", "children", "origin",
        "tag", "text",
    )  # fmt: skip

    def __init__(
        self,
        tag: str,
        attributes: Mapping[str, str],
        origin: Origin,
        children: Iterable[Node] = (),
        text: str = "",
    ) -> None:
        self.tag = tag
        self.text = text
        """The element's own text, without the white space around it."""
        self.origin = origin
        self.children: list[Node] = list(children)
        self._attributes = dict(attributes)
        self._read = False
        self._asked_attributes: set[str] = set()
        self._asked_children: set[str] = set()

    def __repr__(self) -> str:
        return f"<{self.tag}> at {self.origin}"

    @property
    def attributes(self) -> Mapping[str, str]:
        """All attributes; looking here marks none as read."""
        return self._attributes

    def fail(self, message: str, hint: str | None = None) -> DescriptionError:
        """An error at this place, to be raised by the caller."""
        return DescriptionError(message, origin=self.origin, hint=hint)

    # Children.

    def child(self, tag: str) -> Node | None:
        """The first child of that tag; further ones stay unread and are reported."""
        self._asked_children.add(tag)
        for child in self.children:
            if child.tag == tag:
                child._read = True
                return child
        return None

    def require_child(self, tag: str) -> Node:
        """The first child of that tag."""
        found = self.child(tag)
        if found is None:
            raise self.fail(f"{self._label()} has no <{tag}>", self._near_tag(tag))
        return found

    def all(self, tag: str) -> list[Node]:
        """All children of that tag."""
        self._asked_children.add(tag)
        found = [child for child in self.children if child.tag == tag]
        for child in found:
            child._read = True
        return found

    def find(self, path: str) -> Node | None:
        """The first descendant at a path such as ``image/width``."""
        node: Node | None = self
        for tag in path.split("/"):
            node = node.child(tag) if node is not None else None
        return node

    def drop(self, child: Node) -> None:
        """Takes a child out, so that no reader of this element meets it."""
        self.children.remove(child)

    def mark(self) -> Node:
        """Counts this element, its attributes and all below as read: it is passed on whole."""
        self._read = True
        self._asked_attributes.update(self._attributes)
        for child in self.children:
            child.mark()
        return self

    # Attributes.

    def get(self, name: str) -> str | None:
        """The value of an attribute."""
        self._asked_attributes.add(name)
        return self._attributes.get(name)

    def require(self, name: str) -> str:
        """The value of an attribute that must be there and not be empty."""
        value = self.get(name)
        if value is None:
            others = [a for a in self._attributes if a not in self._asked_attributes]
            hint = numbers.likely(name, others)
            raise self.fail(
                f'{self._label()} has no attribute "{name}"',
                f'Is "{hint}" meant for it?' if hint else None,
            )
        if not value.strip():
            raise self.fail(f'the attribute "{name}" of <{self.tag}> is empty')
        return value

    def number_of(
        self, name: str, default: float | None = None, *, infinite: bool = False
    ) -> float:
        """An attribute as a number; required without a default."""
        value = self.get(name) if default is not None else self.require(name)
        if value is None:
            assert default is not None
            return default
        return numbers.number(value, self._attribute_label(name), self.origin, infinite=infinite)

    def optional_number_of(self, name: str, *, infinite: bool = False) -> float | None:
        """An attribute as a number, None where it is not there."""
        value = self.get(name)
        if value is None:
            return None
        return numbers.number(value, self._attribute_label(name), self.origin, infinite=infinite)

    def vector_of(
        self, name: str, size: int, default: tuple[float, ...] | None = None
    ) -> tuple[float, ...]:
        """An attribute as `size` numbers with white space between; required without a default."""
        value = self.get(name) if default is not None else self.require(name)
        if value is None:
            assert default is not None
            return default
        return numbers.vector(value, size, self._attribute_label(name), self.origin)

    def vec3_of(self, name: str, default: Vec3 | None = None) -> Vec3:
        """An attribute as three numbers; required without a default."""
        x, y, z = self.vector_of(name, 3, default)
        return (x, y, z)

    def boolean_of(self, name: str, default: bool) -> bool:
        """An attribute as true, false, 1 or 0."""
        value = self.get(name)
        if value is None:
            return default
        return numbers.boolean(value, self._attribute_label(name), self.origin)

    # The element's own text.

    def number(self, *, infinite: bool = False) -> float:
        """The text as a number."""
        return numbers.number(self.text, self.tag, self.origin, infinite=infinite)

    def integer(self) -> int:
        """The text as a whole number."""
        return numbers.integer(self.text, self.tag, self.origin)

    def boolean(self) -> bool:
        """The text as true, false, 1 or 0."""
        return numbers.boolean(self.text, self.tag, self.origin)

    def vector(self, size: int) -> tuple[float, ...]:
        """The text as `size` numbers with white space between."""
        return numbers.vector(self.text, size, self.tag, self.origin)

    def vec3(self) -> Vec3:
        """The text as three numbers."""
        x, y, z = self.vector(3)
        return (x, y, z)

    def pose(self) -> Pose:
        """The text as ``x y z roll pitch yaw``, or empty for none."""
        if not self.text:
            return Pose()
        values = self.vector(6)
        return Pose.from_xyz_rpy(values[:3], values[3:])

    # The text of a descendant, by its path.

    def text_at(self, path: str, default: str = "") -> str:
        """The text at a path such as ``image/format``."""
        node = self.find(path)
        return node.text if node is not None else default

    def number_at(self, path: str, default: float, *, infinite: bool = False) -> float:
        """The number at a path."""
        node = self.find(path)
        return node.number(infinite=infinite) if node is not None else default

    def optional_number_at(self, path: str, *, infinite: bool = False) -> float | None:
        """The number at a path, None where there is no such element."""
        node = self.find(path)
        return node.number(infinite=infinite) if node is not None else None

    def integer_at(self, path: str, default: int) -> int:
        """The whole number at a path."""
        node = self.find(path)
        return node.integer() if node is not None else default

    def boolean_at(self, path: str, default: bool) -> bool:
        """The truth value at a path."""
        node = self.find(path)
        return node.boolean() if node is not None else default

    def vec3_at(self, path: str, default: Vec3) -> Vec3:
        """The three numbers at a path."""
        node = self.find(path)
        return node.vec3() if node is not None else default

    def pose_at(self, path: str) -> Pose:
        """The pose at a path, identity where there is none."""
        node = self.find(path)
        return node.pose() if node is not None else Pose()

    # What is told about it.

    def _label(self) -> str:
        name = self._attributes.get("name")
        return f'{self.tag} "{name}"' if name else f"<{self.tag}>"

    def _attribute_label(self, name: str) -> str:
        return self.tag if name == "value" else f"{self.tag} {name}"

    def _near_tag(self, tag: str) -> str | None:
        near = numbers.likely(tag, [child.tag for child in self.children])
        return f"Is <{near}> meant for it?" if near else None


def to_element(node: Node) -> Element:
    """The subtree as parameters for its owner, who reports what it does not know of them."""
    node.mark()
    return Element(
        tag=node.tag,
        text=node.text,
        attributes=tuple(node.attributes.items()),
        children=tuple(to_element(child) for child in node.children),
        origin=node.origin,
    )


def unread(node: Node) -> Iterator[Diagnostic]:
    """A warning for each part below `node` that no parser asked for."""
    for name in node.attributes:
        if name not in node._asked_attributes and not name.startswith("xmlns"):
            yield Diagnostic(
                severity="warning",
                message=f'the attribute "{name}" of <{node.tag}> is not understood and is ignored'
                + _meant(name, node._asked_attributes, '"{}"'),
                origin=node.origin,
            )
    for child in node.children:
        if child._read:
            yield from unread(child)
            continue
        if child.tag in node._asked_children:
            message = f"a further <{child.tag}> in <{node.tag}> is ignored: only the first counts"
        else:
            message = f"<{child.tag}> in <{node.tag}> is not understood and is ignored"
            message += _meant(child.tag, node._asked_children, "<{}>")
        yield Diagnostic(severity="warning", message=message, origin=child.origin)


def _meant(name: str, known: Iterable[str], form: str) -> str:
    near = numbers.likely(name, known)
    return f". Did you mean {form.format(near)}?" if near else ""


def shown_path(path: Path) -> str:
    """A path as users should see it: from the current folder where it lies in there."""
    try:
        return str(path.absolute().relative_to(Path.cwd()))
    except (ValueError, OSError):
        return str(path.absolute())


def read_bytes(path: Path) -> bytes:
    """A file's content; its absence, kind or size become a `DescriptionError`."""
    origin = Origin(file=shown_path(path))
    try:
        if path.is_dir():
            raise DescriptionError("is a folder, not a file", origin=origin)
        if path.exists() and not path.is_file():
            raise DescriptionError("is not a regular file", origin=origin)
        if path.stat().st_size > MAX_BYTES:
            raise DescriptionError("is too large for a description", origin=origin)
        content = path.read_bytes()
    except FileNotFoundError:
        raise DescriptionError("no such file", origin=origin, hint=near_files(path)) from None
    except (OSError, ValueError) as error:
        reason = error.strerror if isinstance(error, OSError) and error.strerror else str(error)
        raise DescriptionError(f"cannot be read: {reason}", origin=origin) from error
    if not content.strip():
        raise DescriptionError("the file is empty", origin=origin)
    if b"\0" in content[:1024] and not content.startswith((b"\xff\xfe", b"\xfe\xff")):
        raise DescriptionError(
            "is a binary file, not a description",
            origin=origin,
            hint="Expected is a xacro, URDF, SDF or world file, which is XML text.",
        )
    return content


def near_files(path: Path) -> str | None:
    """A sentence that names the file likely meant by a path that does not exist."""
    try:
        names = [entry.name for _, entry in zip(range(2000), path.parent.iterdir(), strict=False)]
    except OSError:
        return f'The folder "{path.parent}" does not exist either.'
    near = numbers.likely(path.name, names)
    if near:
        return f'Did you mean "{near}"?'
    return None


def read_file(path: Path) -> Node:
    """The tree of an XML file."""
    return parse(read_bytes(path), shown_path(path))


def parse(text: str | bytes, file: str = "<string>") -> Node:
    """The tree of an XML text.

    Args:
        text: The XML; bytes are decoded as their XML declaration says.
        file: What errors and origins call it.

    Raises:
        DescriptionError: Where the text is no well-formed XML, nested too deeply, or declares
            entities, which no robot needs and by which a small file grows without bound.
    """
    builder = _Builder(file)
    run_expat(text, file, builder)
    assert builder.root is not None
    return builder.root


def needs_xacro(root: Node) -> bool:
    """Whether a tree has xacro's elements, or expressions where it declares xacro's namespace."""
    declared = "xmlns:xacro" in root.attributes
    stack = [root]
    while stack:
        node = stack.pop()
        if node.tag.startswith("xacro:"):
            return True
        if declared and any("${" in v or "$(" in v for v in (*node.attributes.values(), node.text)):
            return True
        stack.extend(node.children)
    return False


class _Builder:
    """Makes Nodes of expat's events."""

    def __init__(self, file: str) -> None:
        self.file = file
        self.root: Node | None = None
        self._open: list[Node] = []
        self._texts: list[list[str]] = []

    def start(self, tag: str, attributes: dict[str, str], line: int) -> None:
        """An element begins."""
        node = Node(tag, attributes, Origin(file=self.file, line=line))
        if self._open:
            self._open[-1].children.append(node)
        else:
            self.root = node
        self._open.append(node)
        self._texts.append([])

    def end(self) -> None:
        """The innermost element ends."""
        self._open.pop().text = "".join(self._texts.pop()).strip()

    def data(self, text: str) -> None:
        """Text of the innermost element."""
        self._texts[-1].append(text)


class Handler(Protocol):
    """Takes what `run_expat` reads; xacro works on another kind of tree than the rest."""

    def start(self, tag: str, attributes: dict[str, str], line: int) -> None:
        """An element begins in that line."""

    def end(self) -> None:
        """The innermost element ends."""

    def data(self, text: str) -> None:
        """A piece of the innermost element's text."""


def run_expat(text: str | bytes, file: str, handler: Handler) -> None:
    """Reads XML and reports malformed text as a `DescriptionError` with its place."""
    parser = expat.ParserCreate()
    parser.buffer_text = True
    still_open: list[tuple[str, int]] = []

    def start(tag: str, attributes: dict[str, str]) -> None:
        line = parser.CurrentLineNumber
        if len(still_open) >= MAX_DEPTH:
            raise DescriptionError(
                f"elements are nested more than {MAX_DEPTH} deep",
                origin=Origin(file=file, line=line),
            )
        still_open.append((tag, line))
        handler.start(tag, attributes, line)

    def end(_tag: str) -> None:
        still_open.pop()
        handler.end()

    def entity(name: str, *_: object) -> None:
        raise DescriptionError(
            f'the entity "{name}" is declared; entities are not allowed in a description',
            origin=Origin(file=file, line=parser.CurrentLineNumber),
            hint="Use a xacro property instead.",
        )

    parser.StartElementHandler = start
    parser.EndElementHandler = end
    parser.CharacterDataHandler = handler.data
    parser.EntityDeclHandler = entity
    try:
        parser.Parse(text, True)
    except expat.ExpatError as error:
        reason, hint = _explain(error, still_open)
        raise DescriptionError(
            reason, origin=Origin(file=file, line=error.lineno), hint=hint
        ) from error
    except (ValueError, LookupError) as error:  # encodings that expat or Python do not know
        raise DescriptionError(
            f"the text cannot be decoded: {error}", origin=Origin(file=file, line=1)
        ) from error


def _explain(error: expat.ExpatError, still_open: list[tuple[str, int]]) -> tuple[str, str | None]:
    codes = expat.errors.codes
    text = expat.ErrorString(error.code) or "unknown error"
    column = error.offset + 1
    inner = f"<{still_open[-1][0]}> of line {still_open[-1][1]}" if still_open else ""
    if error.code == codes[expat.errors.XML_ERROR_TAG_MISMATCH]:
        return f"a closing tag that does not fit: {inner} is still open", None
    if error.code == codes[expat.errors.XML_ERROR_NO_ELEMENTS]:
        if inner:
            return f"the file ends while {inner} is still open", None
        return "is not XML: there is no element in it", None
    if error.code == codes[expat.errors.XML_ERROR_SYNTAX] and not still_open:
        return "is not XML", "A description begins with <robot> or <sdf>."
    if error.code in (
        codes[expat.errors.XML_ERROR_INVALID_TOKEN],
        codes[expat.errors.XML_ERROR_UNDEFINED_ENTITY],
    ):
        return (
            f"malformed XML at column {column}: {text}",
            "In text and attribute values, & is written &amp; and < is written &lt;.",
        )
    if error.code == codes[expat.errors.XML_ERROR_MISPLACED_XML_PI]:
        return "<?xml …?> must be the very first thing in the file", (
            "Delete what stands before it, blank lines included."
        )
    if error.code == codes[expat.errors.XML_ERROR_JUNK_AFTER_DOC_ELEMENT]:
        return "there is something after the end of the root element", None
    if error.code == codes[expat.errors.XML_ERROR_DUPLICATE_ATTRIBUTE]:
        return "an attribute is given twice in one element", None
    return f"malformed XML at column {column}: {text}", None
