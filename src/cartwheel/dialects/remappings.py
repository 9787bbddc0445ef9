"""The names that a plugin's ``<ros>`` element replaces, as gazebo_ros passes them to ROS 2."""

from __future__ import annotations

import re
from collections.abc import Iterator

from cartwheel.description.model import Element, PluginTag

_RULE = re.compile(
    r"(?:(?P<node>\w+):(?!//))?(?:ros(?:topic|service)://)?(?P<old>[^:=]+):=(?P<new>\S+)"
)
_REMAP = ("-r", "--remap")


def remap_rules(tag: PluginTag) -> Iterator[tuple[str, str]]:
    """Names and their replacements, as in the tag, in the order in which ROS 2 applies them.

    An ``<argument>`` may be a rule without ``-r``: ROS 2 accepts this form, which is deprecated,
    outside of ``--ros-args``. ``__ns`` and ``__node`` stand for the namespace and the node.
    """
    ros = tag.element.find("ros")
    for text in _stated(ros) if ros is not None else ():
        rule = _RULE.fullmatch(text)
        if rule is not None and rule["node"] in (None, tag.name):
            yield rule["old"], rule["new"]


def _stated(ros: Element) -> Iterator[str]:
    inside, before = False, ""
    for each in ros.find_all("argument"):
        word = each.text.strip()
        if word in ("--ros-args", "--"):
            inside = word == "--ros-args"
        elif not inside or before in _REMAP:
            yield word
        before = word
    for each in ros.find_all("remapping"):
        yield each.text.strip()


def remappings(tag: PluginTag) -> dict[str, str]:
    """New names of topics and services by their names, which may be private; the first one counts.

    A new private name is in the namespace of the plugin's node.
    """
    found: dict[str, str] = {}
    for old, new in remap_rules(tag):
        if not old.startswith("__"):
            private = f"{tag.name}/{new.removeprefix('~/')}" if new.startswith("~/") else new
            found.setdefault(old.removeprefix("~/"), private)
    return found


def namespace_of(tag: PluginTag) -> str | None:
    """The namespace that the ``<ros>`` element states; None without one."""
    ros = tag.element.find("ros")
    ruled = next((new for old, new in remap_rules(tag) if old == "__ns"), None)
    stated = ros.find("namespace") if ros is not None else None
    return ruled or (stated.text.strip() if stated is not None else None)
