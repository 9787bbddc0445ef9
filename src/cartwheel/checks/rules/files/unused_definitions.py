"""Unused xacro definitions."""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path

from cartwheel.checks import nodes
from cartwheel.checks.rule import rule
from cartwheel.checks.subject import Subject
from cartwheel.codes import files as files_codes
from cartwheel.description.elements import xml
from cartwheel.description.elements.node import Node
from cartwheel.description.xacro.unprefixed import PREFIX
from cartwheel.errors import Diagnostic

_WORD = re.compile(r"[A-Za-z_]\w*")
_EXPRESSION = re.compile(r"\$\{([^}]*)\}|\$\(([^)]*)\)")
_PARAMETER = re.compile(r"\*{0,2}([A-Za-z_]\w*)(?=:?=|$)")
_SUFFIXES = (".xacro", ".urdf")
MAX_FILES = 200


@rule(files_codes.ARGUMENT_UNUSED)
def argument_unused(subject: Subject) -> Iterator[Diagnostic]:
    used = _uses(subject).words
    for node, name in _definitions(subject.written, "xacro:arg"):
        if _is_plain(name) and name not in used:
            yield files_codes.ARGUMENT_UNUSED.diagnostic(
                message=f'argument "{name}" is declared but never used',
                values={"name": name},
                origin=node.origin,
                mark=f'name="{name}"',
                hint=f"Use it as $(arg {name}), or remove it.",
            )


@rule(files_codes.PROPERTY_UNUSED)
def property_unused(subject: Subject) -> Iterator[Diagnostic]:
    used = _uses(subject).words
    for node, name in _definitions(_own_trees(subject), "xacro:property"):
        if _is_plain(name) and name not in used:
            yield files_codes.PROPERTY_UNUSED.diagnostic(
                message=f'property "{name}" is never used',
                values={"name": name},
                origin=node.origin,
                mark=f'name="{name}"',
                hint="Use the property wherever its value is repeated, or remove it.",
            )


@rule(files_codes.PROPERTY_OVERWRITTEN)
def property_twice(subject: Subject) -> Iterator[Diagnostic]:
    for tree in subject.written:
        for holder in nodes.walk(tree):
            waiting: dict[str, Node] = {}
            for node in holder.children:
                if node.tag != "xacro:property":
                    waiting.clear()  # The rest may use any name.
                    continue
                name, value = nodes.name_of(node), node.attributes.get("value")
                for used in _WORD.findall(value or node.attributes.get("default", "")):
                    waiting.pop(used, None)
                if name in waiting and value is not None:
                    first = waiting[name]
                    yield files_codes.PROPERTY_OVERWRITTEN.diagnostic(
                        message=f'property "{name}" is overwritten before its value '
                        f'"{first.attributes["value"]}" is used',
                        values={"name": name, "value": first.attributes["value"]},
                        origin=first.origin,
                        mark=f'name="{name}"',
                        hint=f"The next definition is at {node.origin}. Remove one of the two "
                        "definitions.",
                    )
                if value is not None and not node.children:
                    waiting[name] = node


@rule(files_codes.PARAMETER_UNUSED)
def parameter_unused(subject: Subject) -> Iterator[Diagnostic]:
    uses = _uses(subject)
    for node, macro in _definitions(_own_trees(subject), "xacro:macro"):
        if macro.removeprefix("xacro:") not in uses.calls:
            continue
        for word in node.attributes.get("params", "").split():
            name = _PARAMETER.match(word)
            # Macros called here see the parameters too, so any use counts.
            if name is not None and name[1] not in uses.words:
                yield files_codes.PARAMETER_UNUSED.diagnostic(
                    message=f'macro "{macro}" never uses its parameter "{name[1]}"',
                    values={"name": name[1], "macro": macro},
                    origin=node.origin,
                    mark="params",
                    hint=f"Use it as ${{{name[1]}}}, or remove it.",
                )


@rule(files_codes.MACRO_UNUSED)
def macro_unused(subject: Subject) -> Iterator[Diagnostic]:
    called = _uses(subject).calls
    for node, stated in _definitions(_own_trees(subject), "xacro:macro"):
        name = stated.removeprefix("xacro:")
        if name and name not in called:
            params = node.attributes.get("params", "").split()
            yield files_codes.MACRO_UNUSED.diagnostic(
                message=f'macro "{name}" is never called',
                values={"name": name},
                origin=node.origin,
                mark=f'name="{stated}"',
                hint=f"Call it, as in <xacro:{name}{' …' if params else ''}/>, or remove it.",
            )


def _definitions(trees: Iterable[Node], tag: str) -> Iterator[tuple[Node, str]]:
    """Yields the elements with a tag and their names."""
    for tree in trees:
        for node in nodes.walk(tree):
            if node.tag == tag:
                yield node, nodes.name_of(node)


def _is_plain(name: str) -> bool:
    """Whether a name is literal, without substitutions."""
    return bool(name) and "$" not in name


def _own_trees(subject: Subject) -> list[Node]:
    """Files that generate parts of the robot; a library may define more than one robot needs."""
    return [
        tree
        for tree in subject.written
        if any(node.tag in ("link", "joint", "gazebo") or _is_call(node) for node in tree.children)
    ]


@dataclass(frozen=True, slots=True)
class _Uses:
    """The names that a file uses."""

    words: frozenset[str]
    """Every word in every expression."""
    calls: frozenset[str]
    """Macros that may be called."""


def _uses(subject: Subject) -> _Uses:
    """Uses in all files of the robot's packages: a macro may be for another robot in a package."""
    folders = {_package(Path(file).absolute()) for file in subject.files}
    paths = dict.fromkeys(Path(file).absolute() for file in subject.files)
    for folder in sorted(folder for folder in folders if folder is not None):
        for suffix in _SUFFIXES:
            for _, path in zip(range(MAX_FILES), sorted(folder.rglob(f"*{suffix}")), strict=False):
                paths.setdefault(path)
    each = [_uses_of(path) for path in paths]
    return _Uses(
        words=frozenset().union(*(one.words for one in each)),
        calls=frozenset().union(*(one.calls for one in each)),
    )


def _uses_of(path: Path) -> _Uses:
    try:
        state = path.stat()
    except OSError:
        return _NOTHING
    return _uses_at(path, state.st_mtime_ns, state.st_size)


@lru_cache(maxsize=5000)
def _uses_at(path: Path, _modified: int, _size: int) -> _Uses:
    """Uses in one version of a file; cached because a package's robots share files."""
    tree = xml.readable_file(path)
    return _NOTHING if tree is None else _Uses(frozenset(_words(tree)), frozenset(_calls(tree)))


def _package(file: Path) -> Path | None:
    for folder in list(file.parents)[:4]:
        if (folder / "package.xml").is_file():
            return folder
    return None


def _words(tree: Node) -> set[str]:
    """Every word in every expression."""
    found: set[str] = set()
    for node in nodes.walk(tree):
        for text in (*node.attributes.values(), node.text):
            if "$" in text:
                for match in _EXPRESSION.finditer(text):
                    found.update(_WORD.findall(match[1] or match[2] or ""))
        tag = node.tag.removeprefix(PREFIX)
        if tag in ("if", "unless"):
            found.update(_WORD.findall(node.attributes.get("value", "")))
        elif tag == "insert_block":
            found.add(nodes.name_of(node))
        elif tag == "macro":
            # A default such as ^ or ^|0 uses the property with the same name.
            for word in node.attributes.get("params", "").split():
                name, separator, default = word.partition(":=")
                if separator and default.startswith("^"):
                    found.add(name.lstrip("*"))
                found.update(_WORD.findall(default))
    return found


def _calls(tree: Node) -> set[str]:
    found: set[str] = set()
    for node in nodes.walk(tree):
        if node.tag == "xacro:call":
            found.update(_WORD.findall(node.attributes.get("macro", "")))
        elif _is_call(node):
            found.add(node.tag.removeprefix(PREFIX).rpartition(".")[2])
        else:
            found.add(node.tag)  # a call without the xacro prefix
    return found


_NOTHING = _Uses(frozenset(), frozenset())
_OWN = frozenset(
    f"xacro:{name}"
    for name in ("include", "arg", "property", "macro", "if", "unless", "insert_block", "call",
                 "element", "attribute")
)  # fmt: skip


def _is_call(node: Node) -> bool:
    return node.tag.startswith("xacro:") and node.tag not in _OWN
