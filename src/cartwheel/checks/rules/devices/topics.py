"""Names of topics and namespaces of plugins."""

from __future__ import annotations

import re
from collections.abc import Iterator

from cartwheel.checks import edits, plugin_tags
from cartwheel.checks.rule import rule
from cartwheel.checks.subject import Subject
from cartwheel.codes import devices as devices_codes
from cartwheel.description.model import Element, PluginTag
from cartwheel.errors import Diagnostic

_TOPIC_TAG = re.compile(
    r"(?i:topic(_?name)?$|^(robot)?_?namespace$|^camera_?name$|^service_?name$|^remapping$)"
)
_TOPIC = re.compile(r"[~/]{0,2}([A-Za-z_]\w*(/[A-Za-z_]\w*)*)?/*")
"""Topic names in both ROS versions, without substitutions; a trailing slash is harmless."""


@rule(devices_codes.DUPLICATE_TOPIC)
def topic_twice(subject: Subject) -> Iterator[Diagnostic]:
    for robot in subject.robots:
        seen: dict[str, PluginTag] = {}
        for tag, _ in robot.plugins():
            if not plugin_tags.is_simulated(tag):
                continue
            for role in plugin_tags.roles_with(tag.filename, "topic"):
                element = next((e for name in role.tags if (e := tag.element.find(name))), None)
                if element is None or not element.text.strip():
                    continue
                topic = _resolved(tag, element)
                if topic not in seen:
                    seen[topic] = tag
                    continue
                other = seen[topic]
                new = f"{element.text.strip()}_2"
                yield devices_codes.DUPLICATE_TOPIC.diagnostic(
                    message=f'the plugins "{other.name}" and "{tag.name}" both publish on '
                    f'"{topic}"',
                    values={"plugin": tag.name, "other": other.name, "topic": topic},
                    **edits.text(element, new),
                    hint=f"The other plugin is defined at {other.origin}.",
                )


@rule(devices_codes.TOPIC_INVALID)
def topic_invalid(subject: Subject) -> Iterator[Diagnostic]:
    for tag in (tag for robot in subject.robots for tag, _ in robot.plugins()):
        held = [*tag.element.children]
        if (ros := tag.element.find("ros")) is not None:
            held += ros.children
        for element in held:
            name = element.text.strip()
            if not _TOPIC_TAG.search(element.tag) or not name or element.children:
                continue
            source, arrow, target = name.rpartition(":=")
            if _TOPIC.fullmatch(target.strip()) and (not arrow or source.strip()):
                continue
            if "ros" not in tag.filename and not re.search(r"[\s@]", target.strip()):
                continue  # Gazebo's own transport accepts almost any name.
            good = re.sub(r"[^\w/~]+", "_", target.strip())
            good = re.sub(r"(^|/)(?=\d)", r"\1_", good)
            yield devices_codes.TOPIC_INVALID.diagnostic(
                message=f'<{element.tag}> "{name}" is not a valid ROS name',
                values={"tag": element.tag, "name": name},
                hint="Names may contain letters, digits, _ and /, and no part may begin with a "
                "digit.",
                **edits.text(element, f"{source}{arrow}{good}"),
            )


def _resolved(tag: PluginTag, element: Element) -> str:
    space = next(
        (e.text.strip() for path in ("ros/namespace", "robotNamespace")
         if (e := tag.element.find(path))),
        "",
    )  # fmt: skip
    name = element.text.strip()
    for role in plugin_tags.roles_with(tag.filename, "namespace"):
        camera = next((e for each in role.tags if (e := tag.element.find(each))), None)
        name = f"{camera.text.strip() if camera is not None else tag.name}/{name}"
    if name.startswith("/"):
        return name
    return "/" + "/".join(part.strip("/") for part in (space, name) if part.strip("/"))
