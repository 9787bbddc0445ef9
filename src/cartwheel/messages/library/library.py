"""Message types from ``.msg``, ``.srv`` and ``.action`` files of a simulation's packages.

A file is read when its type is used for the first time. Nothing is searched before.
"""

from __future__ import annotations

import os
import threading
from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Protocol

from cartwheel.codes.graph import (
    MESSAGE_DEFINITION_INVALID,
    MESSAGE_DEFINITIONS_DIFFER,
    MESSAGE_TYPE_BUILT_IN,
    MESSAGE_TYPE_UNKNOWN,
)
from cartwheel.errors import CartwheelError, Diagnostic, GraphError, Origin, UnknownNameError
from cartwheel.messages.definition import RECORDING, Definition
from cartwheel.messages.learnt import learnt, parts_of, recorded, register
from cartwheel.messages.library.checks import check_sizes, nested_first, reject
from cartwheel.messages.library.files import content, dialect_of, parse_file, stems
from cartwheel.messages.library.parsing import decode_text, is_type_name
from cartwheel.messages.ros1.types import ros1_store
from cartwheel.messages.ros2.types import ros2_name
from cartwheel.messages.store import FIRST, TWIN, is_bundled, loaded, message_class, type_name
from cartwheel.options import PACKAGE_PATH

MOST_TYPES = 300
"""Maximum number of types that one type contains."""
MOST_TEXT = 8 << 20
"""Maximum size of the definitions of one type in bytes."""
_MOST_COPIES = 8
"""Number of packages with the same name that are compared."""
_MOST_MISSING = 1000

BUNDLED = frozenset(
    {
        *("action_msgs", "actionlib_msgs", "builtin_interfaces", "diagnostic_msgs"),
        *("geometry_msgs", "lifecycle_msgs", "nav_msgs", "rcl_interfaces", "rosgraph_msgs"),
        *("sensor_msgs", "shape_msgs", "std_msgs", "std_srvs", "stereo_msgs", "tf2_msgs"),
        *("trajectory_msgs", "visualization_msgs", "gazebo_msgs", "control_msgs"),
        *("controller_manager_msgs", "dynamic_reconfigure", "simulation_interfaces"),
        *("ros_gz_interfaces", "control_msgs_ros2", "controller_manager_msgs_ros2"),
        *("gazebo_msgs_ros2", "actuator_msgs"),
    }
)
"""Packages whose types Cartwheel contains, so that plugins of Cartwheel search no files."""


class PackageFiles(Protocol):
    """The packages that a simulation can see."""

    def folders(self, package: str) -> Iterable[Path]:
        """The folders of the packages with a name, in search order."""

    def may_read(self, path: Path, folder: Path) -> bool:
        """Whether a file belongs to the package in a folder, after resolving links."""


class NoPackages:
    """No packages, for a graph without a simulation."""

    def folders(self, package: str) -> Iterable[Path]:  # noqa: ARG002
        """See `PackageFiles`."""
        return ()

    def may_read(self, path: Path, folder: Path) -> bool:  # noqa: ARG002
        """See `PackageFiles`."""
        return False


@dataclass(frozen=True, slots=True)
class _File:
    """A file with the definition of a type."""

    path: Path
    folder: Path
    package: str


class TypeLibrary:
    """The message types that one simulation can see. Thread-safe.

    Args:
        packages: Packages of the simulation.
        report: Receives warnings on any thread.
    """

    def __init__(
        self,
        packages: PackageFiles | None = None,
        report: Callable[[Diagnostic], None] | None = None,
    ) -> None:
        self._packages = packages or NoPackages()
        self.report = report or (lambda _: None)
        self._lock = threading.RLock()
        self._found: set[str] = set()
        self._missing: set[str] = set()
        self._compared: set[str] = set()
        """Built-in types and files that were already compared with other files."""

    def forget_missing(self) -> None:
        """Searches again for missing types, because there are more packages now."""
        with self._lock:
            self._missing.clear()

    def note(self, name: str) -> None:
        """Prepares a type that the graph uses, unless Cartwheel contains its package.

        Raises:
            GraphError: The definition of the type is invalid.
        """
        if name.partition("/")[0] not in BUNDLED:
            self.find(name)

    def named(self, name: str) -> None:
        """Prepares a type that the user names. Warns if a file differs from a built-in type.

        Raises:
            GraphError: The definition of the type is invalid.
        """
        for part in parts_of(name):
            if is_bundled(part):
                self._compare_bundled(part)
        self.find(name)

    def message_class(self, name: str) -> Any:
        """Class of a message type.

        Raises:
            UnknownNameError: The type does not exist.
            GraphError: The definition of the type is invalid.
        """
        full = type_name(name)
        self.named(full)
        known = learnt(full)
        if known is not None and full not in self._found and known.origin.file != RECORDING:
            # Another simulation of this process has found it.
            raise UnknownNameError(
                "message type", name, sorted(self._found), code=MESSAGE_TYPE_UNKNOWN
            )
        return message_class(full)

    def find(self, name: str) -> bool:
        """Registers a type with its nested types. Returns False if it does not exist.

        Args:
            name: Message, service or action type, or a part of a service or action.

        Raises:
            GraphError: The definition of the type is invalid, or different from the definition
                that this process already uses.
        """
        with self._lock:
            if name in self._found:
                return True
            if name in self._missing or not is_type_name(name):
                return False
            if is_bundled(parts_of(name)[0]):
                return True
            wanted = self._definitions_of(name)
            if not wanted:
                if len(self._missing) < _MOST_MISSING:
                    self._missing.add(name)
                return False
            ordered = self._with_nested(wanted)
            check_sizes(ordered)
            register(ordered)
            self._found.update(each.name for each in ordered)
            self._found.add(name)
            return True

    # -- nested types

    def _with_nested(self, wanted: list[Definition]) -> list[Definition]:
        """The definitions with all nested types, nested ones first.

        Raises:
            GraphError: A nested type does not exist, or contains itself.
        """
        read = {each.name: each for each in wanted}
        waiting = list(wanted)
        size = sum(len(each.text) for each in wanted)
        while waiting:
            outer = waiting.pop()
            for field in outer.uses:
                if field.type in read or is_bundled(field.type):
                    self._compare_bundled(field.type)
                    continue
                found = self._definitions_of(field.type)
                if not found:
                    reject(
                        outer,
                        f'the type "{field.type}" of the field "{field.name}" was not found',
                        field.line,
                        hint=f"Add the folder of the package: {PACKAGE_PATH.given('FOLDER')}",
                        name=field.type,
                    )
                for each in found:
                    if each.name not in read:
                        read[each.name] = each
                        waiting.append(each)
                        size += len(each.text)
                if len(read) > MOST_TYPES + len(wanted) or size > MOST_TEXT:
                    reject(
                        outer,
                        f"the type contains more than {MOST_TYPES} types, or more than "
                        f"{MOST_TEXT} bytes of definitions",
                        field.line,
                    )
        return nested_first(read)

    # -- files

    def _definitions_of(self, name: str) -> list[Definition]:
        """The definitions in the file of a type; empty if there is no such file."""
        package, kind, last = name.split("/")
        for folder_kind, stem in stems(kind, last):
            files = list(self._files(package, folder_kind, stem))
            if files:
                found = self._read(files[0], folder_kind, stem)
                self._compare_copies(files, folder_kind, stem, found)
                return found
        return []

    def _files(self, package: str, kind: str, stem: str) -> Iterator[_File]:
        for folder in list(self._packages.folders(package))[:_MOST_COPIES]:
            path = folder / kind / f"{stem}.{kind}"
            if os.path.lexists(path):
                yield _File(path, folder, package)

    def _read(self, file: _File, kind: str, stem: str) -> list[Definition]:
        """Reads a file.

        Raises:
            GraphError: The file cannot be read, or its content is invalid.
        """
        origin = Origin(file=str(file.path))
        try:
            allowed = self._packages.may_read(file.path, file.folder)
        except (OSError, RuntimeError):  # a link that leads to itself
            allowed = False
        if not allowed:
            raise GraphError(
                f'the file is a symbolic link to a file outside the package "{file.package}"',
                code=MESSAGE_DEFINITION_INVALID,
                origin=origin,
                values={"type": f"{file.package}/{kind}/{stem}", "name": str(file.path)},
            )
        text = decode_text(content(file.path, origin), origin)
        dialect = dialect_of(file.folder)
        own_header = os.path.lexists(file.folder / "msg" / "Header.msg")
        name = f"{file.package}/{kind}/{stem}"
        return parse_file(name, text, origin, dialect=dialect, own_header=own_header)

    def _compare_copies(
        self, files: list[_File], kind: str, stem: str, used: list[Definition]
    ) -> None:
        """Warns about other packages with the same name and a different definition."""
        key = str(files[0].path)
        if key in self._compared:
            return
        self._compared.add(key)
        for other in files[1:]:
            try:
                same = _shapes(self._read(other, kind, stem)) == _shapes(used)
            except CartwheelError:
                same = False
            if not same:
                name = f"{other.package}/{kind}/{stem}"
                self.report(
                    MESSAGE_DEFINITIONS_DIFFER.diagnostic(
                        f"the definition of {name} in {other.path} is different, and is ignored",
                        origin=Origin(file=key),
                        hint="Build the workspace again, or remove one of the two packages.",
                        values={"type": name, "file": key, "other": str(other.path)},
                    )
                )

    def _compare_bundled(self, name: str) -> None:
        """Warns if a package defines a built-in type differently."""
        with self._lock:
            if name in self._compared or not is_bundled(name):
                return
            self._compared.add(name)
            try:
                found = {each.name: each for each in self._definitions_of(name)}
            except CartwheelError as error:
                self.report(error.diagnostic("warning"))
                return
            other = found.get(name)
            if other is None:
                return
            if any(_graph_fields(each) == _graph_fields(other) for each in _built_in(name)):
                return
            self.report(
                MESSAGE_TYPE_BUILT_IN.diagnostic(
                    f"the definition of {name} differs from the built-in type, which is used "
                    "instead",
                    origin=other.origin,
                    hint="Rename the type, or use the fields of the built-in type.",
                    values={"type": name, "file": other.origin.file},
                )
            )


def _built_in(name: str) -> Iterator[Definition]:
    """The built-in type, and those of other releases of ROS with the same name."""
    package, _, rest = name.partition("/")
    for each in (name, f"{package}{TWIN}/{rest}", f"{package}{FIRST}/{rest}"):
        if is_bundled(each):
            message_class(each)
            yield recorded(each, loaded().fielddefs[each])
    known = ros1_store().fielddefs
    if name in known:
        yield recorded(name, known[name])


def _shapes(definitions: list[Definition]) -> list[object]:
    return [each.shape for each in definitions]


def _graph_fields(definition: Definition) -> list[object]:
    """The fields as the graph sees them, without details that change between releases."""
    return [
        (
            each.name.lower(),
            ros2_name({"byte": "uint8", "char": "uint8"}.get(each.type, each.type)),
            each.array,
            each.length,
        )
        for each in definition.fields
        # ROS 1's header has a sequence number, and ROS 2's message without fields has a filler.
        if each.name != "structure_needs_at_least_one_member"
        and (definition.name, each.name) != ("std_msgs/msg/Header", "seq")
    ]
