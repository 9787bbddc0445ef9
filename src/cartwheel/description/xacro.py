"""Expands xacro with ROS's own implementation, and keeps the place of every element.

The package `xacro` holds the state of an expansion in its module. A copy of that module,
private to this one and reset under a lock, keeps two loads apart from each other and from
whoever else uses xacro in this process. Some of its functions are replaced in the copy:
its parser, so that elements know their file and line and clones of them the macro calls
that made them; its look-up of packages; its messages, which become diagnostics.
"""

from __future__ import annotations

import glob
import importlib.util
import sys
import threading
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass, field
from itertools import pairwise
from pathlib import Path
from types import ModuleType, SimpleNamespace
from typing import Any
from xml.dom import minidom

from cartwheel.description import xml
from cartwheel.description.installed import source_of
from cartwheel.description.packages import Packages
from cartwheel.description.xacro_errors import Failure, explain
from cartwheel.description.xacro_unprefixed import PREFIX, call_prefixed, prefixed
from cartwheel.description.xml import Node
from cartwheel.errors import (
    CartwheelError,
    DescriptionError,
    Diagnostic,
    Origin,
    Severity,
    suggestion,
)

MAX_ELEMENTS = 100_000
"""Elements that macros may make: some fifty times what the largest robots have."""

_NAME = "_cartwheel_xacro"

_lock = threading.RLock()


@dataclass(frozen=True, kw_only=True, slots=True)
class Expansion:
    """What became of a xacro file."""

    root: Node
    diagnostics: tuple[Diagnostic, ...]
    declared: tuple[str, ...]
    """The arguments that it, or a file it includes, declares or uses."""
    files: tuple[str, ...]
    """It and the files that it includes, each once."""
    arguments: Mapping[str, str]
    """Values of all arguments, given or not."""


def expand(
    content: bytes | str, file: str, packages: Packages, arguments: Mapping[str, str]
) -> Expansion:
    """The tree of a xacro file with everything evaluated.

    Args:
        content: The file's text.
        file: What errors and origins call it.
        packages: Answers ``$(find …)``; its file is where relative includes begin.
        arguments: The values of ``name:=value``; all of them texts.

    Raises:
        DescriptionError: Where the file cannot be expanded; has the place, the macro calls
            that lead there, and the likely fix.
    """
    with _lock:
        run = _Run(file=file, packages=packages, arguments=dict(arguments))
        module = _private_xacro()
        with _bound(module, run):
            run.execute(module, content)
            root = _to_node(run.document.documentElement)
    return Expansion(
        root=root,
        diagnostics=(*run.diagnostics, *_unknown_arguments(run, arguments)),
        declared=tuple(sorted(run.declared)),
        files=tuple(dict.fromkeys(run.files)),
        arguments=dict(run.values),
    )


def _unknown_arguments(run: _Run, arguments: Mapping[str, str]) -> Iterator[Diagnostic]:
    for name in arguments:
        if name not in run.declared:
            yield Diagnostic(
                severity="warning",
                message=f'the argument "{name}" is not declared there and has no effect. '
                + suggestion(name, sorted(run.declared)),
                origin=Origin(file=run.file),
            )


class _Document(minidom.Document):
    """A file's tree, which knows the run that it is part of."""

    def __init__(self, run: _Run) -> None:
        super().__init__()
        self.run = run


class _Element(minidom.Element):
    """An element that knows the place it was written at, and so do its clones."""

    origin: Origin

    def cloneNode(self, deep: bool) -> _Element:  # noqa: N802, ARG002 (the DOM's own signature)
        """A deep copy: of a macro's body for a call, or of a block that is inserted."""
        if self.tagName == "xacro:macro" and isinstance(self.ownerDocument, _Document):
            return self.ownerDocument.run.copy_body(self)
        return _clone(self, None)


@dataclass(kw_only=True)
class _Run:
    """One expansion in progress."""

    file: str
    packages: Packages
    arguments: dict[str, str]
    values: dict[str, str] = field(default_factory=dict)
    """Of the arguments, given or by their defaults, as far as they were met."""
    diagnostics: list[Diagnostic] = field(default_factory=list)
    declared: set[str] = field(default_factory=set)
    files: list[str] = field(default_factory=list)
    place: _Element | None = None
    """The element that was looked at last."""
    calls: list[_Element] = field(default_factory=list)
    """The macro calls in progress, outermost first."""
    symbols: Any = None
    macros: Any = None
    made: int = 0
    document: Any = None

    def execute(self, module: ModuleType, content: bytes | str) -> None:
        """Parses and expands; every failure leaves as a `DescriptionError`."""
        file = self.packages.file
        module.init_stacks(str(file) if file is not None else None)
        self.document = _parse(content, self.file, self)
        self.place = self.document.documentElement
        try:
            # xacro puts the defaults in there, and forgets the mapping in the end.
            self.values = dict(self.arguments)
            module.process_doc(self.document, mappings=self.values, verbosity=0)
        except CartwheelError as error:
            raise self._placed(error) from error
        except Exception as error:
            inner = _described(error)
            if inner is not None:
                raise self._placed(inner) from error
            raise self._failure(error) from error

    def origin(self) -> Origin:
        """The place of what is being evaluated."""
        return self.place.origin if self.place is not None else Origin(file=self.file)

    def warn(self, message: str) -> None:
        """Takes a message of xacro's, once for each place."""
        # What is deprecated works; nobody is to write it anew, and few can change it.
        severity: Severity = "info" if "deprecated" in message else "warning"
        diagnostic = Diagnostic(severity=severity, message=message, origin=self.origin())
        if diagnostic not in self.diagnostics:
            self.diagnostics.append(diagnostic)

    def warn_at(self, message: str, element: _Element) -> None:
        """Takes a warning of one element."""
        self.diagnostics.append(
            Diagnostic(severity="warning", message=message, origin=element.origin)
        )

    def copy_body(self, body: _Element) -> _Element:
        """A macro's body for the call in progress, noted in all its elements."""
        call = self.calls[-1]
        copy = _clone(body, (f"{call.origin} {call.tagName}", *call.origin.stack))
        self.made += len(copy.getElementsByTagName("*"))
        if self.made > MAX_ELEMENTS:
            raise DescriptionError(
                f"the macros make more than {MAX_ELEMENTS} elements", origin=self.origin()
            )
        return copy

    def _placed(self, error: CartwheelError) -> CartwheelError:
        if error.origin is None:
            error.origin = self.origin()
        return error

    def _failure(self, error: Exception) -> DescriptionError:
        call = self.calls[-1] if self.calls else None
        return explain(
            Failure(
                error=error,
                origin=self.origin(),
                call=call.origin if call is not None else None,
                call_tag=call.tagName if call is not None else "",
                macros=tuple(sorted(_names(self.macros))),
                properties=tuple(sorted(_names(self.symbols))),
                arguments=tuple(sorted(self.declared)),
                parameters=self._parameters(call),
            )
        )

    def _parameters(self, call: _Element | None) -> tuple[str, ...]:
        if call is None or self.macros is None:
            return ()
        try:
            macro = self.macros[call.tagName.removeprefix(PREFIX)]
            return tuple(str(name) for name in macro.params)
        except (KeyError, AttributeError):
            return ()


def _described(error: BaseException | None) -> CartwheelError | None:
    """The error of ours that xacro wrapped in its own, if there is one."""
    for _ in range(50):
        if error is None or isinstance(error, CartwheelError):
            return error
        error = getattr(error, "exc", None)
    return None


def _names(table: Any) -> Iterator[str]:
    """The names defined in a table of xacro and in those around it, xacro's own excepted."""
    root = getattr(table, "root", None)
    while table is not None and table is not root:
        yield from (str(name).lstrip("*") for name in dict.keys(table))
        table = getattr(table, "parent", None)


def _parse(content: bytes | str, file: str, run: _Run) -> _Document:
    """The tree that xacro works on; comments are left out."""
    run.files.append(file)
    builder = _DomBuilder(file, run)
    xml.run_expat(content, file, builder)
    root: Any = builder.document.documentElement
    if not root.hasAttribute("xmlns:xacro") and any(
        element.tagName.startswith(PREFIX) for element in root.getElementsByTagName("*")
    ):
        message = 'xmlns:xacro="http://www.ros.org/wiki/xacro" is missing in the root element'
        run.diagnostics.append(
            Diagnostic(
                severity="warning",
                message=f"{message}: ROS's own xacro refuses the file",
                origin=root.origin,
            )
        )
    prefixed(root, run.warn_at)
    return builder.document


class _DomBuilder:
    def __init__(self, file: str, run: _Run) -> None:
        self.document = _Document(run)
        self._file = file
        self._open: list[Any] = [self.document]

    def start(self, tag: str, attributes: dict[str, str], line: int) -> None:
        element = _Element(tag)
        element.ownerDocument = self.document
        element.origin = Origin(file=self._file, line=line)
        for name, value in attributes.items():
            _set(element, name, value)
        self._open[-1].appendChild(element)
        self._open.append(element)

    def end(self) -> None:
        self._open.pop()

    def data(self, text: str) -> None:
        self._open[-1].appendChild(self.document.createTextNode(text))


def _set(element: _Element, name: str, value: str) -> None:
    """Gives an element an attribute; ``xacro:name`` is another than ``name``."""
    prefix, colon, _ = name.partition(":")
    if colon:
        # By the prefix in place of its namespace: the DOM compares no more than that.
        element.setAttributeNS(prefix, name, value)
    else:
        element.setAttribute(name, value)


def _clone(element: Any, stack: tuple[str, ...] | None) -> _Element:
    """A deep copy; with a stack, one that a macro call makes of the macro's body."""
    copy = _Element(element.tagName)
    copy.ownerDocument = element.ownerDocument
    origin = element.origin
    copy.origin = (
        origin if stack is None else Origin(file=origin.file, line=origin.line, stack=stack)
    )
    for name, value in element.attributes.items():
        _set(copy, name, value)
    for child in element.childNodes:
        if isinstance(child, _Element):
            copy.appendChild(_clone(child, stack))
        else:
            copy.appendChild(element.ownerDocument.createTextNode(child.data))
    return copy


def _to_node(element: Any) -> Node:
    children, texts = [], []
    for child in element.childNodes:
        if isinstance(child, _Element):
            children.append(_to_node(child))
        else:
            texts.append(child.data)
    return Node(
        element.tagName,
        # What <xacro:attribute> sets may be a number.
        {name: str(value) for name, value in element.attributes.items()},
        element.origin,
        children,
        "".join(texts).strip(),
    )


def _replace(node: Any, by: Any, content_only: bool = False) -> None:
    """Puts elements, or what is in them, in a node's place.

    xacro's own function moves them one by one, each in a time that grows with the number of
    its siblings.
    """
    parent = node.parentNode
    new: list[Any] = []
    for source in by if isinstance(by, list) else [by] if by is not None else []:
        if content_only:
            new.extend(source.childNodes)
            del source.childNodes[:]
        else:
            if source.parentNode is not None:
                source.parentNode.removeChild(source)
            new.append(source)
    index = parent.childNodes.index(node)
    parent.childNodes[index : index + 1] = new
    ends = [node.previousSibling, *new, node.nextSibling]
    for before, after in pairwise(ends):
        if before is not None:
            before.nextSibling = after
        if after is not None:
            after.previousSibling = before
    for child in new:
        child.parentNode = parent
    node.parentNode = node.previousSibling = node.nextSibling = None


_module: ModuleType | None = None


def _private_xacro() -> ModuleType:
    """The copy of xacro's module; made at the first use, since importing it takes a while."""
    global _module
    if _module is None:
        folder = _folder()
        _module = _copy_of(_NAME, folder / "__init__.py")
        _module.substitution = _copy_of(  # type: ignore[attr-defined]
            f"{_NAME}.substitution_args", folder / "substitution_args.py"
        )
    return _module


def _folder() -> Path:
    """Where the xacro lies that Cartwheel needs.

    A sourced ROS workspace puts modules of its own before it, an older xacro among them.
    """
    for entry in sys.path:
        folder = Path(entry, "xacro")
        if (folder / "substitution_args.py").is_file():
            return folder
    raise DescriptionError(
        "the Python package xacro 2 is missing",
        hint="pip install 'xacro>=2.1', or install Cartwheel again.",
    )


def _copy_of(name: str, file: Path) -> ModuleType:
    is_package = file.name == "__init__.py"
    spec = importlib.util.spec_from_file_location(
        name, file, submodule_search_locations=[str(file.parent)] if is_package else None
    )
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    # Its own modules find each other by this name, whatever else is called xacro.
    sys.modules[name] = module
    spec.loader.exec_module(module)
    return module


@contextmanager
def _bound(module: ModuleType, run: _Run) -> Iterator[None]:
    """Lets the copy of xacro work for one run, and leaves nothing of the run in it."""
    originals = dict(vars(module))
    found = module.substitution._eval_find
    try:
        _bind(module, run)
        yield
    finally:
        vars(module).clear()
        vars(module).update(originals)
        module.substitution._eval_find = found
        module.substitution_args_context.clear()
        module.all_includes.clear()
        vars(module).update(filestack=None, macrostack=None)


def _bind(module: ModuleType, run: _Run) -> None:
    space: Any = module
    substitution = module.substitution
    original = SimpleNamespace(**vars(module))

    def parse(_: object, filename: str) -> minidom.Document:
        path = Path(filename)
        if not path.is_file() and not path.is_dir():
            # The caller recognises a missing file, which may be optional, by this exception,
            # and expects its entry to be gone from the stack.
            space.filestack.pop()
            missing = FileNotFoundError(2, "no such file", filename)
            raise space.XacroException("included file", exc=missing)
        return _parse(xml.read_bytes(path), xml.shown_path(path), run)

    def abs_filename_spec(given: str) -> str:
        path = original.abs_filename_spec(given)
        return str(path) if glob.has_magic(path) else str(source_of(Path(path)))

    def eval_extension(text: str) -> str:
        text = text.replace("$(find-pkg-share ", "$(find ")
        context = module.substitution_args_context
        words = text[2:-1].split()
        if words == ["cwd"]:
            return str(Path.cwd())
        if words[:1] == ["arg"] and words[-1] in context.get("arg", {}):
            run.declared.add(words[-1])
        if space.filestack and space.filestack[-1]:
            context["filename"] = space.filestack[-1]
        try:
            return str(substitution.resolve_args(text, context=context))
        except substitution.ArgException as error:
            raise space.XacroException("Undefined substitution argument", exc=error) from error

    def eval_text(text: str | None, symbols: object) -> object:
        # Most texts hold no expression, and xacro's lexer is slow to find that out.
        if text is not None and "$" not in text:
            return text
        return original.eval_text(text, symbols)

    def eval_all(node: _Element, macros: object, symbols: object) -> None:
        run.place, run.macros, run.symbols = node, macros, symbols
        original.eval_all(node, macros, symbols)
        run.macros, run.symbols = macros, symbols

    def check_attrs(tag: _Element, required: list[str], optional: list[str]) -> list[str | None]:
        run.place = tag
        if tag.tagName == "xacro:arg" and tag.hasAttribute("name"):
            run.declared.add(tag.getAttribute("name"))
        result: list[str | None] = original.check_attrs(tag, required, optional)
        return result

    def handle_macro_call(node: _Element, macros: object, symbols: object) -> object:
        if not node.tagName.startswith(PREFIX):
            said = call_prefixed(node, macros, (call.tagName for call in run.calls))
            if not said:
                return original.handle_macro_call(node, macros, symbols)
            if all(said != each.message for each in run.diagnostics):
                run.warn_at(said, node)
        run.place, run.macros, run.symbols = node, macros, symbols
        if node.tagName == "xacro:call":
            return original.handle_macro_call(node, macros, symbols)
        run.calls.append(node)
        result = original.handle_macro_call(node, macros, symbols)
        run.calls.pop()
        return result

    def message(*parts: object, **_: object) -> None:
        run.warn(" ".join(str(part) for part in parts))

    def warning(*parts: object, **_: object) -> None:
        run.warn(" ".join(str(part) for part in parts))

    def error(*parts: object, **_: object) -> None:
        run.warn(" ".join(str(part) for part in parts))

    def print_location(*_: object) -> None:
        """Diagnostics know their place already."""

    def remove_previous_comments(_: object) -> None:
        """Comments are left out when parsing."""

    # Names count: xacro offers the messages to expressions by their function's own name.
    functions: tuple[Callable[..., object], ...] = (
        parse, eval_extension, eval_text, eval_all, check_attrs, handle_macro_call,
        message, warning, error, print_location, remove_previous_comments, abs_filename_spec,
    )  # fmt: skip
    vars(module).update({function.__name__: function for function in functions})
    vars(module).update(replace_node=_replace)
    substitution._eval_find = lambda name: str(run.packages.find(name, run.origin()))
    substitution._eval_dict["find"] = substitution._eval_find
    module._global_symbols = module.create_global_symbols()  # type: ignore[attr-defined]
