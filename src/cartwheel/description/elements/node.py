"""An element of a description: its contents, its location, and which parts were read."""

from __future__ import annotations

from collections.abc import Iterable, Mapping

from cartwheel.codes import tags as codes
from cartwheel.description.elements import numbers
from cartwheel.description.model import Element
from cartwheel.errors import Code, DescriptionError, Diagnostic, Origin, Value
from cartwheel.geometry import Pose, Vec3

_XACRO_TAGS = frozenset(
    {
        "arg", "attribute", "block", "call", "element", "else", "eval", "if", "include",
        "insert_block", "macro", "property", "unless",
    }
)  # fmt: skip
"""The elements of xacro itself, as opposed to calls of macros."""


class Node:
    """An element with its contents and location, which records the parts that were read.

    Reading a child or an attribute marks it; `unread` then lists the parts that no reader used.
    """

    __slots__ = (
        "_asked_attributes",
        "_asked_children",
        "_attributes",
        "_read",
        "children",
        "notes",
        "origin",
        "tag",
        "text",
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
        """The element's own text without surrounding white space."""
        self.origin = origin
        self.children: list[Node] = list(children)
        self._attributes = dict(attributes)
        self._read = False
        self._asked_attributes: set[str] = set()
        self._asked_children: set[str] = set()
        self.notes: tuple[Diagnostic, ...] = ()
        """Warnings of its reader, reported by `unread`."""

    def __repr__(self) -> str:
        return f"<{self.tag}> at {self.origin}"

    @property
    def attributes(self) -> Mapping[str, str]:
        """All attributes; none is marked as read."""
        return self._attributes

    def set_attributes(self, values: Mapping[str, str]) -> None:
        """Replaces all attributes."""
        self._attributes = dict(values)

    def fail(
        self,
        message: str,
        hint: str | None = None,
        *,
        code: Code = codes.VALUE_INVALID,
        values: Mapping[str, Value] | None = None,
    ) -> DescriptionError:
        """Creates an error at this location, for the caller to raise."""
        return DescriptionError(
            message,
            code=code,
            origin=self.origin,
            hint=hint,
            values={"tag": self.tag, **self.named, **(values or {})},
        )

    @property
    def named(self) -> dict[str, Value]:
        """The value ``element`` for diagnostics: the element's name, if it has one."""
        name = self._attributes.get("name")
        return {"element": name} if name else {}

    # Children.

    def child(self, tag: str) -> Node | None:
        """The first child with this tag; any others stay unread and are reported."""
        self._asked_children.add(tag)
        for child in self.children:
            if child.tag == tag:
                child._read = True
                return child
        return None

    def require_child(self, tag: str) -> Node:
        """The first child with this tag, which is required."""
        found = self.child(tag)
        if found is None:
            near = numbers.likely(tag, [child.tag for child in self.children])
            raise self.fail(
                f"{self._label()} has no <{tag}>",
                f"Is <{near}> a misspelling of <{tag}>?" if near else None,
                code=codes.TAG_MISSING,
                values={"missing": tag, "meant": near or ""},
            )
        return found

    def all(self, *tags: str) -> list[Node]:
        """All children with this tag, or with one of these tags."""
        self._asked_children.update(tags)
        found = [child for child in self.children if child.tag in tags]
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
        """Removes a child, so that no reader of this element finds it."""
        self.children.remove(child)

    def mark(self) -> Node:
        """Marks this element, its attributes and all descendants as read, because it is passed on
        whole.
        """
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
        """The value of an attribute that is required and must not be empty."""
        value = self.get(name)
        if value is None:
            others = [a for a in self._attributes if a not in self._asked_attributes]
            hint = numbers.likely(name, others)
            raise self.fail(
                f'{self._label()} has no attribute "{name}"',
                f'Is "{hint}" a misspelling of "{name}"?' if hint else None,
                code=codes.TAG_MISSING,
                values={"missing": name, "meant": hint or ""},
            )
        if not value.strip():
            raise self.fail(
                f'the attribute "{name}" of <{self.tag}> is empty',
                code=codes.TAG_MISSING,
                values={"missing": name},
            )
        return value

    def number_of(self, name: str, default: float | None = None) -> float:
        """An attribute as a number; required without a default."""
        value = self.get(name) if default is not None else self.require(name)
        if value is None:
            assert default is not None
            return default
        return numbers.number(value, self._attribute_label(name), self.origin)

    def optional_number_of(self, name: str, *, infinite: bool = False) -> float | None:
        """An attribute as a number, or None if it is missing."""
        value = self.get(name)
        if value is None:
            return None
        return numbers.number(value, self._attribute_label(name), self.origin, infinite=infinite)

    def vec3_of(self, name: str, default: Vec3 | None = None) -> Vec3:
        """An attribute as three numbers; required without a default."""
        value = self.get(name) if default is not None else self.require(name)
        if value is None:
            assert default is not None
            return default
        x, y, z = numbers.vector(value, 3, self._attribute_label(name), self.origin)
        return (x, y, z)

    def boolean_of(self, name: str) -> bool:
        """An attribute as true, false, 1 or 0; false if it is missing."""
        value = self.get(name)
        label = self._attribute_label(name)
        return value is not None and numbers.boolean(value, label, self.origin)

    # The element's own text.

    def number(self, *, infinite: bool = False) -> float:
        """The text as a number; text after it is ignored with a warning, as in Gazebo."""
        self.cut(1)
        return numbers.number(self.text, self.tag, self.origin, infinite=infinite)

    def integer(self) -> int:
        """The text as an integer; decimals or text after it are ignored with a warning."""
        self.cut(1)
        value = numbers.number(self.text, self.tag, self.origin)
        if value != int(value):
            self._shorten(str(int(value)))
        return int(value)

    def boolean(self) -> bool:
        """The text as true, false, 1 or 0."""
        return numbers.boolean(self.text, self.tag, self.origin)

    def vector(self, size: int) -> tuple[float, ...]:
        """The text as `size` numbers separated by white space; the rest is ignored with a warning,
        as in Gazebo.
        """
        self.cut(size)
        return numbers.vector(self.text, size, self.tag, self.origin)

    def vec3(self) -> Vec3:
        """The text as three numbers."""
        x, y, z = self.vector(3)
        return (x, y, z)

    def pose(self) -> Pose:
        """The text as ``x y z roll pitch yaw``; empty for identity."""
        if not self.text:
            return Pose()
        values = self.vector(6)
        place = numbers.position(values[:3], self.tag, self.origin)
        return Pose.from_xyz_rpy(place, values[3:])

    def cut(self, size: int) -> None:
        """Removes and reports what follows the first `size` numbers of the text."""
        self._keep(numbers.leading_words(self.text, 1) if size == 1 else None)
        self._keep(numbers.leading(self.text, size))

    def cut_words(self, size: int) -> None:
        """Removes and reports what follows the numbers with which the first `size` words begin."""
        self._keep(numbers.leading_words(self.text, size))

    def _keep(self, found: tuple[str, str] | None) -> None:
        if found is not None and found[1]:
            self._shorten(found[0])

    def _shorten(self, used: str) -> None:
        self.notes = (*self.notes, numbers.text_after(self.tag, self.text, used, self.origin))
        self.text = used

    # The text of a descendant, by its path.

    def text_at(self, path: str) -> str:
        """The text at a path such as ``image/format``; empty if there is none."""
        node = self.find(path)
        return node.text if node is not None else ""

    def number_at(self, path: str, default: float) -> float:
        """The number at a path."""
        node = self._filled(path)
        return node.number() if node is not None else default

    def optional_number_at(self, path: str, *, infinite: bool = False) -> float | None:
        """The number at a path, or None if the element is missing."""
        node = self._filled(path)
        return node.number(infinite=infinite) if node is not None else None

    def integer_at(self, path: str, default: int) -> int:
        """The integer at a path."""
        node = self._filled(path)
        return node.integer() if node is not None else default

    def boolean_at(self, path: str, default: bool) -> bool:
        """The boolean at a path."""
        node = self._filled(path)
        return node.boolean() if node is not None else default

    def vec3_at(self, path: str, default: Vec3) -> Vec3:
        """The three numbers at a path."""
        node = self._filled(path)
        return node.vec3() if node is not None else default

    def stated_booleans(self, names: Mapping[str, str]) -> dict[str, bool]:
        """The booleans at those of some paths that exist, each with the name of its path; the last
        one of a name counts.
        """
        found = ((name, self.find(path)) for path, name in names.items())
        return {name: node.boolean() for name, node in found if node is not None}

    def stated_numbers(self, names: Mapping[str, str]) -> dict[str, float]:
        """The numbers at those of some paths that exist; see `stated_booleans`."""
        found = ((name, self.optional_number_at(path)) for path, name in names.items())
        return {name: value for name, value in found if value is not None}

    def _filled(self, path: str) -> Node | None:
        """The descendant at a path if it is not empty: an empty element selects the default."""
        node = self.find(path)
        if node is None or node.text.strip() or node.children:
            return node
        empty = codes.TAG_EMPTY.diagnostic(
            f"<{node.tag}> is empty, so its default is used",
            origin=node.origin,
            values={"tag": node.tag},
        )
        node.notes = (*node.notes, empty)
        return None

    # Messages about it.

    def _label(self) -> str:
        name = self._attributes.get("name")
        return f'{self.tag} "{name}"' if name else f"<{self.tag}>"

    def _attribute_label(self, name: str) -> str:
        return self.tag if name == "value" else f"{self.tag} {name}"


def to_element(node: Node) -> Element:
    """The subtree as parameters for its plugin or sensor, which reports unknown ones."""
    node.mark()
    return copied(node)


def copied(node: Node) -> Element:
    """The subtree as written; no part is marked as read."""
    return Element(
        tag=node.tag,
        text=node.text,
        attributes=tuple(node.attributes.items()),
        children=tuple(copied(child) for child in node.children),
        origin=node.origin,
    )


def needs_xacro(root: Node) -> bool:
    """Whether a tree contains xacro elements, or expressions and a declaration of xacro's
    namespace.

    Only xacro expands ``$(find …)``, so launch files also use it for URDFs with that expression. In
    the ``<uri>`` of an SDF, it is resolved like any other file: a missing file only affects one
    model.

    A ``.urdf`` without expressions, in which only calls of macros are left that it neither defines
    nor includes, is the output of an old xacro, which left unknown macros as they are. ROS and
    Gazebo ignore these elements.
    """
    declared = "xmlns:xacro" in root.attributes
    file = root.origin.file.lower()
    expanded = root.tag == "robot" and file.endswith(".urdf") and not file.endswith(".xacro.urdf")
    calls = expressions = False
    stack = [root]
    while stack:
        node = stack.pop()
        stack.extend(node.children)
        if node.tag.startswith("xacro:"):
            if not expanded or node.tag.removeprefix("xacro:") in _XACRO_TAGS:
                return True
            calls = True
        words = (*node.attributes.values(), node.text)
        if any("${" in word or "$(" in word for word in words):
            if declared:
                return True
            expressions = True
        left = root.tag == "sdf" and node.tag == "uri"
        if not left and any("$(find " in word for word in words):
            return True
    return calls and expressions
