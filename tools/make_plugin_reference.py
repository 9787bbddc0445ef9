#!/usr/bin/env python3
"""Write the plugin reference from the plugins: an index, a page each, and message types.

    python tools/make_plugin_reference.py            # writes the pages
    python tools/make_plugin_reference.py --check    # exits with 1 if a page is out of date

The tags come from the parameter dataclasses. The topics come from a plugin that really runs, on a
small robot, with every switch on; this script knows no plugin by name.
"""

from __future__ import annotations

import argparse
import contextlib
import dataclasses
import inspect
import re
import sys
import typing
from collections.abc import Iterable
from pathlib import Path
from typing import Any

from cartwheel.description.loading import load_text
from cartwheel.description.model import WorldDescription
from cartwheel.dialects.catalogue import all_plugins
from cartwheel.dialects.plugin import Plugin
from cartwheel.errors import CartwheelError
from cartwheel.session import Session
from plugin_examples import FILES, Interface, example, fields, picture, robot, slug, title, world

DOCS = Path(__file__).resolve().parent.parent / "docs"
INDEX, TOPICS, FOLDER, PICTURES = "plugins.md", "topics.md", "plugins", "images/plugins"
_MADE = "<!-- Written by tools/make_plugin_reference.py from the code: run `make docs`. -->"

INTRODUCTION = f"""\
# Plugins and sensors

{_MADE}

Cartwheel supports these plugins and sensors. Plugins are listed by the `filename` in their
`<plugin>` tag, and sensors that need no plugin by their type. The page of each plugin or sensor
describes its tags, topics and services. It also names the original plugin, which is the plugin for
Gazebo whose tags and topics Cartwheel supports. The following rules apply to all plugins:

- If a tag has several spellings and a `<plugin>` contains more than one of them, the spelling that
  is listed first on the page applies. If a tag is repeatable, the values of all spellings are
  combined.
- Unsupported tags are reported with file and line.
- The namespace in `<robotNamespace>` or `<ros><namespace>` is added in front of every topic and
  service name that does not begin with `/`. `<ros><remapping>` renames topics and services, as
  does `<ros><argument>~/out:=scan</argument>`, the form before `--ros-args`. The plugins of
  ros2_control do not read `<robotNamespace>`.
- In names such as `/model/<model>/cmd_vel`, the words `<model>`, `<world>`, `<link>`, `<joint>` and
  `<sensor>` stand for the names of these elements. A tag of the plugin, such as `<topic>`, stands
  for its value.
- A plugin that publishes sensor data is active only while one of its topics has subscribers. A
  plugin that drives joints or applies forces is always active. `<alwaysOn>` has no effect.
- Folders in `filename` are ignored. The prefix `lib` and the extension `.so` are optional. The
  prefix `ignition-gazebo-` has the same meaning as `gz-sim-`.
- A plugin that is not listed here has no effect, and is reported when the robot is loaded. If its
  name states its purpose, such as "lidar", the report contains the `<plugin>` to write instead.
"""

_SENSORS = """\
Sensors for gz-sim, the successor of Gazebo Classic, need no `<plugin>`. A sensor without a
`<plugin>` publishes messages if at least one of these conditions is met:

- The world or the model contains the matching system, such as `gz-sim-sensors-system`.
- The sensor contains `<topic>` or `<gz_frame_id>`.
- The sensor's type exists only in gz-sim.

gz-sim publishes a sensor only if the world or a model in it contains the system. `cartwheel check`
reports worlds of launch files without it (CW495).
"""

_AFTER = """\
## Errors

If a plugin raises an error while it runs, Cartwheel disables the plugin: it removes the plugin's
topics and services, brakes its motors and sets its forces to 0. The error message names the plugin,
its model, and the file and line of its tag. With `--verbose`, it also contains the traceback. With
`--strict`, the simulation stops; otherwise, it continues.

## Plugins in your own package

Your own Python package can add plugins with the entry point group `cartwheel.plugins`. Each entry
point refers to a subclass of `cartwheel.plugin.Plugin`; see
[Write a plugin](how-to/write-a-plugin.md#create-a-package). If a package cannot be loaded, only
robots that use its plugins are affected. For these robots, a warning reports that the plugin is not
supported, and the hint of the warning states why the package could not be loaded.
"""

_ROLES = {"publishes": "publishes", "subscribes": "subscribes", "serves": "provides"}
_TABLE = "The table lists the topics and services that the example above creates"
_TABLE_SWITCHED = f"{_TABLE} if every boolean tag is set to `true`"


_TOPICS_INTRODUCTION = f"""\
# Topics and services by type

{_MADE}

These tables list the plugins and sensors that publish or subscribe to messages of each type, and
the plugins that provide services of each type. The page of a plugin or sensor lists the default
names of its topics and services. `cartwheel topic list -v` and `cartwheel service list` list the
names in a running simulation. Every simulation publishes `/clock`. [ROS 1](ros1.md) and
[ROS 2](ros2.md) list the services that Cartwheel provides independently of plugins.
"""


def main() -> int:
    """Writes or checks the pages; returns the exit status."""
    parser = argparse.ArgumentParser(description="Write the plugin reference from the plugins.")
    parser.add_argument("--check", action="store_true", help="write nothing; report stale pages")
    arguments = parser.parse_args()
    pages = reference()
    present = {INDEX, TOPICS}
    for folder, suffix in ((FOLDER, "md"), (PICTURES, "svg")):
        present |= {f"{folder}/{path.name}" for path in (DOCS / folder).glob(f"*.{suffix}")}
    stale = sorted(present - pages.keys())
    for name, text in pages.items():
        path = DOCS / name
        if not path.is_file() or path.read_text() != text:
            stale.append(name)
    if arguments.check:
        if stale:
            print(f"run `make docs`: out of date are {', '.join(stale)}", file=sys.stderr)
        return bool(stale)
    for folder in (FOLDER, PICTURES):
        (DOCS / folder).mkdir(exist_ok=True)
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
    interfaces = {}
    for plugin in ours:
        try:
            interfaces[plugin] = _interface(plugin)
        except CartwheelError as error:
            raise SystemExit(
                f"{title(plugin)}: its example does not load: {error}\n"
                f"Write an example: {FILES.relative_to(DOCS.parent)}/{slug(plugin)}.xml"
            ) from error
    links = {title(p): f"{slug(p)}.md" for p in ours}
    pages = {f"{FOLDER}/{slug(p)}.md": _page(p, interfaces[p], links) for p in ours}
    assert len(pages) == len(ours), "two plugins have the same page"
    pictures = {_picture_name(p): picture(title(p), interfaces[p]) for p in ours if interfaces[p]}
    tables = [
        _index(
            "Model plugins",
            [p for p in ours if p.filenames and not p.for_sensor and not p.for_world],
        ),
        _index("Sensor plugins", [p for p in ours if p.filenames and p.for_sensor]),
        _index("World plugins", [p for p in ours if p.filenames and p.for_world]),
        _index("Sensors without a plugin", [p for p in ours if not p.filenames], _SENSORS),
    ]
    return {
        INDEX: "\n".join([INTRODUCTION, *tables, _AFTER]),
        TOPICS: _topics(interfaces),
        **pages,
        **pictures,
    }


def _topics(interfaces: dict[type[Plugin[Any]], Interface]) -> str:
    lines = [_TOPICS_INTRODUCTION]
    sections = {
        "publishes": ("Published topics", "Published by"),
        "subscribes": ("Subscribed topics", "Subscribed to by"),
        "serves": ("Services", "Provided by"),
    }
    for role, (heading, users) in sections.items():
        lines += [f"## {heading}", "", f"| Type | {users} |", "|---|---|"]
        links: dict[str, list[str]] = {}
        for plugin, rows in interfaces.items():
            link = f"[{title(plugin)}]({FOLDER}/{slug(plugin)}.md)"
            for kind in dict.fromkeys(kind for each, _, kind in rows if each == role):
                links.setdefault(kind, []).append(link)
        lines += [f"| `{kind}` | {', '.join(pages)} |" for kind, pages in sorted(links.items())]
        lines.append("")
    return "\n".join(lines)


def _index(heading: str, plugins: list[type[Plugin[Any]]], before: str = "") -> str:
    rows = []
    for plugin in plugins:
        first, *others = plugin.filenames or plugin.serves
        names = [f"[`{first}`]({FOLDER}/{slug(plugin)}.md)", *(f"`{name}`" for name in others)]
        summary = " ".join(_prose(plugin)[0].split()).split(". ")[0].rstrip(".")
        rows.append(f"| {'<br>'.join(names)} | {summary}. |".replace("..", "."))
    column = "File name" if plugins[0].filenames else "Sensor type"
    lines = [f"## {heading}", "", *([before] if before else [])]
    return "\n".join([*lines, f"| {column} | Purpose |", "|---|---|", *rows, ""])


def _page(plugin: type[Plugin[Any]], interface: Interface, links: dict[str, str]) -> str:
    others = {name: page for name, page in links.items() if name != title(plugin)}
    lines = [f"# {title(plugin)}", "", _MADE, ""]
    lines += [*(_linked(line, others) for line in _prose(plugin)), ""]
    if len(plugin.filenames) > 1:
        lines += [f"Other file names: {_listed(plugin.filenames[1:], 'and')}.", ""]
    if not plugin.filenames:
        kinds = _listed(plugin.serves, "or")
        lines += [f"Applies to sensors of type {kinds} that have no `<plugin>`.", ""]
    elif plugin.for_world:
        lines += ["Place the `<plugin>` directly inside a `<world>`.", ""]
    elif plugin.for_sensor:
        lines += ["Place the `<plugin>` inside a `<sensor>`.", ""]
    else:
        lines += ["Place the `<plugin>` directly inside `<gazebo>` (URDF) or `<model>` (SDF).", ""]
    lines += ["## Example", "", "```xml", example(plugin).rstrip(), "```", ""]
    rows = [_linked(_row(item, kind), others) for item, kind in fields(plugin)]
    if rows:
        lines += ["## Tags", "", "| Tag | Value | Default | Meaning |"]
        lines += ["|---|---|---|---|", *rows, ""]
    if interface:
        lines += ["## Topics and services", ""]
        lines += [f"![Topics and services: {title(plugin)}](../{_picture_name(plugin)})", ""]
        switched = any(kind is bool for _, kind in fields(plugin))
        lines += [f"{_TABLE_SWITCHED if switched else _TABLE}.", ""]
        lines += ["| Name | Type | Role |", "|---|---|---|"]
        lines += [*(f"| `{name}` | `{kind}` | {_ROLES[role]} |" for role, name, kind in interface)]
        lines += [""]
    return "\n".join([*lines, f"[All plugins and sensors](../{INDEX})", ""])


def _picture_name(plugin: type[Plugin[Any]]) -> str:
    return f"{PICTURES}/{slug(plugin)}.svg"


def _prose(plugin: type[Plugin[Any]]) -> list[str]:
    paragraphs = inspect.cleandoc(plugin.__doc__ or "").replace("``", "`").split("\n\n")
    text = "\n\n".join(_markdown(" ".join(part.split())) for part in paragraphs)
    return re.sub(r" (?=Original (?:plugin|package|sensor)s?: )", "\n\n", text).splitlines()


def _markdown(text: str) -> str:
    """Text in which a tag is code, so that no page takes it for HTML."""
    parts = text.split("`")
    parts[::2] = [re.sub(r"<[/\w][^<>]*>", r"`\g<0>`", part) for part in parts[::2]]
    return "`".join(parts)


def _row(item: dataclasses.Field[Any], kind: Any) -> str:
    names = "<br>".join(f"`{name}`" for name in item.metadata["tags"])
    value = _kind(kind, nested=item.metadata["nested"])
    if item.metadata["unit"]:
        value = f"{value}, {item.metadata['unit']}"
    if Ellipsis in typing.get_args(kind):
        value = f"{value}, repeatable"
    meaning, stated = _meaning(item.metadata["doc"])
    default = _default(item)
    assert not (default and stated), f"two defaults of {item.metadata['tags'][0]}"
    cells = [names, value, default or _markdown(stated), _markdown(meaning)]
    return "| " + " | ".join(cell.replace("|", "\\|") for cell in cells) + " |"


def _meaning(doc: str) -> tuple[str, str]:
    """Splits the default that a description ends with from its other sentences."""
    meaning, _, stated = doc.partition(" Default: ")
    return meaning, stated.removesuffix(".")


def _listed(names: Iterable[Any], conjunction: str) -> str:
    *others, last = (f"`{name}`" for name in names)
    return f"{', '.join(others)} {conjunction} {last}" if others else last


def _linked(line: str, links: dict[str, str]) -> str:
    """A line in which the names of other plugins are links to their pages."""
    for name, page in links.items():
        line = line.replace(f"`{name}`", f"[`{name}`]({page})")
    return line


def _kind(kind: Any, *, nested: bool = False) -> str:
    if nested:
        return "nested tags"
    options = typing.get_args(kind)
    if typing.get_origin(kind) is typing.Literal:
        return _listed(options, "or")
    if type(None) in options:
        return _kind(next(option for option in options if option is not type(None)))
    if typing.get_origin(kind) is tuple:
        if options[-1] is Ellipsis:
            return _kind(options[0])
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


def load_example(plugin: type[Plugin[Any]], *, switches: bool = False) -> Session:
    """A simulation of the example on a plugin's page.

    Args:
        plugin: The plugin.
        switches: Sets each boolean tag to true.
    """
    text = example(plugin, switches=switches)
    whole = world(text) if plugin.for_world else robot(plugin, text)
    described = load_text(whole, package_path=[FILES])
    if isinstance(described, WorldDescription):
        return Session(described)
    session = Session(WorldDescription(name="reference"))
    session.spawn(described)
    return session


def _interface(plugin: type[Plugin[Any]]) -> Interface:
    """The topics and services of a plugin that runs."""
    with contextlib.closing(Session(WorldDescription(name="reference"))) as empty:
        before = {topic.name for topic in empty.graph.topics()}
    with contextlib.closing(load_example(plugin, switches=True)) as session:
        rows = [
            (role, topic.name, _wire_type(topic.type))
            for topic in session.graph.topics()
            for role, nodes in (("publishes", topic.publishers), ("subscribes", topic.subscribers))
            if nodes and topic.name not in before
        ]
        return rows + [
            ("serves", service.name, _wire_type(service.type))
            for service in session.graph.services()
        ]


def _wire_type(kind: str) -> str:
    """A type as ROS names it; here ROS 2's version of a package of ROS 1 has a suffix."""
    return kind.replace("_ros2/", "/")


if __name__ == "__main__":
    raise SystemExit(main())
