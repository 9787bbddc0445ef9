"""Reports the elements and attributes that no reader has used."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping, Sequence

from cartwheel.codes import tags as codes
from cartwheel.description.elements import numbers
from cartwheel.description.elements.node import Node
from cartwheel.errors import Diagnostic, Origin, Value, enumerated

_ATTRIBUTE = re.compile(r"""(?<![\w:])(\w+)\s*=\s*("[^"]*"|'[^']*')""")
_LONGEST = 1000
"""Maximum number of characters of a text that are searched for attributes."""
_SHOWN = 3
"""Number of plugins that a message names."""
_VALUES = 32
"""Number of plugins, and of their tags, that a diagnostic lists for programs."""


def unread(
    node: Node, harmless: Mapping[tuple[str, str], str] | None = None
) -> Iterator[Diagnostic]:
    """A warning for each part below `node` that no reader used.

    Args:
        node: A root.
        harmless: Reasons for parts without an effect, by the element's tag and the child's tag, or
            the attribute's name after an ``@``: these are reported as info.
    """
    known = harmless or {}
    yield from node.notes
    for name, value in node.attributes.items():
        if name in node._asked_attributes or name.startswith("xmlns"):
            continue
        if not value.strip():
            continue  # Gazebo saves its worlds with <pose frame=''>, which has no meaning.
        if ":" in name:
            yield _foreign(name, node.origin)
            continue
        yield _ignored(
            f'attribute "{name}" of <{node.tag}>',
            node.origin,
            reason=known.get((node.tag, f"@{name}")),
            meant=numbers.likely(name, node._asked_attributes),
            form='"{}"',
            values={"tag": node.tag, "attribute": name},
        )
    yield from _attributes_in_text(node)
    for child in node.children:
        if child._read:
            yield from unread(child, harmless)
            continue
        if ":" in child.tag:
            yield _foreign(child.tag, child.origin)
            continue
        reason = known.get((node.tag, child.tag))
        values: dict[str, Value] = {"tag": child.tag, "parent": node.tag}
        if reason is None and child.tag in node._asked_children:
            yield codes.TAG_REPEATED.diagnostic(
                f"<{child.tag}> is repeated in <{node.tag}>, so only the first is used",
                origin=child.origin,
                values=values,
            )
            continue
        plugins = _plugins_in(child)
        if plugins:
            tags = dict.fromkeys(each.tag for plugin in plugins for each in plugin.children)
            values["plugins"] = tuple(_name_of(each) for each in plugins[:_VALUES])
            values["parameters"] = tuple(tags)[:_VALUES]
        yield _ignored(
            f"<{child.tag}> in <{node.tag}>",
            child.origin,
            reason=reason,
            meant=numbers.likely(child.tag, node._asked_children),
            form="<{}>",
            values=values,
            lost=_subject(plugins, whole=child.tag == "plugin"),
            beside=next((_name_of(each) for each in node.children if each.tag == "plugin"), ""),
        )


def _attributes_in_text(node: Node) -> Iterator[Diagnostic]:
    """A warning for attributes that are written behind a tag, as in ``<origin> xyz="0 0 1"``."""
    found = {
        name: value
        for name, value in _ATTRIBUTE.findall(node.text[:_LONGEST])
        if name in node._asked_attributes and name not in node.attributes
    }
    if found:
        written = " ".join(f"{name}={value}" for name, value in found.items())
        yield codes.TAG_IGNORED.diagnostic(
            f"the text of <{node.tag}> is ignored, although it contains attributes",
            origin=node.origin,
            hint=f"Write them in the tag: <{node.tag} {written}>.",
            values={"tag": node.tag, "text": written},
        )


def _plugins_in(node: Node) -> list[Node]:
    """The plugins in an element, or itself if it is one."""
    plugins, left = [], [node]
    while left:
        each = left.pop()
        left += reversed(each.children)
        if each.tag == "plugin":
            plugins.append(each)
    return plugins


def _name_of(plugin: Node) -> str:
    return plugin.attributes.get("filename") or plugin.attributes.get("name", "")


def _subject(plugins: Sequence[Node], *, whole: bool) -> str:
    """Plugins as the subject of a sentence; empty if there is none.

    Args:
        plugins: The plugins in an element, outermost first.
        whole: Whether the first one is the element itself.
    """
    if whole:
        return f'"{_name_of(plugins[0])}" is'
    names = [f'"{_name_of(each)}"' for each in plugins]
    if len(names) > _SHOWN:
        names = [*names[:_SHOWN], f"{len(names) - _SHOWN} more"]
    if len(names) < 2:
        return f"plugin {names[0]} in it is" if names else ""
    return f"plugins {enumerated(names)} in it are"


def _ignored(
    what: str,
    origin: Origin,
    *,
    reason: str | None,
    meant: str | None,
    form: str,
    values: Mapping[str, Value],
    lost: str = "",
    beside: str = "",
) -> Diagnostic:
    """The diagnostic for a part without effect.

    Args:
        what: The part.
        origin: Its place.
        reason: Why it has no effect; None if it is unknown.
        meant: The name that it should probably have.
        form: How this name is written.
        values: For programs.
        lost: Plugins in the part, with a verb.
        beside: A plugin in the same element, whose parameter the part may be meant to be.
    """
    if reason is not None:
        return codes.TAG_IGNORED.diagnostic(
            f"{what} has no effect: {reason}", origin=origin, severity="info", values=values
        )
    hint = f"Did you mean {form.format(meant)}?" if meant else ""
    if (values.get("tag"), values.get("parent")) in (("plugin", "robot"), ("plugin", "link")):
        hint = "Write it in a <gazebo> element."
    if not hint and beside and not lost:
        values = {**values, "beside": beside}
        hint = f'If it is a parameter of the plugin "{beside}", write it inside the <plugin>.'
    return codes.TAG_IGNORED.diagnostic(
        f"{what} is unknown and ignored" + (f", so {lost} not loaded" if lost else ""),
        origin=origin,
        hint=hint,
        values={**values, "meant": meant or ""},
    )


def _foreign(name: str, origin: Origin) -> Diagnostic:
    """Names with a prefix are left to other programs, as SDF specifies."""
    if name.startswith("xacro:"):
        return codes.TAG_IGNORED.diagnostic(
            f"<{name}> is ignored: the file does not define this macro, and Gazebo runs no xacro",
            origin=origin,
            hint="Define or include the macro in a .xacro file, or delete the element.",
            values={"tag": name, "meant": ""},
        )
    return codes.NOT_SIMULATED.diagnostic(
        f"{name} has no effect: names with a prefix are reserved for other programs",
        origin=origin,
        values={"tag": name},
    )
