"""Expands a file although packages or included files that it refers to are not installed.

An include of an absent file is left out, and so are the calls of macros that this file would have
defined. Afterwards, the remaining links are connected again, so that the robot stays one tree.
"""

from __future__ import annotations

from collections.abc import Collection, Mapping
from dataclasses import dataclass, field
from pathlib import Path

from cartwheel.codes import files as codes
from cartwheel.description.elements.xml import Node
from cartwheel.description.files.other_places import FIND
from cartwheel.description.files.package_folders import is_file
from cartwheel.description.files.packages import Packages
from cartwheel.description.losses import loss
from cartwheel.errors import DescriptionError, Diagnostic, Origin, Value
from cartwheel.similar_names import suggestion

_WORLD = "world"
"""The link that represents the world."""
_TEMPLATE = ".in"
"""End of the names of the files from which CMake makes others."""
_PARENTS = ("parent", "parent_link", "attach_to", "connected_to", "parent_name")
"""Names of the macro parameter with the link to which a part is attached."""


@dataclass(frozen=True, slots=True)
class AbsentFile:
    """An included file that does not exist."""

    name: str
    """The file as the include states it."""
    package: str
    """The package that was not found; empty if only the file was not found."""


@dataclass(frozen=True, slots=True)
class LostCall:
    """A macro call that was left out."""

    tag: str
    attributes: Mapping[str, str]
    origin: Origin
    pose: Mapping[str, str]
    """Attributes of the ``<origin>`` in the call, if any."""


@dataclass(kw_only=True)
class Absences:
    """What one expansion could not find."""

    packages: Packages
    diagnostics: list[Diagnostic]
    files: list[AbsentFile] = field(default_factory=list)
    calls: list[LostCall] = field(default_factory=list)
    _first: DescriptionError | None = None
    """The error for the first absent file."""

    def find(self, package: str, origin: Origin) -> str:
        """The folder of a package; ``$(find package)``, unchanged, if it is not found.

        The reader of the file that the text names reports the package.
        """
        try:
            return str(self.packages.find(package, origin))
        except DescriptionError as error:
            if error.code is not codes.FILE_MISSING:
                raise
            return f"$(find {package})"

    def find_include(
        self, name: str, path: str, origin: Origin, *, active: Collection[str]
    ) -> Path | None:
        """The file of an include that does not exist where it is stated, if it is elsewhere.

        An include whose file is nowhere is reported, and left out.

        Args:
            name: The file as the include states it, with its expressions evaluated.
            path: The absolute path.
            origin: The include.
            active: The files that contain the include, outermost first.
        """
        found = FIND.search(name)
        package = found[1] if found else ""
        try:
            return self.packages.resolve(
                name if package else path, origin, what="included file", without=active,
                use="include",
            )  # fmt: skip
        except DescriptionError as error:
            self.files.append(AbsentFile(name, package))
            template = f"{path}{_TEMPLATE}"
            made = is_file(Path(template))
            if made:
                name_in = Path(template).name
                error.hint = f'Build its package: the build makes the file from "{name_in}".'
            self._first = self._first or error
            self.diagnostics.append(
                loss(
                    error,
                    "the include is left out",
                    of="include",
                    code=codes.INCLUDE_ABSENT,
                    values={"file": name, "package": package, "template": template if made else ""},
                )
            )
            return None

    @property
    def may_define_macros(self) -> bool:
        """Whether an absent file, or a package with a stand-in, may define further macros."""
        return bool(self._incomplete())

    def _incomplete(self) -> list[AbsentFile]:
        """The absent files, and the packages whose stand-ins are used."""
        packages = self.packages.stand_ins
        return [*self.files, *(AbsentFile(f"$(find {name})", name) for name in packages)]

    def leave_out_call(self, call: LostCall, known: list[str]) -> None:
        """Reports a call of a macro that is not defined, probably because its file is absent.

        Args:
            call: The call.
            known: The macros that are defined, with their prefix.
        """
        self.calls.append(call)
        files = self._incomplete()
        likely = _likely(call, files)
        source = f'"{likely.name}"' if likely else "one of the absent files"
        values: dict[str, Value] = {
            "name": call.tag,
            "package": likely.package if likely else "",
            "files": tuple(each.name for each in files),
            "left_out": "macro",
        }
        self.diagnostics.append(
            codes.MACRO_ABSENT.diagnostic(
                f"<{call.tag}> is left out because its macro is not defined, probably because "
                f"{source} is not found",
                origin=call.origin,
                hint=suggestion(call.tag, known) if likely not in self.files else "",
                values=values,
            )
        )

    def explain(self, error: DescriptionError) -> DescriptionError:
        """Adds the absent files to the hint of an error that they may have caused.

        The value ``unfound`` contains the packages that may define the name, but were not found.
        """
        unfound = {each.package: None for each in self._incomplete() if each.package}
        if error.code is codes.XACRO_NAME_UNKNOWN and unfound:
            error.values = {**error.values, "unfound": tuple(unfound)}
        if error.code is codes.XACRO_NAME_UNKNOWN and self.files:
            names = ", ".join(f'"{each.name}"' for each in self.files)
            cause = f"It may be defined in an included file that was not found: {names}."
            error.hint = f"{error.hint} {cause}" if error.hint else cause
            error.values = {**error.values, "absent": tuple(each.name for each in self.files)}
        return error

    def connect(self, root: Node) -> None:
        """Adds empty links and fixed joints where left-out parts have torn the tree.

        Args:
            root: The expanded robot.

        Raises:
            DescriptionError: A file is absent, and nothing is left of the robot.
        """
        if root.tag != "robot" or not (self._first or self.calls):
            return
        links = {node.attributes["name"].strip(): node for node in root.all("link")
                 if "name" in node.attributes}  # fmt: skip
        if not links.keys() - {_WORLD} and not root.all("joint") and self._first is not None:
            raise self._first
        stated = set(links)
        held: dict[str, str] = {}
        for node in root.all("joint"):
            ends = [_end(node, side) for side in ("parent", "child")]
            for name in ends:
                if name and name not in links:
                    links[name] = Node("link", {"name": name}, node.origin)
                    root.children.append(links[name])
                    self._report_link(name, node.origin)
            if all(ends):
                held[ends[1]] = ends[0]
        free = [name for name in links if name not in held]
        if len(free) < 2:
            return
        main = max(free, key=lambda name: (name == _WORLD, name in stated, _weight(name, held)))
        for name in free:
            if name != main:
                root.children.append(self._joint(name, main, links, held))

    def _joint(
        self, link: str, main: str, links: Mapping[str, Node], held: Mapping[str, str]
    ) -> Node:
        """A fixed joint from the rest of the robot to a link that lost its joint."""
        call = next((each for each in self.calls if _made(each, link)), None)
        if call is None and len(self.calls) == 1:
            call = self.calls[0]
        stated = [call.attributes.get(name, "") for name in _PARENTS] if call else []
        known = (each for each in stated if each in links and _top(each, held) != link)
        chosen = next(known, None)
        parent = chosen or main
        pose = call.pose if call is not None and chosen is not None else {}
        at = links[link].origin
        self.diagnostics.append(
            codes.LINK_RECONNECTED.diagnostic(
                f'link "{link}" is attached to "{parent}" because the part that would hold it is '
                "left out",
                origin=at,
                values={"link": link, "parent": parent},
            )
        )
        children = [
            Node("parent", {"link": parent}, at),
            Node("child", {"link": link}, at),
            *([Node("origin", pose, at)] if pose else []),
        ]
        return Node("joint", {"name": f"{link}_reconnected", "type": "fixed"}, at, children)

    def _report_link(self, name: str, origin: Origin) -> None:
        self.diagnostics.append(
            codes.LINK_RECONNECTED.diagnostic(
                f'link "{name}" is empty because the part that defines it is left out',
                origin=origin,
                values={"link": name, "parent": ""},
            )
        )


def _end(joint: Node, side: str) -> str:
    node = joint.child(side)
    return node.attributes.get("link", "").strip() if node is not None else ""


def _likely(call: LostCall, files: list[AbsentFile]) -> AbsentFile | None:
    """The absent file that probably defines a macro: the one that shares most of its words."""
    if len(files) == 1:
        return files[0]
    words = _words(call.tag.removeprefix("xacro:"))
    shared = [len(words & _words(each.name)) for each in files]
    most = max(shared)
    return files[shared.index(most)] if most and shared.count(most) == 1 else None


def _words(name: str) -> set[str]:
    plain = "".join(each.lower() if each.isalnum() else " " for each in name)
    return set(plain.split()) - {"urdf", "xacro", "find", "description"}


def _made(call: LostCall, link: str) -> bool:
    """Whether a call would probably have defined a link: its name or prefix begins the link's."""
    begins = (
        call.attributes.get(name, "") for name in ("name", "prefix", "link", "frame", "child")
    )
    return any(each and link.startswith(each) for each in begins)


def _weight(root: str, held: Mapping[str, str]) -> int:
    """Number of links below a root."""
    return sum(_top(name, held) == root for name in held)


def _top(name: str, held: Mapping[str, str]) -> str:
    """The root above a link; any link of a loop, which the reader rejects."""
    for _ in range(len(held) + 1):
        if name not in held:
            break
        name = held[name]
    return name
