#!/usr/bin/env python3
"""Write the plugin reference from the plugins: an index, a page each, and message types.

    python tools/make_plugin_reference.py            # writes the pages
    python tools/make_plugin_reference.py --check    # exits with 1 if a page is out of date

The tags come from the parameter dataclasses. The topics come from a plugin that really runs, on a
small robot, with every switch on; this script knows no plugin by name.
"""

from __future__ import annotations

import argparse
import dataclasses
import inspect
import re
import sys
import typing
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from cartwheel.description.model import (
    CameraIntrinsics,
    Collision,
    Element,
    Inertial,
    Joint,
    Link,
    PluginTag,
    RobotDescription,
    Sensor,
    Sphere,
    WorldDescription,
)
from cartwheel.errors import Origin
from cartwheel.geometry import Pose
from cartwheel.plugins.base import Plugin
from cartwheel.plugins.catalogue import all_plugins
from cartwheel.session import Session

DOCS = Path(__file__).resolve().parent.parent / "docs"
INDEX, TOPICS, FOLDER = "plugins.md", "topics.md", "plugins"
HERE = Origin(file="<reference>")
MODEL, SENSOR = "my_robot", "my_sensor"
_NEEDED = {("joint", ""), ("body", "")}
"""Fields and their defaults, which say what to move or watch all the same."""
_MADE = "<!-- Written by tools/make_plugin_reference.py from the code: run `make docs`. -->"

INTRODUCTION = f"""\
# Plugins and sensors

{_MADE}

The plugins that Cartwheel supports, by the `filename` of their `<plugin>`, and the sensors that
work without a plugin. Each has a page with its tags, topics and services.

- A tag can have several spellings. If a plugin has more than one of them, the first one in the
  table is used. Unsupported tags are reported with file and line.
- `<robotNamespace>` (or `<ros><namespace>`) is put before every topic and service name that does
  not begin with `/`. `<ros><remapping>` renames topics and services.
- `<alwaysOn>` is accepted and has no effect: a plugin works whenever its topics have subscribers.
- The path before a file name is ignored. `lib` and `.so` are optional. `ignition-gazebo-` is read
  as `gz-sim-`.
- A plugin that is not listed here is reported when the robot is loaded, with what is missing
  without it.

Sensors written for new Gazebo need no `<plugin>`. They publish if the world or the model names
their system, such as `gz-sim-sensors-system`. Without a system they publish if they have a
`<topic>` or a `<gz_frame_id>`, or if only new Gazebo has their type.

Your own package can add plugins through the entry point group `cartwheel.plugins`. Each entry
names a subclass of `cartwheel.plugins.base.Plugin`. If a package cannot be loaded, robots that do
not use its plugins are not affected. The warning about an unsupported plugin gives the reason.

A plugin that raises an error while it runs is disabled: its topics and services end, its motors
brake and its forces stop. The error message names the plugin, its model and the place of its tag;
`--verbose` adds the traceback. The simulation continues, or ends if `--strict` is set.
"""


_TOPICS_INTRODUCTION = f"""\
# Topics and services by type

{_MADE}

The plugins and sensors that publish, subscribe to or serve each type. Their pages give the default
names. `cartwheel topic list -v` and `cartwheel service list` show the names in a running
simulation. Every simulation publishes `/clock`. [ROS 1](ros1.md) and [ROS 2](ros2.md) list the
services of the node.
"""

Interface = list[tuple[str, str, str]]
"""Role, name and type of topics and services."""


def main() -> int:
    """Writes or checks the pages; returns the exit status."""
    parser = argparse.ArgumentParser(description="Write the plugin reference from the plugins.")
    parser.add_argument("--check", action="store_true", help="write nothing; report stale pages")
    arguments = parser.parse_args()
    pages = reference()
    present = {INDEX, TOPICS, *(f"{FOLDER}/{path.name}" for path in (DOCS / FOLDER).glob("*.md"))}
    stale = sorted(present - pages.keys())
    for name, text in pages.items():
        path = DOCS / name
        if not path.is_file() or path.read_text() != text:
            stale.append(name)
    if arguments.check:
        if stale:
            print(f"run `make docs`: out of date are {', '.join(stale)}", file=sys.stderr)
        return bool(stale)
    (DOCS / FOLDER).mkdir(exist_ok=True)
    for name in stale:
        if name in pages:
            (DOCS / name).write_text(pages[name])
        else:
            (DOCS / name).unlink()
    return 0


def reference() -> dict[str, str]:
    """All pages: the text by the path below docs."""
    # Without those of packages that happen to be installed here.
    ours = [plugin for plugin in all_plugins() if plugin.__module__.startswith("cartwheel.")]
    interfaces = {plugin: _interface(plugin) for plugin in ours}
    pages = {f"{FOLDER}/{_slug(p)}.md": _page(p, interfaces[p]) for p in ours}
    assert len(pages) == len(ours), "two plugins have the same page"
    tables = [
        _index(
            "In a model", [p for p in ours if p.filenames and not p.for_sensor and not p.for_world]
        ),
        _index("In a sensor", [p for p in ours if p.filenames and p.for_sensor]),
        _index("In a world", [p for p in ours if p.filenames and p.for_world]),
        _index("Sensors without a plugin", [p for p in ours if not p.filenames]),
    ]
    return {INDEX: "\n".join([INTRODUCTION, *tables]), TOPICS: _topics(interfaces), **pages}


def _topics(interfaces: dict[type[Plugin[Any]], Interface]) -> str:
    lines = [_TOPICS_INTRODUCTION]
    sections = {
        "publishes": ("Published topics", "Plugins and sensors that publish it"),
        "subscribes": ("Subscribed topics", "Plugins that subscribe to it"),
        "serves": ("Services", "Plugins that serve it"),
    }
    for role, (heading, users) in sections.items():
        lines += [f"## {heading}", "", f"| Type | {users} |", "|---|---|"]
        links: dict[str, list[str]] = {}
        for plugin, rows in interfaces.items():
            link = f"[{_title(plugin)}]({FOLDER}/{_slug(plugin)}.md)"
            for kind in dict.fromkeys(kind for each, _, kind in rows if each == role):
                links.setdefault(kind, []).append(link)
        lines += [f"| `{kind}` | {', '.join(found)} |" for kind, found in sorted(links.items())]
        lines.append("")
    return "\n".join(lines)


def _index(heading: str, plugins: list[type[Plugin[Any]]]) -> str:
    rows = []
    for plugin in plugins:
        first, *others = plugin.filenames or plugin.serves
        names = [f"[`{first}`]({FOLDER}/{_slug(plugin)}.md)", *(f"`{name}`" for name in others)]
        summary = " ".join(_prose(plugin)[0].split()).split(". ")[0].rstrip(".")
        rows.append(f"| {'<br>'.join(names)} | {summary}. |".replace("..", "."))
    column = "File name" if plugins[0].filenames else "Sensor type"
    return "\n".join([f"## {heading}", "", f"| {column} | Purpose |", "|---|---|", *rows, ""])


def _page(plugin: type[Plugin[Any]], interface: Interface) -> str:
    lines = [f"# {_title(plugin)}", "", _MADE, "", *_prose(plugin), ""]
    if len(plugin.filenames) > 1:
        others = ", ".join(f"`{name}`" for name in plugin.filenames[1:])
        lines += [f"Other file names: {others}.", ""]
    if not plugin.filenames:
        kinds = ", ".join(f"`{kind}`" for kind in plugin.serves)
        lines += [f"For sensors of type {kinds} without a `<plugin>`.", ""]
    elif plugin.for_world:
        lines += ["Place it directly inside a `<world>`.", ""]
    elif plugin.for_sensor:
        lines += ["Place it inside a `<sensor>`.", ""]
    else:
        lines += ["Place it directly inside a `<gazebo>` of a URDF or a `<model>` of an SDF.", ""]
    fields = [_row(item, kind) for item, kind in _fields(plugin)]
    if fields:
        lines += ["## Tags", "", "| Tag | Value | Default | Meaning |"]
        lines += ["|---|---|---|---|", *fields, ""]
    if interface:
        lines += ["## Topics and services", ""]
        lines += ["With each boolean tag `true` and the other tags at their defaults.", ""]
        lines += ["| Name | Type | Role |", "|---|---|---|"]
        lines += [*(f"| `{name}` | `{kind}` | {role} |" for role, name, kind in interface), ""]
    return "\n".join([*lines, f"[All plugins and sensors](../{INDEX})", ""])


def _title(plugin: type[Plugin[Any]]) -> str:
    return plugin.filenames[0] if plugin.filenames else f"{plugin.serves[0]} sensor"


def _slug(plugin: type[Plugin[Any]]) -> str:
    return _title(plugin).removesuffix(".so").replace(" ", "-")


def _prose(plugin: type[Plugin[Any]]) -> list[str]:
    paragraphs = inspect.cleandoc(plugin.__doc__ or "").replace("``", "`").split("\n\n")
    return "\n\n".join(_markdown(" ".join(part.split())) for part in paragraphs).splitlines()


def _markdown(text: str) -> str:
    """Text in which a tag is code, so that no page takes it for HTML."""
    parts = text.split("`")
    parts[::2] = [re.sub(r"<[/\w][^<>]*>", r"`\g<0>`", part) for part in parts[::2]]
    return "`".join(parts)


def _fields(plugin: type[Plugin[Any]]) -> Iterator[tuple[dataclasses.Field[Any], Any]]:
    hints = typing.get_type_hints(plugin.parameters)
    for item in dataclasses.fields(plugin.parameters):
        yield item, hints[item.name]


def _row(item: dataclasses.Field[Any], kind: Any) -> str:
    names = "<br>".join(f"`{name}`" for name in item.metadata["tags"])
    value = _kind(kind)
    if item.metadata["unit"]:
        value = f"{value}, {item.metadata['unit']}"
    cells = [names, value, _default(item), _markdown(item.metadata["doc"])]
    return "| " + " | ".join(cell.replace("|", "\\|") for cell in cells) + " |"


def _kind(kind: Any) -> str:
    options = typing.get_args(kind)
    if typing.get_origin(kind) is typing.Literal:
        return " or ".join(f"`{option}`" for option in options)
    if type(None) in options:
        return _kind(next(option for option in options if option is not type(None)))
    if typing.get_origin(kind) is tuple:
        if options[-1] is Ellipsis:
            return "strings" if options[0] is str else "numbers"
        return f"{len(options)} numbers"
    names = {bool: "boolean", float: "number", int: "integer", str: "string"}
    return names.get(kind, getattr(kind, "__name__", str(kind)))


def _default(item: dataclasses.Field[Any]) -> str:
    value = item.default
    if value is dataclasses.MISSING:
        return "required"
    if value is None or value in ("", ()):
        return ""
    if isinstance(value, bool):
        return "`true`" if value else "`false`"
    if isinstance(value, tuple):
        return f"`{' '.join(p if isinstance(p, str) else f'{p:g}' for p in value)}`"
    return f"`{value:g}`" if isinstance(value, float) else f"`{value}`"


def _interface(plugin: type[Plugin[Any]]) -> Interface:
    """The topics and services of a plugin that runs."""
    session = Session(WorldDescription(name="reference"))
    before = {topic.name for topic in session.graph.topics()}
    if plugin.for_world:
        session.close()
        session = Session(WorldDescription(name="reference", plugins=(_tag(plugin),)))
    else:
        session.spawn(_robot(plugin))
    rows = []
    for topic in session.graph.topics():
        for role, nodes in (("publishes", topic.publishers), ("subscribes", topic.subscribers)):
            if nodes and topic.name not in before:
                rows.append((role, topic.name, _wire_type(topic.type)))
    rows += [
        ("serves", service.name, _wire_type(service.type)) for service in session.graph.services()
    ]
    session.close()
    return rows


def _wire_type(kind: str) -> str:
    """A type as ROS names it; here ROS 2's version of a package of ROS 1 has a suffix."""
    return kind.replace("_ros2/", "/")


def _tag(plugin: type[Plugin[Any]]) -> PluginTag:
    """The plugin's tag with every switch on, and what it cannot do without."""
    switches = [_element(item.metadata["tags"][0], text="true")
                for item, kind in _fields(plugin) if kind is bool]  # fmt: skip
    needed = [
        _element(
            item.metadata["tags"][0],
            text=_needed(item, kind),
        )
        for item, kind in _fields(plugin)
        # A joint to be measured has no default that a robot could have.
        if item.default is dataclasses.MISSING or (item.name, item.default) in _NEEDED
    ]
    element = _element("plugin", children=(*switches, *needed))
    return PluginTag(name="plugin", filename=_title(plugin), element=element, origin=HERE)


def _needed(item: dataclasses.Field[Any], kind: Any) -> str:
    """The content of a required tag."""
    if kind in (float, int):
        return "1"
    if typing.get_origin(kind) is typing.Literal:
        return str(typing.get_args(kind)[0])
    if "joint" in item.name:
        return "left_joint"
    return SENSOR if "sensor" in item.metadata["doc"] else "base_footprint"


def _robot(plugin: type[Plugin[Any]]) -> RobotDescription:
    """A robot on which any plugin finds what it needs under its default names."""
    tag = _tag(plugin)
    topic = () if plugin.filenames else (_element("topic", text="my_topic"),)
    sensor = Sensor(
        name=SENSOR,
        type=plugin.serves[0] if plugin.serves else "any",
        link="base_footprint",
        joint="left_joint",
        update_rate=10.0,
        cameras=(CameraIntrinsics(),),
        collisions=("base_footprint_collision",),
        plugins=(tag,) if plugin.for_sensor and plugin.filenames else (),
        element=_element("sensor", children=(*topic, _ray())),
        origin=HERE,
    )
    body = Collision(name="base_footprint_collision", shape=Sphere(radius=0.1), origin=HERE)
    mass = Inertial(mass=1.0, ixx=1.0, iyy=1.0, izz=1.0, origin=HERE)
    base = Link(
        name="base_footprint", inertial=mass, collisions=(body,), sensors=(sensor,), origin=HERE
    )
    links = [base]
    joints = []
    for name in _joint_names(plugin):
        # Where its name says, so that a drive finds its axles apart.
        x, y = (0.5 if "front" in name else -0.5), (0.5 if "left" in name else -0.5)
        wheel = Link(
            name=f"{name}_wheel",
            pose=Pose((x, y, 0.0)),
            inertial=mass,
            collisions=(dataclasses.replace(body, name=f"{name}_collision"),),
            origin=HERE,
        )
        links.append(wheel)
        joints.append(
            Joint(
                name=name,
                type="continuous",
                parent="base_footprint",
                child=wheel.name,
                origin=HERE,
            )
        )
    return RobotDescription(
        name=MODEL,
        links=tuple(links),
        joints=tuple(joints),
        plugins=() if plugin.for_sensor else (tag,),
        canonical_link="base_footprint",
        origin=HERE,
    )


def _joint_names(plugin: type[Plugin[Any]]) -> list[str]:
    """All joints that a plugin looks for by default, and the two wheels of any cart."""
    names = ["left_joint", "right_joint"]
    for item, _ in _fields(plugin):
        texts = item.default if isinstance(item.default, tuple) else (item.default,)
        names += [text for text in texts if isinstance(text, str) and text.endswith("_joint")]
    return list(dict.fromkeys(names))


def _ray() -> Element:
    """A scan of one ray, for the sensors that have one."""
    limits = (_element("min", text="0.1"), _element("max", text="10"))
    horizontal = _element("horizontal", children=(_element("samples", text="1"),))
    scan = _element("scan", children=(horizontal,))
    return _element("ray", children=(scan, _element("range", children=limits)))


def _element(tag: str, *, text: str = "", children: tuple[Element, ...] = ()) -> Element:
    return Element(tag=tag, text=text, children=children, origin=HERE)


if __name__ == "__main__":
    raise SystemExit(main())
