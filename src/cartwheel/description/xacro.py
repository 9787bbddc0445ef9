"""Expands xacro with ROS's own implementation, and keeps the place of every element.

The package `xacro` holds the state of an expansion in its module. Each expansion runs that
module's code anew, in a module of its own, which takes 1.5 ms: expansions on several threads
do not meet, and none waits for another. Some functions are replaced in the copy: its parser,
so that elements know their file and line and clones of them the macro calls that made them;
its evaluation of expressions, which runs Python; its look-up of packages; its messages, which
become diagnostics.
"""

from __future__ import annotations

import glob
import itertools
import keyword
import os
import re
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, field, replace
from itertools import pairwise
from pathlib import Path
from types import ModuleType, SimpleNamespace
from typing import Any
from xml.dom import minidom

from cartwheel import yaml_text
from cartwheel.codes import files as codes
from cartwheel.description import xml
from cartwheel.description.expressions import Budget, Evaluator, ExpressionError
from cartwheel.description.installed import source_of
from cartwheel.description.packages import Packages
from cartwheel.description.xacro_errors import Failure, code_of, explain
from cartwheel.description.xacro_module import fresh_xacro
from cartwheel.description.xacro_symbols import eval_extension_of, read_yaml, symbols_of
from cartwheel.description.xacro_unprefixed import PREFIX, call_prefixed, prefixed
from cartwheel.description.xml import Node
from cartwheel.errors import (
    CartwheelError,
    DescriptionError,
    Diagnostic,
    Origin,
    meant,
    suggestion,
)

MAX_ELEMENTS = 100_000
"""Elements that macros may make: some fifty times what the largest robots have."""
MAX_CALLS = 10_000
"""Calls of macros, nested ones included: eight times what the largest robots need."""
MAX_SHOWN = 6
"""Calls that lead to the last one of too many."""
MAX_MATCHES = 1000
"""Files that one include with a wildcard takes."""
_PART_SIZE = 200
"""Characters that stand for the memory of an element, attribute or text."""
MAX_PARAMETERS = 10_000
"""Characters of the parameters that a macro declares."""

_TOKEN = re.compile(r"(\$\$+)(?=[{(])|\$\{([^}]*)\}|\$\(([^)]*)\)|([^$]+|\$[^{($]+|\$\Z)")
"""An escaped ``$$``; an expression; an extension; text."""
NAMESPACE = 'xmlns:xacro="http://www.ros.org/wiki/xacro"'
_NOT_XML = re.compile(r"[^\t\n\r\x20-\ud7ff\ue000-\ufffd\U00010000-\U0010ffff]")
_PARAMETER = re.compile(
    r"""\s*([^\s:=]+?)\s*:?=\s*(\^\|?)?"""
    r"""(\$\{[^}]*\}|\$\([^)]*\)|(?:'[^']*'|"[^"]*"|[^\s'"]++)++|)(?:\s+|$)"""
)
"""A macro's parameter with a default. It does not go back, for a line of quotes has as many
readings as there are ways to part it."""


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
    run = _Run(file=file, packages=packages, arguments=dict(arguments))
    module = fresh_xacro()
    _bind(module, run)
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
            known = sorted(run.declared)
            yield codes.ARGUMENT_UNKNOWN.diagnostic(
                f'the argument "{name}" is not declared and has no effect',
                origin=Origin(file=run.file),
                hint=suggestion(name, known),
                values={"name": name, "meant": meant(name, known)},
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
        copy = _clone(self, None)
        if isinstance(self.ownerDocument, _Document):
            self.ownerDocument.run.count(copy)
        return copy


@dataclass(kw_only=True)
class _Run:
    """One expansion in progress."""

    file: str
    packages: Packages
    arguments: dict[str, str]
    values: dict[str, str] = field(default_factory=dict)
    """Of the arguments, given or by their defaults, as far as they were met."""
    diagnostics: list[Diagnostic] = field(default_factory=list)
    seen: set[Diagnostic] = field(default_factory=set)
    declared: set[str] = field(default_factory=set)
    files: list[str] = field(default_factory=list)
    place: _Element | None = None
    """The element that was looked at last."""
    calls: list[_Element] = field(default_factory=list)
    """The macro calls in progress, outermost first."""
    symbols: Any = None
    macros: Any = None
    made: int = 0
    """Elements, so far."""
    called: int = 0
    """Calls of macros, so far."""
    document: Any = None
    budget: Budget = field(default_factory=Budget)

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
        diagnostic = code_of(message).diagnostic(message, origin=self.origin())
        if diagnostic not in self.seen:
            self.seen.add(diagnostic)
            self.diagnostics.append(diagnostic)

    def warn_of_prefix(self, element: _Element, tag: str, number: int = 1) -> None:
        """Warns of a tag without its prefix, once for each file.

        Args:
            element: The first of them.
            tag: As written.
            number: How many of them the file has.
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
                f"<{tag}> is read as <{PREFIX}{tag}>, but ROS has ignored it since Noetic{more}",
                origin=element.origin,
                hint=f"Write <{PREFIX}{tag}>.",
                values=values,
            )
        )

    def copy_body(self, body: _Element) -> _Element:
        """A macro's body for the call in progress, noted in all its elements.

        Raises:
            DescriptionError: There are too many calls, or too many elements.
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
        copy = _clone(body, (f"{call.origin} {call.tagName}", *call.origin.stack))
        self.count(copy)
        return copy

    def count(self, copy: _Element) -> None:
        """Counts a copy that was made, with its texts, which are not shared in the end.

        Raises:
            DescriptionError: There are too many.
        """
        elements, parts, characters = _size(copy)
        self.made += elements
        self.budget.spend(parts)
        self.budget.make(characters)
        if self.made > MAX_ELEMENTS:
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
    run.budget.make(len(content))
    run.budget.look()
    builder = _DomBuilder(file, run)
    xml.run_expat(content, file, builder)
    root: Any = builder.document.documentElement
    if not root.hasAttribute("xmlns:xacro") and any(
        element.tagName.startswith(PREFIX) for element in root.getElementsByTagName("*")
    ):
        run.diagnostics.append(
            codes.XACRO_NAMESPACE.diagnostic(
                "the root element does not declare xmlns:xacro, so ROS xacro rejects the file",
                origin=root.origin,
                hint=f"Add {NAMESPACE} to it.",
            )
        )
    prefixed(root, run.warn_of_prefix)
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


def _size(element: Any) -> tuple[int, int, int]:
    """Of a tree: elements; all its parts, attributes and texts among them; characters.

    The characters include the memory that the parts take.
    """
    elements, parts, characters, left = 0, 0, 0, [element]
    while left:
        each = left.pop()
        parts += 1
        if isinstance(each, _Element):
            elements += 1
            parts += each.attributes.length
            characters += sum(len(value) for _, value in each.attributes.items())
            left.extend(each.childNodes)
        else:
            characters += len(each.data)
    return elements, parts, characters + _PART_SIZE * parts


def _to_node(element: Any) -> Node:
    children, texts = [], []
    for child in element.childNodes:
        if isinstance(child, _Element):
            children.append(_to_node(child))
        else:
            texts.append(child.data)
    # What <xacro:attribute> sets may be a number.
    values = {name: str(value) for name, value in element.attributes.items()}
    text = "".join(texts).strip()
    for each in (*values, *values.values(), text):
        if found := _NOT_XML.search(each):
            raise DescriptionError(
                f"the expanded text contains the character {found[0]!a}, which XML does not allow",
                code=codes.XACRO_INVALID,
                values={"character": f"U+{ord(found[0]):04X}"},
                origin=element.origin,
            )
    return Node(element.tagName, values, element.origin, children, text)


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


def _bind(module: ModuleType, run: _Run) -> None:
    space: Any = module
    substitution = module.substitution
    original = SimpleNamespace(**vars(module))

    def parse(_: object, filename: str) -> minidom.Document:
        path = Path(filename)
        if not path.exists():
            # The caller recognises a missing file, which may be optional, by this exception,
            # and expects its entry to be gone from the stack.
            space.filestack.pop()
            missing = FileNotFoundError(2, "no such file", filename)
            raise space.XacroException("included file", exc=missing)
        run.packages.require(path, "the included file", run.origin())
        if not path.is_file():
            what = "is a folder" if path.is_dir() else "is not a regular file"
            raise DescriptionError(
                f'the included file "{filename}" {what}',
                code=codes.FILE_UNREADABLE,
                origin=run.origin(),
                values={"name": filename},
            )
        return _parse(xml.read_bytes(path), xml.shown_path(path), run)

    def abs_filename_spec(given: str) -> str:
        path = original.abs_filename_spec(given)
        return str(path) if glob.has_magic(path) else str(source_of(Path(path)))

    def matching(pattern: str) -> list[str]:
        fixed = Path(re.split(r"[][*?]", pattern)[0] + "_").parent
        if ".." in Path(pattern[len(str(fixed)) :]).parts:
            raise DescriptionError(
                f'"{pattern}" contains .. after a wildcard', code=codes.FILE_NOT_ALLOWED
            )
        if fixed.exists():
            run.packages.require(fixed, "the folder", run.origin())
        return list(itertools.islice(glob.iglob(pattern), MAX_MATCHES))  # noqa: PTH207

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

    def eval_text(text: str | None, symbols: Any) -> object:
        # Most texts hold no expression.
        if not text or "$" not in text:
            return text or ""
        run.budget.spend()
        results: list[object] = []
        at = 0
        while at < len(text):
            token = _TOKEN.match(text, at)
            if token is None:
                raise space.XacroException("invalid expression: " + text[at:])
            at = token.end()
            dollars, expression, extension, plain = token.groups()
            if expression is not None:
                results.append(eval_expression(expression, symbols))
            elif extension is not None:
                results.append(eval_extension(f"$({eval_text(extension, symbols)})"))
            else:
                results.append(plain if dollars is None else dollars[1:])
        if len(results) == 1:
            return results[0]
        parts = [str(each) for each in results]
        run.budget.text(sum(map(len, parts)))
        return "".join(parts)

    def eval_expression(text: str, symbols: Any) -> object:
        shown = text.strip() if len(text) < 200 else f"{text[:200].strip()} …"
        try:
            return evaluator.evaluate(str(eval_text(text, symbols)), symbols)
        except ExpressionError as error:
            if "expression" in error.values:
                raise
            raise ExpressionError(
                f"{error.message}, when evaluating ${{{shown}}}",
                code=error.code,
                hint=error.hint,
                values={**error.values, "expression": shown},
            ) from error
        except Exception as error:
            raise space.XacroException(
                exc=error, suffix=f"\nwhen evaluating expression '{shown}'"
            ) from error

    def is_valid_name(name: str) -> bool:
        return name.isidentifier() and not keyword.iskeyword(name)

    def parse_macro_arg(text: str) -> tuple[str, tuple[str | None, str | None] | None, str]:
        if len(text) > MAX_PARAMETERS:
            raise ExpressionError(
                f"a macro's parameters have more than {MAX_PARAMETERS} characters",
                values={"kind": "parameters", "most": MAX_PARAMETERS},
            )
        found = _PARAMETER.match(text)
        if found is None:
            name, *rest = text.split(None, 1)
            return name, None, rest[0] if rest else ""
        name, forward, default = found.groups()
        return name, (name if forward else None, default or None), text[found.end() :]

    def load_yaml(filename: str) -> object:
        path = Path(abs_filename_spec(str(filename)))
        if path.exists():
            run.packages.require(path, "the file", run.origin())
        try:
            content = yaml_text.read(path)
        except FileNotFoundError:
            raise
        except (OSError, UnicodeDecodeError) as error:
            reason = error if isinstance(error, OSError) else "it is not UTF-8"
            raise DescriptionError(
                f'"{xml.shown_path(path)}" cannot be read: {reason}', code=codes.FILE_UNREADABLE
            ) from None
        run.budget.make(len(content))
        run.budget.look()
        space.filestack.append(str(path))
        try:
            return wrapped(read_yaml(content, path, number))
        finally:
            space.filestack.pop()
            space.all_includes.append(str(path))

    def number(text: str) -> float:
        """A number of YAML with a unit, which may be an expression."""
        return float(evaluator.evaluate(text, symbols))

    def wrapped(value: object) -> object:
        return space.YamlListWrapper.wrap(value)

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
            tag = node.tagName
            if not call_prefixed(node, macros, (call.tagName for call in run.calls)):
                return original.handle_macro_call(node, macros, symbols)
            run.warn_of_prefix(node, tag)
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

    def fatal(*parts: object) -> None:
        raise space.XacroException(" ".join(str(part) for part in parts))

    def tokenize(text: str, sep: str = ",; ", skip_empty: bool = True) -> list[str]:
        if re.search(r"[][\\]", sep):
            raise ExpressionError(
                "the separators of xacro.tokenize contain a bracket or backslash",
                values={"refused": sep},
            )
        words = re.split(f"[{sep}]", text)
        return [word for word in words if word] if skip_empty else words

    def argument(name: str) -> object:
        return space.substitution_args_context["arg"][name]

    def print_location(*_: object) -> None:
        """Diagnostics know their place already."""

    def remove_previous_comments(_: object) -> None:
        """Comments are left out when parsing."""

    functions: tuple[Callable[..., object], ...] = (
        parse, eval_extension, eval_text, eval_all, check_attrs, handle_macro_call,
        message, warning, error, print_location, remove_previous_comments, abs_filename_spec,
        is_valid_name, parse_macro_arg, load_yaml,
    )  # fmt: skip
    vars(module).update({function.__name__: function for function in functions})
    vars(module).update(replace_node=_replace, glob=SimpleNamespace(glob=matching))
    if run.packages.reach is not None and not run.packages.reach.environment:
        substitution.os = SimpleNamespace(environ={}, path=os.path)
    substitution._eval_find = lambda name: str(run.packages.find(name, run.origin()))

    evaluator = Evaluator(run.budget, namespace=space.NameSpace, dotted=space.YamlDictWrapper)
    symbols = symbols_of(
        space,
        {
            "load_yaml": load_yaml, "abs_filename": abs_filename_spec,
            "dotify": space.YamlDictWrapper, "arg": argument, "message": message,
            "warning": warning, "error": error, "print_location": print_location,
            "fatal": fatal, "tokenize": tokenize,
        },
    )  # fmt: skip
    space._global_symbols = symbols
    substitution._eval = eval_extension_of(substitution, evaluator)
