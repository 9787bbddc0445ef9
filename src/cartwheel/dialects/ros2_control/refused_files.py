"""Files of ROS 2 parameters that are valid YAML, but that the parser of ROS 2 refuses.

Gazebo's plugin then starts no controller manager. Cartwheel reads such a file nevertheless. Source:
rcl_yaml_param_parser, gazebo_ros2_control and gz_ros2_control.
"""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Any

from cartwheel import yaml_text
from cartwheel.codes.devices import CONTROLLERS_FILE_UNREADABLE
from cartwheel.description.elements.xml import shown_path
from cartwheel.dialects.ros2_control.scalars import type_of
from cartwheel.errors import Diagnostic, Origin

_ROS2 = "ros__parameters"
_DOUBLES = frozenset({"integer", "double"})


def refused_file(path: Path) -> Diagnostic | None:
    """The first value for which ROS 2 refuses a whole file; None if there is none."""
    import yaml

    if path.suffix not in (".yaml", ".yml"):
        return None
    try:
        text = yaml_text.read(path)
        root = yaml.compose(text, Loader=yaml_text.loader())
    except (OSError, UnicodeDecodeError, yaml.YAMLError):
        return None
    found = next(_refused(root, root, set(), inside=False), None)
    if found is None:
        return None
    place, why, mended = found
    line, end = place.start_mark.line, place.end_mark
    instead = ""
    if mended and end.line == line:
        written = text.splitlines()[line]
        instead = f"{written[: place.start_mark.column]}{mended}{written[end.column :]}".strip()
    return CONTROLLERS_FILE_UNREADABLE.diagnostic(
        f"ROS 2 refuses the file because {why}, so no controller starts",
        severity="error",
        origin=Origin(file=shown_path(path), line=line + 1),
        values={"problem": why, "stops": True},
        instead=instead,
        place="line" if instead else "",
    )


def _refused(
    node: Any, place: Any, seen: set[int], *, inside: bool
) -> Iterator[tuple[Any, str, str]]:
    """The places that are refused, with the reasons, and what to write instead if it is known.

    Args:
        node: A part of the file.
        place: Where it is named: an alias has the line of its anchor.
        seen: The identities of the nodes that were visited. A node that is reached twice has an
            alias.
        inside: Whether it is below ``ros__parameters``.
    """
    if node is None:
        return
    if id(node) in seen:
        yield place, "it contains an alias, such as *name", ""
        return
    seen.add(id(node))
    if node.id == "scalar":
        if not inside:
            yield place, f"a value is not below {_ROS2}", ""
        elif node.style is None and not node.value:
            yield place, f'"{place.value}" has no value', ""
    elif node.id == "sequence":
        yield from _list(node, place, inside=inside)
        for each in node.value:
            if id(each) in seen:
                yield place, "it contains an alias, such as *name", ""
            seen.add(id(each))
    else:
        for key, value in node.value:
            below = inside or str(key.value).startswith(_ROS2)
            yield from _refused(value, key, seen, inside=below)


def _list(node: Any, place: Any, *, inside: bool) -> Iterator[tuple[Any, str, str]]:
    if not inside:
        yield place, f"a list is not below {_ROS2}", ""
        return
    if len(node.value) > 1 and any(each.id == "sequence" for each in node.value[:-1]):
        yield place, "a list contains lists", ""
    scalars = [each for each in node.value if each.id == "scalar"]
    types = {type_of(each): None for each in scalars}
    if len(types) < 2 or "" in types:
        return
    mended = ""
    if types.keys() <= _DOUBLES and len(scalars) == len(node.value):
        words = (
            f"{each.value}.0" if type_of(each) == "integer" else each.value for each in scalars
        )
        mended = f"[{', '.join(words)}]"
    kinds = " and ".join(f"{kind}s" for kind in sorted(types))
    yield node, f'the list "{getattr(place, "value", "")}" mixes {kinds}', mended
