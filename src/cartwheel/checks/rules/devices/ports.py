"""Ports that plugins open for flight controllers."""

from __future__ import annotations

from collections.abc import Iterator

from cartwheel.checks import nodes, plugin_tags
from cartwheel.checks.rule import rule
from cartwheel.checks.subject import Subject
from cartwheel.codes import devices as devices_codes
from cartwheel.description.model import PluginTag
from cartwheel.dialects.catalogue import plugin_named
from cartwheel.errors import Diagnostic, Origin

_NEXT = 10
"""Distance of the ports of two vehicles, as in ArduPilot."""


@rule(devices_codes.PORT_USED_TWICE)
def port_twice(subject: Subject) -> Iterator[Diagnostic]:
    """Finds ports of one protocol that several plugins open, also in different models."""
    used: dict[tuple[str, int], PluginTag] = {}
    for robot in subject.robots:
        for tag, _ in robot.plugins():
            if plugin_named(tag.filename) is None:
                continue  # Only a known plugin opens a port, unlike gz-sim's imu and sensors.
            for role in plugin_tags.roles_with(tag.filename, "tcp_port", "udp_port"):
                element = next((e for name in role.tags if (e := tag.element.find(name))), None)
                text = element.text if element is not None else str(role.default[0])
                port = nodes.number(text)
                if port is None or port != int(port):
                    continue  # Another rule reports it.
                other = used.setdefault((role.role, int(port)), tag)
                if other is tag:
                    continue
                free = int(port)
                while (role.role, free) in used:
                    free += 1 if role.role == "tcp_port" else _NEXT
                used[role.role, free] = tag
                name = role.tags[0]
                origin: Origin = element.origin if element is not None else tag.origin
                yield devices_codes.PORT_USED_TWICE.diagnostic(
                    message=f'the plugins "{other.name}" and "{tag.name}" both open port {port:g}',
                    values={"plugin": tag.name, "other": other.name, "port": int(port)},
                    origin=origin,
                    instead=nodes.written(name, {}, str(free)),
                    place="element" if element is not None else "",
                    hint=f"The other plugin is defined at {other.origin}.",
                )
