"""Examples of each plugin and sensor for its page: XML that loads without a warning, and a picture.

The example and the robot that carries it come from the tags that the plugin declares. This module
knows no plugin by name. Where an example needs more than tags with their defaults, it is a file
below `examples`.
"""

from __future__ import annotations

import dataclasses
import math
import re
import typing
from collections.abc import Iterator, Sequence
from html import escape
from pathlib import Path
from typing import Any

from cartwheel.dialects.plugin import Plugin
from cartwheel.dialects.tag_roles import WHEEL_ROLES

FILES = Path(__file__).parent / "examples"
"""Examples that are written by hand, and the package that they name."""
LINK, SENSOR = "base_footprint", "my_sensor"
_JOINTS = ("left_joint", "right_joint")
_MOST_DEFAULTS = 8
"""Optional tags in an example: pages of camera plugins have thirty."""
_REQUIRED = {("joint", ""), ("body", "")}
"""Fields with empty defaults that name what the plugin moves or measures."""

_RAYS = """\
  <scan>
    <horizontal>
      <samples>360</samples>
      <min_angle>-1.57</min_angle>
      <max_angle>1.57</max_angle>
    </horizontal>
  </scan>
  <range>
    <min>0.1</min>
    <max>10</max>
  </range>
"""
_CAMERA = """\
<camera>
  <horizontal_fov>1.39</horizontal_fov>
  <image>
    <width>640</width>
    <height>480</height>
  </image>
  <clip>
    <near>0.05</near>
    <far>20</far>
  </clip>
</camera>
"""
_CONTACT = f"<contact>\n  <collision>{LINK}_collision</collision>\n</contact>\n"
_BODIES = {
    "camera": _CAMERA,
    "depth": _CAMERA,
    "ray": f"<ray>\n{_RAYS}</ray>\n",
    "gpu_lidar": f"<lidar>\n{_RAYS}</lidar>\n",
    "contact": _CONTACT,
}
"""What a sensor of a type holds."""
_SIZES = {"separation": "0.4", "diameter": "0.2", "radius": "0.1"}
"""m: of the robot below, by a word in the name of a required tag."""
_VALUES = {"m": "0.05", "s": "0.5"}
"""Of other required tags, by their unit."""
_SENSOR_FIELD = re.compile(r"\b(ray|contact|imu|camera) sensor\b", re.IGNORECASE)
"""In the description of a tag that names a sensor: its type."""
_GAZEBO_SYSTEM = ("gz-sim-", "-system")

Interface = list[tuple[str, str, str]]
"""Role, name and type of topics and services."""


def fields(plugin: type[Plugin[Any]]) -> Iterator[tuple[dataclasses.Field[Any], Any]]:
    """The parameters of a plugin, each with its type."""
    hints = typing.get_type_hints(plugin.parameters)
    for item in dataclasses.fields(plugin.parameters):
        yield item, hints[item.name]


def title(plugin: type[Plugin[Any]]) -> str:
    """The heading of a plugin's page."""
    return plugin.filenames[0] if plugin.filenames else f"{plugin.serves[0]} sensor"


def slug(plugin: type[Plugin[Any]]) -> str:
    """The name of a plugin's page."""
    return title(plugin).removesuffix(".so").replace(" ", "-")


def example(plugin: type[Plugin[Any]], *, switches: bool = False) -> str:
    """XML that uses a plugin.

    Args:
        plugin: The plugin.
        switches: Sets each boolean tag to true and leaves out other optional tags.
    """
    tags = _tags(plugin, switches=switches)
    file = FILES / f"{slug(plugin)}.xml"
    if file.is_file():
        return _switched(file.read_text(), tags) if switches else file.read_text()
    if plugin.filenames:
        tags = _element("plugin", _plugin_name(plugin), tags)
    if plugin.for_world:
        return tags
    if not plugin.for_sensor:
        return _element("gazebo", "", tags)
    kind = plugin.serves[0] if plugin.serves else plugin.sensor_type
    topic = "" if plugin.filenames else "<topic>my_topic</topic>\n"
    body = topic + "<update_rate>10</update_rate>\n" + _BODIES.get(kind, "") + tags
    owner = _JOINTS[0] if kind == "force_torque" else LINK
    sensor = _element("sensor", f' name="{SENSOR}" type="{kind}"', body)
    return _element("gazebo", f' reference="{owner}"', sensor)


def robot(plugin: type[Plugin[Any]], inside: str) -> str:
    """A URDF in which a plugin finds the links and joints that its example names."""
    mass = (
        '<inertial><mass value="1"/><inertia ixx="0.01" ixy="0" ixz="0" iyy="0.01" iyz="0" '
        'izz="0.01"/></inertial>'
    )
    parts = [
        f'<link name="{LINK}">{mass}<collision name="{LINK}_collision">'
        '<geometry><sphere radius="0.1"/></geometry></collision></link>'
    ]
    wheels = _joint_names(plugin)
    rotors = sorted(set(re.findall(r"<jointName>(\w+)</jointName>", inside)) - set(wheels))
    for name in (*wheels, *rotors):
        axis = "0 0 1" if name in rotors else "0 1 0"
        # Where its name says, so that a drive measures its axles apart.
        x, y = (0.2 if "front" in name else -0.2), (0.2 if "left" in name else -0.2)
        parts.append(
            f'<link name="{name}_wheel">{mass}<collision><geometry><sphere radius="0.1"/>'
            f'</geometry></collision></link><joint name="{name}" type="continuous">'
            f'<parent link="{LINK}"/><child link="{name}_wheel"/><origin xyz="{x} {y} 0"/>'
            f'<axis xyz="{axis}"/></joint>'
        )
    for name in sorted(set(re.findall(r"<(?:link|\w+_track)>(\w+)</", inside)) - {LINK}):
        y = 0.2 if "left" in name else -0.2
        parts.append(
            f'<link name="{name}">{mass}</link><joint name="{name}_joint" type="fixed">'
            f'<parent link="{LINK}"/><child link="{name}"/><origin xyz="0 {y} 0"/></joint>'
        )
    parts += [
        _element(
            "gazebo",
            f' reference="{LINK}"',
            _element("sensor", f' name="my_{kind}_sensor" type="{kind}"', _BODIES.get(kind, "")),
        )
        for kind in sorted(set(re.findall(r">my_(\w+)_sensor<", inside)))
    ]
    return f'<robot name="my_robot">\n{"".join(parts)}\n{inside}</robot>\n'


def world(inside: str) -> str:
    """An SDF world that holds a plugin."""
    return f'<sdf version="1.7"><world name="my_world">\n{inside}</world></sdf>\n'


def _plugin_name(plugin: type[Plugin[Any]]) -> str:
    filename = plugin.filenames[0]
    name = filename.removeprefix("lib").removesuffix(".so").removeprefix("gazebo_ros_")
    start, end = _GAZEBO_SYSTEM
    if filename.startswith(start):
        # New Gazebo finds a system by its class.
        longest = max((each for each in plugin.filenames if each.startswith(start)), key=len)
        words = longest.removeprefix(start).removesuffix(end).split("-")
        name = "gz::sim::systems::" + "".join(map(str.capitalize, words))
    return f' name="{name}" filename="{filename}"'


def _switched(text: str, tags: str) -> str:
    """An example with tags added to its plugin, but for those that it contains."""
    new = "".join(
        line for line in tags.splitlines(keepends=True) if line.partition(">")[0] + ">" not in text
    )
    if "</plugin>\n" in text:
        head, _, tail = text.rpartition("</plugin>\n")
        return f"{head}{new}</plugin>\n{tail}"
    head, _, tail = text.rpartition("/>\n")
    return f"{head}>{new}</plugin>\n{tail}"


def _tags(plugin: type[Plugin[Any]], *, switches: bool) -> str:
    lines: dict[str, str] = {}
    optional = joints = 0
    for item, kind in fields(plugin):
        if item.default is dataclasses.MISSING or (item.name, item.default) in _REQUIRED:
            value = _required(item, kind)
            if value in _JOINTS:
                value = _JOINTS[joints % 2]
                joints += 1
        elif switches:
            value = "true" if kind is bool else ""
        else:
            value = _default(item.default)
            optional += bool(value)
            if optional > _MOST_DEFAULTS:
                value = ""
        if value:
            lines[item.metadata["tags"][0]] = escape(value, quote=False)
    return _nested(lines, plugin)


def _nested(lines: dict[str, str], plugin: type[Plugin[Any]]) -> str:
    """Tags as XML: `camera/triggered` is a tag in another, which a sensor's body has already."""
    plain = [_element(path, "", text) for path, text in lines.items() if "/" not in path]
    parents: dict[str, list[str]] = {}
    for path, text in lines.items():
        parent, _, name = path.partition("/")
        body = any(f"<{parent}>" in _BODIES.get(kind, "") for kind in plugin.serves)
        if name and "/" not in name and not body:
            parents.setdefault(parent, []).append(_element(name, "", text))
    return "".join([*plain, *(_element(tag, "", "".join(own)) for tag, own in parents.items())])


def _required(item: dataclasses.Field[Any], kind: Any) -> str:
    if kind in (float, int):
        size = next((each for word, each in _SIZES.items() if word in item.name), None)
        return size or _VALUES.get(item.metadata["unit"], "1")
    if typing.get_origin(kind) is typing.Literal:
        return str(typing.get_args(kind)[0])
    if "joint" in item.name:
        return _JOINTS[0]
    if "model" in item.name:
        return "other_model"
    sensor = _SENSOR_FIELD.search(item.metadata["doc"])
    return f"my_{sensor[1].lower()}_sensor" if sensor else LINK


def _default(value: Any) -> str:
    if value is None or isinstance(value, bool):
        return ""
    values = value if isinstance(value, tuple) else (value,)
    if math.inf in values:
        return ""
    return " ".join(f"{each:g}" if isinstance(each, float) else str(each) for each in values)


def _joint_names(plugin: type[Plugin[Any]]) -> list[str]:
    """All joints that a plugin looks for by default, and the two wheels of any cart."""
    names = list(_JOINTS)
    for item, _ in fields(plugin):
        texts = item.default if isinstance(item.default, tuple) else (item.default,)
        is_wheel = item.metadata["role"] in WHEEL_ROLES
        names += [
            text
            for text in texts
            if isinstance(text, str) and text and (is_wheel or text.endswith("_joint"))
        ]
    return list(dict.fromkeys(names))


def _element(tag: str, attributes: str, content: str) -> str:
    if not content:
        return f"<{tag}{attributes}/>\n"
    if not content.endswith("\n"):
        return f"<{tag}{attributes}>{content}</{tag}>\n"
    indented = "".join(f"  {line}\n" for line in content.splitlines())
    return f"<{tag}{attributes}>\n{indented}</{tag}>\n"


_WIDTH, _ROW, _MARGIN, _BOX = 920, 44, 16, 280
_STYLE = "font-family:system-ui,sans-serif;font-size:13px"


def picture(title: str, interface: Sequence[tuple[str, str, str]]) -> str:
    """An SVG of a plugin between the topics that it subscribes to and those that it publishes."""
    left = [(name, kind) for role, name, kind in interface if role == "subscribes"]
    right = [(name, kind) for role, name, kind in interface if role == "publishes"]
    below = [(name, kind) for role, name, kind in interface if role == "serves"]
    rows = max(len(left), len(right) + len(below), 1)
    height = rows * _ROW + 2 * _MARGIN
    middle = height / 2
    box = (_WIDTH - _BOX) / 2
    parts = [
        f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {_WIDTH} {height}" role="img" '
        f'aria-label="{escape(title)} with its topics and services" style="{_STYLE}">',
        '<defs><marker id="arrow" viewBox="0 0 8 8" refX="8" refY="4" markerWidth="8" '
        'markerHeight="8" orient="auto"><path d="M0 0 8 4 0 8z" fill="#666"/></marker></defs>',
        f'<rect width="{_WIDTH}" height="{height}" rx="8" fill="#fff"/>',
    ]
    for index, (name, kind) in enumerate(left):
        y = _place(index, len(left), height)
        parts.append(_label(_MARGIN, y, name, kind, "#e3f0fb"))
        parts.append(_arrow(_MARGIN + 270, y, box, middle))
    for index, (name, kind) in enumerate([*right, *below]):
        y = _place(index, len(right) + len(below), height)
        is_service = index >= len(right)
        parts.append(
            _label(_WIDTH - _MARGIN - 270, y, name, kind, "#fdebd8" if is_service else "#e4f4e4")
        )
        parts.append(_arrow(box + _BOX, middle, _WIDTH - _MARGIN - 270, y, dashed=is_service))
    parts.append(
        f'<rect x="{box:g}" y="{middle - 20:g}" width="{_BOX}" height="40" rx="6" fill="#333"/>'
        f'<text x="{_WIDTH / 2:g}" y="{middle + 4:g}" fill="#fff" text-anchor="middle" '
        f"{_fit(title, _BOX - 20)}>{escape(title)}</text></svg>\n"
    )
    return "\n".join(parts)


def _place(index: int, count: int, height: float) -> float:
    return height / 2 + (index - (count - 1) / 2) * _ROW


def _label(x: float, y: float, name: str, kind: str, fill: str) -> str:
    return (
        f'<rect x="{x:g}" y="{y - 19:g}" width="270" height="38" rx="6" fill="{fill}"/>'
        f'<text x="{x + 135:g}" y="{y - 3:g}" text-anchor="middle" fill="#111" '
        f"{_fit(name, 254)}>{escape(name)}</text>"
        f'<text x="{x + 135:g}" y="{y + 13:g}" text-anchor="middle" fill="#555" '
        f'style="font-size:11px">{escape(kind)}</text>'
    )


def _arrow(x1: float, y1: float, x2: float, y2: float, *, dashed: bool = False) -> str:
    dash = ' stroke-dasharray="4 3"' if dashed else ""
    return (
        f'<line x1="{x1:g}" y1="{y1:g}" x2="{x2:g}" y2="{y2:g}" stroke="#666"{dash} '
        'marker-end="url(#arrow)"/>'
    )


def _fit(text: str, width: float) -> str:
    """Squeezes what would not fit, at some 7.6 pixels per character."""
    return (
        f'textLength="{width:g}" lengthAdjust="spacingAndGlyphs"' if len(text) * 7.6 > width else ""
    )
