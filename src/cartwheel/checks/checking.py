"""Checks a description: reads as much of it as possible and applies every rule."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from cartwheel.checks import nodes
from cartwheel.checks.controller_claims import idle_joints
from cartwheel.checks.controller_search import controller_files_of
from cartwheel.checks.repairs import displaced, mend
from cartwheel.checks.reported import outside_stand_ins, passed
from cartwheel.checks.robot import Robot
from cartwheel.checks.rules import RULES
from cartwheel.checks.stated_sizes import controlled_sides, controlled_steering
from cartwheel.checks.subject import Subject
from cartwheel.codes import codes_of
from cartwheel.codes.devices import PLUGIN_OF_OTHER_GAZEBO, PLUGIN_PARAMETER_UNKNOWN
from cartwheel.codes.running import (
    CONTROLLER_NOT_STARTED,
    JOINT_DRIVEN_TWICE,
    MODEL_NOT_MOVABLE,
)
from cartwheel.codes.tags import DEFAULT_USED
from cartwheel.codes.world import PHYSICS_SETTING_IGNORED, PLANE_NOT_STATIC
from cartwheel.description.elements.node import Node
from cartwheel.description.launches import (
    LaunchSearch,
    OwnLaunches,
    needs_expansion,
    unexpanded,
    unread,
)
from cartwheel.description.loading import Opened, open_description, understand
from cartwheel.description.model import RobotDescription, WorldDescription
from cartwheel.dialects.gz.gazebo_only import as_launched, gazebo_of, other_gazebo
from cartwheel.dialects.ros_control.selection import Selection
from cartwheel.errors import DescriptionError, Diagnostic, Origin

REPORTED = (
    *(code for module in ("files", "robot", "tags", "devices") for code in codes_of(module)),
    MODEL_NOT_MOVABLE,
    CONTROLLER_NOT_STARTED,
    JOINT_DRIVEN_TWICE,
    PLANE_NOT_STATIC,
    PHYSICS_SETTING_IGNORED,
)
"""Every code that a check can report, from the rules and from the description readers."""
_MATERIALS = ("material", "texture")
"""What readers leave out that changes no shape."""
MAX_FAILURES = 30
"""Unreadable elements to remove before giving up: the rest of such a file is rarely useful."""


@dataclass(frozen=True, kw_only=True, slots=True)
class Report:
    """The result of a check."""

    file: str
    name: str
    """Name of the robot or world; empty if the description could not be read."""
    findings: tuple[Diagnostic, ...]
    """Sorted by file and line."""
    files: tuple[str, ...] = ()
    """Every file that was read, including included files and controller files."""
    complete: bool
    """False if the description could not be read; rules that need its contents were then skipped.
    """

    def count(self, severity: str) -> int:
        """Number of findings with this severity."""
        return sum(finding.severity == severity for finding in self.findings)


def check(
    path: Path | str,
    *,
    arguments: Mapping[str, str] | None = None,
    package_path: Sequence[Path] = (),
    controller_files: Sequence[Path] = (),
    launches: Callable[[Path], OwnLaunches] | None = None,
    selected: Selection | None = None,
) -> Report:
    """Checks a description for errors and misleading values.

    Args:
        path: As for `load`.
        arguments: Values of ``name:=value`` arguments.
        package_path: As for `load`.
        controller_files: Controller files to use instead of those found near the robot.
        launches: Returns the launch files of a description's author; None to search them.
        selected: What launch files load, if `controller_files` was taken from them.

    Raises:
        DescriptionError: The file is not a description, or its XML or xacro cannot be read.
    """
    opened = open_description(path, arguments or {}, package_path)
    if nodes.children(opened.root, "light") and _is_empty(opened.root):
        # A light model, as worlds include it: no rule applies.
        name = nodes.name_of(nodes.children(opened.root, "light")[0])
        return Report(file=opened.files[0], name=name, findings=(), complete=True)
    if opened.root.tag not in ("robot", "sdf", "gazebo") or _is_empty(opened.root):
        understand(opened)  # raises an error that says what the file contains
    subject = _subject(opened, arguments or {}, controller_files, launches, selected)
    # Numbers near the largest float overflow; rules report nothing about non-finite results.
    with np.errstate(all="ignore"):
        findings = _distinct(
            [
                *passed(subject),
                *(one for each in RULES for one in each.apply(subject)),
                # The last, because rules search for launch files.
                *subject.find_unread(),
            ]
        )
    findings = list(outside_stand_ins(subject.files[0], _of_loaded(subject, findings)))
    order = {file: index for index, file in enumerate(subject.files)}
    findings.sort(key=lambda finding: place(finding, order))
    return Report(
        file=subject.files[0],
        name=subject.read.name if subject.read is not None else "",
        findings=tuple(findings),
        complete=subject.read is not None,
        files=tuple(
            dict.fromkeys([*subject.files, *(str(own.path) for _, own in subject.control)])
        ),
    )


def _subject(
    opened: Opened,
    arguments: Mapping[str, str],
    given: Sequence[Path],
    launches: Callable[[Path], OwnLaunches] | None,
    selected: Selection | None,
) -> Subject:
    tree = nodes.copy(opened.root)
    mended: set[str] = set()
    if tree.tag == "robot":
        mended |= mend(tree)
    cut: set[str] = set()
    gaps: list[Origin] = []
    read, failures = _read(opened, tree, mended, cut, gaps)
    described: tuple[RobotDescription, ...] = ()
    if isinstance(read, WorldDescription):
        described = read.models
    elif read is not None:
        described = (read,)
    find = launches or LaunchSearch(opened.packages.package_path).of
    found: dict[Path, OwnLaunches] = {}

    def search(description: Path) -> OwnLaunches:
        if description not in found:
            found[description] = find(description)
        return found[description]

    file = Path(opened.files[0])
    if isinstance(read, RobotDescription) and any(
        gazebo_of(tag.filename) for tag in read.all_plugins
    ):
        path = opened.packages.package_path
        read = as_launched(read, file, search(file).launches, arguments, path)
        described = (read,)
    root = opened.root if opened.root.tag == "robot" else None
    unseen: set[str] = set()
    if root is None:
        lost_shapes, unseen = _left_out(opened.root, read)
        cut |= lost_shapes
    lost = displaced(opened.root, tree) if root is not None else set()
    robots = tuple(
        Robot(each, root, mended=mended | cut, cut=cut, unseen=unseen, displaced=lost)
        for each in described
    )
    control, launched = controller_files_of(robots, opened.packages, given, search, selected)
    plain = unexpanded(file, search(file).launches) if needs_expansion(file) else ()
    subject = Subject(
        root=opened.root,
        files=opened.files,
        packages=opened.packages,
        read=read,
        robots=robots,
        failures=tuple(failures),
        gaps=tuple(gaps),
        control=control,
        launched=launched,
        unexpanded=tuple(plain),
        arguments=opened.arguments,
        find_launches=lambda: search(file),
        find_unread=lambda: unread(each for own in found.values() for each in own.launches),
    )
    for robot in robots:
        robot.controlled = controlled_sides(subject, robot)
        robot.steered = controlled_steering(subject, robot)
        robot.idle = idle_joints(subject, robot)
    return subject


def _read(
    opened: Opened, tree: Node, mended: set[str], cut: set[str], gaps: list[Origin]
) -> tuple[RobotDescription | WorldDescription | None, list[Diagnostic]]:
    """Reads a tree, removing each element that raises an error.

    Args:
        opened: The description.
        tree: Its tree; unreadable elements are removed in place.
        mended: Links whose inertia was replaced; extended in place.
        cut: Links that lost an element; extended in place.
        gaps: Origins of the parents and grandparents of removed elements; extended in place.
    """
    failures: list[Diagnostic] = []
    holed: set[int] = set()
    while True:
        attempt = replace(opened, root=nodes.copy(tree))
        try:
            return understand(attempt), failures
        except DescriptionError as error:
            node = nodes.at(tree, error.origin) if error.origin is not None else None
            # Ignore errors caused by the earlier removal of a child element.
            if node is None or id(node) not in holed:
                failures.append(error.diagnostic())
            parent = nodes.parent_of(tree, node) if node is not None else None
            if node is None or parent is None or len(holed) >= MAX_FAILURES:
                return None, failures
            cut |= _links_around(tree, node)
            parent.drop(node)
            holed.add(id(parent))
            holder = nodes.parent_of(tree, parent)
            gaps += [each.origin for each in (parent, holder) if each is not None]
            owner = nodes.parent_of(tree, holder) if holder is not None else None
            if parent.tag == "geometry" and holder is not None and owner is not None:
                # Without its shape, a visual would be an error as well.
                owner.drop(holder)
            if tree.tag == "robot":
                mended |= mend(tree)


def _left_out(
    root: Node, read: RobotDescription | WorldDescription | None
) -> tuple[set[str], set[str]]:
    """SDF links with elements that the readers ignored, and those with ignored visuals.

    Materials are not among them.
    """
    holders: dict[int, set[str]] = {}
    for link in nodes.walk(root):
        for node in nodes.walk(link) if link.tag == "link" else ():
            holders.setdefault(id(node.origin), set()).add(nodes.name_of(link))
    links, unseen = set[str](), set[str]()
    for diagnostic in read.diagnostics if read is not None else ():
        values = diagnostic.values
        lost = values.get("left_out")
        lacks = lost is not None or (diagnostic.code is DEFAULT_USED and "shape" in values)
        if lacks and lost not in _MATERIALS:
            holder = holders.get(id(diagnostic.origin), set())
            (unseen if lost == "visual" else links).update(holder)
    return links, unseen


def _links_around(tree: Node, wanted: Node) -> set[str]:
    return {
        nodes.name_of(link)
        for link in nodes.walk(tree)
        if link.tag == "link" and any(node is wanted for node in nodes.walk(link))
    }


def _is_empty(root: Node) -> bool:
    """Whether there is nothing to check: a macro-only file, or a document without a model."""
    if root.tag == "robot":
        return not nodes.children(root, "link")
    return not nodes.children(root, "model") and not nodes.children(root, "world")


def _distinct(findings: Sequence[Diagnostic]) -> list[Diagnostic]:
    """Removes duplicates; findings of one kind from one macro line become a single finding.

    If an element has no effect, only this is reported about it.
    """
    idle = {id(each.origin): each for each in findings if _is_idle(each)}
    distinct: dict[tuple[object, ...], Diagnostic] = {}
    for each in findings:
        if idle.get(id(each.origin), each).code is not each.code:
            continue
        key = each.identity
        if each.origin is not None and each.origin.stack:
            key = (*each.kind, str(each.origin))
        first = distinct.setdefault(key, each)
        if all(each.identity != other.identity for other in (first, *first.also)):
            distinct[key] = replace(first, also=(*first.also, each))
    return list(distinct.values())


def _of_loaded(subject: Subject, findings: Iterable[Diagnostic]) -> Iterator[Diagnostic]:
    """The findings without those about what is in a plugin that Gazebo does not load."""
    idle = {
        id(element.origin)
        for robot in subject.robots
        for tag, sensor in robot.plugins()
        if other_gazebo(robot.description, tag, sensor) is not None
        for element in tag.element.walk()
    }
    for each in findings:
        if id(each.origin) not in idle or each.code is PLUGIN_OF_OTHER_GAZEBO:
            yield each


def _is_idle(finding: Diagnostic) -> bool:
    """Whether a finding means that a whole element has no effect, not even a misspelt one."""
    values = finding.values
    return finding.code is PLUGIN_PARAMETER_UNKNOWN and not values.get("meant")


def place(finding: Diagnostic, order: Mapping[str, int]) -> tuple[int, str, int]:
    """Sort key: the file's index in `order`, then the line."""
    if finding.origin is None:
        return (-1, "", 0)
    file = finding.origin.file
    return (order.get(file, len(order)), file, finding.origin.line)
