"""Expands xacro with ROS's implementation, and keeps the origin of each element."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field, replace
from types import ModuleType
from typing import Any

from cartwheel.codes import files as codes
from cartwheel.description.elements import xml
from cartwheel.description.elements.xml import Node
from cartwheel.description.expressions import Budget
from cartwheel.description.files.packages import Packages
from cartwheel.description.files.ros_environment import assumed
from cartwheel.description.xacro.absent import Absences
from cartwheel.description.xacro.dom import Document, DomBuilder, Element, clone, size_of, to_node
from cartwheel.description.xacro.driver_parts import choose_driver_parts
from cartwheel.description.xacro.errors import Failure, explain
from cartwheel.description.xacro.module import fresh_xacro
from cartwheel.description.xacro.replacements import replace_functions
from cartwheel.description.xacro.unprefixed import PREFIX, prefixed
from cartwheel.errors import CartwheelError, Code, DescriptionError, Diagnostic, Origin, Value
from cartwheel.similar_names import meant, suggestion

MAX_ELEMENTS = 100_000
"""Maximum number of elements that macros create: about 50 times that of the largest robots."""
MAX_CALLS = 10_000
"""Maximum number of macro calls, including nested ones: eight times that of the largest robots."""
MAX_SHOWN = 6
"""Number of calls in the error for too many calls."""
NAMESPACE = 'xmlns:xacro="http://www.ros.org/wiki/xacro"'


@dataclass(frozen=True, kw_only=True, slots=True)
class Expansion:
    """An expanded xacro file."""

    root: Node
    diagnostics: tuple[Diagnostic, ...]
    files: tuple[str, ...]
    """The file and the included files, each once."""
    arguments: Mapping[str, str]
    """Values of all arguments, including defaults."""


def expand(
    content: bytes | str, file: str, packages: Packages, arguments: Mapping[str, str]
) -> Expansion:
    """Expands a xacro file.

    Args:
        content: Contents of the file.
        file: Name of the file in errors and origins.
        packages: Resolves ``$(find …)``. Relative includes are relative to its file.
        arguments: Values of ``name:=value``.

    Raises:
        DescriptionError: The file cannot be expanded. The error contains the location, the active
            macro calls and the likely fix.
    """
    run = Run(file=file, packages=packages, arguments=dict(arguments))
    module = fresh_xacro()
    replace_functions(module, run)
    run.execute(module, content)
    root = to_node(run.document.documentElement)
    sensors = choose_driver_parts(root)
    run.absences.connect(root)
    return Expansion(
        root=root,
        diagnostics=(
            *run.diagnostics,
            *_stand_ins(packages, sensors),
            *_unknown_arguments(run, arguments),
        ),
        files=tuple(dict.fromkeys(run.files)),
        arguments=dict(run.values),
    )


def _stand_ins(packages: Packages, sensors: tuple[str, ...]) -> Iterator[Diagnostic]:
    """Notes about the stand-ins; `sensors` are those that the original packages do not contain."""
    for name, origin in packages.stand_ins.items():
        yield codes.STAND_IN_USED.diagnostic(
            f'the package "{name}" was not found, and Cartwheel\'s stand-in for it is used: its '
            "frames, joints and sensors match, but its shapes are plain",
            origin=origin,
            hint=packages.how_to_install(name),
            values={"package": name, "added_sensors": sensors},
        )


def _unknown_arguments(run: Run, arguments: Mapping[str, str]) -> Iterator[Diagnostic]:
    for name in arguments:
        if name not in run.declared:
            known = sorted(run.declared)
            yield codes.ARGUMENT_UNKNOWN.diagnostic(
                f'the argument "{name}" is not declared and has no effect',
                origin=Origin(file=run.file),
                hint=suggestion(name, known),
                values={"name": name, "meant": meant(name, known)},
            )


@dataclass(kw_only=True)
class Run:
    """The state of one expansion."""

    file: str
    packages: Packages
    arguments: dict[str, str]
    values: dict[str, str] = field(default_factory=dict)
    """Values of the arguments seen so far, including defaults."""
    diagnostics: list[Diagnostic] = field(default_factory=list)
    seen: set[tuple[object, ...]] = field(default_factory=set)
    """Identities of the reported messages."""
    declared: set[str] = field(default_factory=set)
    files: list[str] = field(default_factory=list)
    place: Element | None = None
    """The element that is being evaluated."""
    calls: list[Element] = field(default_factory=list)
    """The active macro calls, outermost first."""
    symbols: Any = None
    macros: Any = None
    created: int = 0
    """Number of elements that macros have created."""
    called: int = 0
    """Number of macro calls so far."""
    document: Any = None
    budget: Budget = field(default_factory=Budget)
    absences: Absences = field(init=False)

    def __post_init__(self) -> None:
        self.absences = Absences(packages=self.packages, diagnostics=self.diagnostics)

    def execute(self, module: ModuleType, content: bytes | str) -> None:
        """Parses and expands the file.

        Raises:
            DescriptionError: The file cannot be expanded.
        """
        file = self.packages.file
        module.init_stacks(str(file) if file is not None else None)
        self.document = self.parse(content, self.file)
        self.place = self.document.documentElement
        try:
            # xacro adds the default values to the mapping.
            self.values = dict(self.arguments)
            module.process_doc(self.document, mappings=self.values, verbosity=0)
        except CartwheelError as error:
            raise self._placed(error) from None
        except Exception as error:  # noqa: BLE001 - the error names what failed
            inner = _described(error)
            if inner is not None:
                raise self._placed(inner) from None
            raise self._failure(error) from None

    def parse(self, content: bytes | str, file: str) -> Document:
        """Parses the file or an included file; see `_parse`."""
        return _parse(content, file, self)

    def origin(self) -> Origin:
        """Returns the origin of the element that is being evaluated."""
        return self.place.origin if self.place is not None else Origin(file=self.file)

    def warn(self, message: str) -> None:
        """Reports a message of xacro or of the description, once for each location."""
        self._report(codes.XACRO_MESSAGE, message, {"text": message})

    def assume(self, name: str, value: str, version: int) -> None:
        """Reports the value of an environment variable that ROS would set, once."""
        if ("environment", name) not in self.seen:
            self.seen.add(("environment", name))
            self.diagnostics.append(assumed(name, value, version, self.origin()))

    def warn_of_deprecated(self, name: str, meant: str) -> None:
        """Reports a deprecated name of a function, once for each location."""
        message = f"{name}() without its namespace is deprecated: use {meant}()"
        self._report(codes.XACRO_DEPRECATED, message, {"name": name, "meant": meant})

    def _report(self, code: Code, message: str, values: dict[str, Value]) -> None:
        diagnostic = code.diagnostic(message, origin=self.origin(), values=values)
        if diagnostic.identity not in self.seen:
            self.seen.add(diagnostic.identity)
            self.diagnostics.append(diagnostic)

    def warn_of_prefix(self, element: Element, tag: str, number: int = 1) -> None:
        """Reports a tag without its prefix, once for each file.

        Args:
            element: The first element with the tag.
            tag: The tag in the file.
            number: Number of elements with the tag in the file.
        """
        values = {"tag": tag, "meant": PREFIX + tag}
        if any(
            each.code is codes.XACRO_PREFIX
            and each.values == values
            and each.origin is not None
            and each.origin.file == element.origin.file
            for each in self.diagnostics
        ):
            return
        more = f" (and {number - 1} more in this file)" if number > 1 else ""
        self.diagnostics.append(
            codes.XACRO_PREFIX.diagnostic(
                f"<{tag}> is read as <{PREFIX}{tag}>, but since Noetic, ROS ignores xacro elements "
                f"without a prefix{more}",
                origin=element.origin,
                hint=f"Use <{PREFIX}{tag}>.",
                values=values,
            )
        )

    def copy_body(self, body: Element) -> Element:
        """Copies a macro's body. The origins of the copies contain the current call.

        Raises:
            DescriptionError: There are too many calls or elements.
        """
        call = self.calls[-1]
        self.called += 1
        if self.called > MAX_CALLS:
            raise DescriptionError(
                f"there are more than {MAX_CALLS:,} macro calls; the last is <{call.tagName}>",
                code=codes.EXPANSION_TOO_LARGE,
                values={"kind": "calls", "most": MAX_CALLS, "tag": call.tagName},
                origin=replace(call.origin, stack=call.origin.stack[:MAX_SHOWN]),
                hint="Check whether a macro calls itself endlessly, or reduce the number of calls.",
            )
        copy = clone(body, (f"{call.origin} {call.tagName}", *call.origin.stack))
        self.count(copy)
        return copy

    def count(self, copy: Element) -> None:
        """Counts the elements and characters of a copy.

        Raises:
            DescriptionError: There are too many.
        """
        elements, parts, characters = size_of(copy)
        self.created += elements
        self.budget.spend(parts)
        self.budget.make(characters)
        if self.created > MAX_ELEMENTS:
            raise DescriptionError(
                f"the macros expand to more than {MAX_ELEMENTS} elements",
                code=codes.EXPANSION_TOO_LARGE,
                values={"kind": "elements", "most": MAX_ELEMENTS},
                origin=self.origin(),
            )

    def _placed(self, error: CartwheelError) -> CartwheelError:
        if error.origin is None:
            error.origin = self.origin()
        return error

    def _failure(self, error: Exception) -> DescriptionError:
        call = self.calls[-1] if self.calls else None
        failure = explain(
            Failure(
                error=error,
                origin=self.origin(),
                call=call.origin if call is not None else None,
                call_tag=call.tagName if call is not None else "",
                macros=tuple(self.macro_names()),
                properties=tuple(sorted(_names(self.symbols))),
                arguments=tuple(sorted(self.declared)),
                parameters=self._parameters(call),
                files=tuple(self.files),
            )
        )
        return self.absences.explain(failure)

    def macro_names(self) -> list[str]:
        """The macros that are defined at the current element, sorted."""
        return sorted(_names(self.macros))

    def _parameters(self, call: Element | None) -> tuple[str, ...]:
        if call is None or self.macros is None:
            return ()
        try:
            macro = self.macros[call.tagName.removeprefix(PREFIX)]
            return tuple(str(name) for name in macro.params)
        except (KeyError, AttributeError):
            return ()


def _described(error: BaseException | None) -> CartwheelError | None:
    """Returns the `CartwheelError` that xacro wrapped in its own exception, or None."""
    for _ in range(50):
        if error is None or isinstance(error, CartwheelError):
            return error
        error = getattr(error, "exc", None)
    return None


def _names(table: Any) -> Iterator[str]:
    """Yields the names in a table of xacro and in the enclosing tables, except xacro's own."""
    root = getattr(table, "root", None)
    while table is not None and table is not root:
        yield from (str(name).lstrip("*") for name in dict.keys(table))
        table = getattr(table, "parent", None)


def _parse(content: bytes | str, file: str, run: Run) -> Document:
    """Parses a file and adds missing prefixes.

    Raises:
        DescriptionError: The file is not well-formed XML.
    """
    run.files.append(file)
    run.budget.make(len(content))
    run.budget.look()
    builder = DomBuilder(file, run)
    xml.run_expat(content, file, builder)
    root: Any = builder.document.documentElement
    if not root.hasAttribute("xmlns:xacro") and any(
        element.tagName.startswith(PREFIX) for element in root.getElementsByTagName("*")
    ):
        run.diagnostics.append(
            codes.XACRO_NAMESPACE.diagnostic(
                "the root element does not declare xmlns:xacro, so the xacro tool of ROS rejects "
                "the file",
                origin=root.origin,
                hint=f"Add {NAMESPACE} to the root element.",
            )
        )
    prefixed(root, run.warn_of_prefix)
    return builder.document
