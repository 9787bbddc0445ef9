"""Whether gravity acts on the links of a URDF that Gazebo merges across fixed joints."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace

from cartwheel.codes import devices
from cartwheel.description.model import Link
from cartwheel.description.urdf.tree import Tree
from cartwheel.errors import Diagnostic, Origin


@dataclass(frozen=True, slots=True)
class StatedGravity:
    """A tag of a link that turns gravity on or off."""

    tag: str
    """``gravity`` or ``turnGravityOff``."""
    on: bool
    """Whether gravity acts on the link."""
    origin: Origin


def merge_gravity(
    links: Sequence[Link],
    tree: Tree,
    preserved: Iterable[str],
    stated: Mapping[str, Sequence[StatedGravity]],
) -> tuple[list[Link], list[Diagnostic]]:
    """The links with gravity as in Gazebo, where all merged links have one value.

    sdformat (``parser_urdf.cc``) copies the tags of all merged links to one link: those of the
    parent first, then those of its children, in the order of their joints' names. It appends each
    ``<gravity>``. Each ``<turnGravityOff>`` is appended as ``<gravity>``, but removes the first
    one. Of several ``<gravity>``, the first counts.

    Args:
        links: All links of the robot.
        tree: Their tree.
        preserved: The fixed joints that Gazebo is configured not to merge.
        stated: The tags of each link, in the order of the file.

    Returns:
        The links, and diagnostics about links whose gravity another link determines.
    """
    if not any(stated.values()):
        return list(links), []
    kept = frozenset(preserved)
    lumps: dict[str, list[str]] = {}
    for name in _in_depth(tree):
        lumps.setdefault(tree.lump_root(name, kept), []).append(name)
    on: dict[str, bool] = {}
    found: list[Diagnostic] = []
    for root, names in lumps.items():
        tags = [(name, each) for name in names for each in stated.get(name, ())]
        if tags:
            used = _first(tags)
            on |= dict.fromkeys(names, used[1].on)
            found.extend(_overruled(root, used, tags))
    merged = [replace(each, gravity=on.get(each.name, each.gravity)) for each in links]
    return merged, found


def _in_depth(tree: Tree) -> Iterator[str]:
    """All links, each followed by its descendants, children in the order of their joints' names."""
    waiting = [tree.root]
    while waiting:
        name = waiting.pop()
        yield name
        joints = sorted(tree.children[name], key=lambda joint: joint.name, reverse=True)
        waiting.extend(joint.child for joint in joints)


def _first(tags: Sequence[tuple[str, StatedGravity]]) -> tuple[str, StatedGravity]:
    """The tag that counts, with its link."""
    copied: list[tuple[str, StatedGravity]] = []
    for each in tags:
        if each[1].tag == "turnGravityOff":
            del copied[:1]
        copied.append(each)
    return copied[0]


def _overruled(
    root: str, used: tuple[str, StatedGravity], tags: Sequence[tuple[str, StatedGravity]]
) -> Iterator[Diagnostic]:
    """Diagnostics about a merged link whose gravity is not what its own tags state."""
    source, tag = used
    if source != root and not tag.on:
        yield devices.LUMPED_LINK.diagnostic(
            f'Gazebo merges link "{source}" into "{root}", so <{tag.tag}> turns off gravity for '
            "both and for all links that are merged with them",
            origin=tag.origin,
            severity="warning",
            hint=f'Gravity of one link can be turned off if the fixed joint above "{source}" has '
            "<preserveFixedJoint>.",
            values={"tag": tag.tag, "link": source, "root": root},
        )
    for name, each in tags:
        if name != source and each.on != tag.on:
            state = "on" if tag.on else "off"
            yield devices.LUMPED_LINK.diagnostic(
                f'<{each.tag}> of link "{name}" has no effect: Gazebo merges the link with '
                f'"{source}", whose <{tag.tag}> turns gravity {state} for both',
                origin=each.origin,
                severity="warning",
                values={"tag": each.tag, "link": name, "root": root},
            )
