"""Replacements for functions of the xacro package.

They keep the location of elements, evaluate expressions without Python's `eval`, find packages, and
report messages as diagnostics.
"""

from __future__ import annotations

import glob
import itertools
import keyword
import os
import re
from collections.abc import Callable
from pathlib import Path
from types import ModuleType, SimpleNamespace
from typing import TYPE_CHECKING, Any

from cartwheel import yaml_text
from cartwheel.codes import files as codes
from cartwheel.description.elements import xml
from cartwheel.description.expressions import Evaluator, ExpressionError
from cartwheel.description.files.install_rules import source_of
from cartwheel.description.files.other_places import FIND
from cartwheel.description.files.package_folders import stand_in_name
from cartwheel.description.files.ros_environment import RosEnvironment
from cartwheel.description.xacro.absent import LostCall
from cartwheel.description.xacro.dom import Document, Element, replace_node
from cartwheel.description.xacro.errors import ArgumentError
from cartwheel.description.xacro.symbols import eval_extension_of, read_yaml, symbols_of
from cartwheel.description.xacro.unprefixed import PREFIX, call_prefixed
from cartwheel.errors import DescriptionError
from cartwheel.similar_names import suggestion

if TYPE_CHECKING:
    from cartwheel.description.xacro.expansion import Run

MAX_MATCHES = 1000
"""Maximum number of files that an include with a wildcard reads."""
MAX_PARAMETERS = 10_000
"""Maximum number of characters in the parameters of a macro."""

_TOKEN = re.compile(r"(\$\$+)(?=[{(])|\$\{([^}]*)\}|\$\(([^)]*)\)|([^$]+|\$[^{($]+|\$\Z)")
"""An escaped ``$$``, an expression, an extension, or text."""
_PARAMETER = re.compile(
    r"""\s*([^\s:=]+?)\s*:?=\s*(\^\|?)?"""
    r"""(\$\{[^}]*\}|\$\([^)]*\)|(?:'[^']*'|"[^"]*"|[^\s'"]++)++|)(?:\s+|$)"""
)
"""A parameter of a macro with a default. The pattern does not backtrack: there are very many
ways to split a line of quotation marks."""


def replace_functions(module: ModuleType, run: Run) -> None:
    """Replaces functions in a copy of the xacro module, for one expansion."""
    space: Any = module
    substitution = module.substitution
    original = SimpleNamespace(**vars(module))

    def parse(_: object, filename: str) -> Document:
        path = Path(filename)
        if not path.exists():
            # The caller expects this exception for a missing file, which may be optional, and that
            # the entry of the file is no longer in the stack.
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
        return run.parse(xml.read_bytes(path), xml.shown_path(path))

    def active() -> list[str]:
        """The file that is being read, and the files that include it."""
        return [each for each in space.filestack if each]

    def abs_filename_spec(given: str) -> str:
        path = original.abs_filename_spec(given)
        if glob.has_magic(path):
            return str(path)
        found = source_of(Path(path))
        if not found.exists():
            found = (
                run.packages.elsewhere(given, run.origin(), without=active(), use="include")
                or found
            )
        return str(found)

    def process_include(
        element: Element, macros: object, symbols: object, expand: Callable[..., None]
    ) -> None:
        """Leaves out an include whose file is absent, unless it is optional or a pattern."""
        run.place = element
        name = str(eval_text(element.getAttribute("filename"), symbols))
        path = abs_filename_spec(name)
        if (
            not name
            or glob.has_magic(path)
            or Path(path).exists()
            or element.getAttribute("optional")
        ):
            original.process_include(element, macros, symbols, expand)
            return
        found = run.absences.find_include(name, path, element.origin, active=active())
        if found is not None:
            element.setAttribute("filename", str(found))
            original.process_include(element, macros, symbols, expand)
            return
        replace_node(element, by=None)

    def leave_out_call(node: Element, symbols: object) -> None:
        """Leaves out the call of a macro that an absent file would have defined."""
        for name, value in node.attributes.items():
            node.setAttribute(name, str(eval_text(value, symbols)))
        placed = [
            item
            for each in node.childNodes
            if isinstance(each, Element) and each.tagName == "origin"
            for item in each.attributes.items()
        ]
        run.absences.leave_out_call(
            LostCall(
                tag=node.tagName,
                attributes=dict(node.attributes.items()),
                origin=node.origin,
                pose={name: str(eval_text(value, symbols)) for name, value in placed},
            ),
            [PREFIX + name for name in run.macro_names()],
        )
        replace_node(node, by=None)

    def is_defined(name: str, macros: object, symbols: object) -> bool:
        try:
            space.resolve_macro(name, macros, symbols)
        except KeyError:
            return False
        return True

    def ignore_parameters(node: Element, macros: object, symbols: object) -> None:
        """Removes parameters that a stand-in's macro lacks; some release may have them."""
        name = node.tagName.removeprefix(PREFIX)
        if not is_defined(name, macros, symbols):
            return
        _, _, macro = space.resolve_macro(name, macros, symbols)
        package = stand_in_name(Path(macro.body.origin.file).absolute())
        if package is None:
            return
        for parameter in [each for each, _ in node.attributes.items() if each not in macro.params]:
            node.removeAttribute(parameter)
            run.diagnostics.append(
                codes.STAND_IN_PARAMETER.diagnostic(
                    f'the parameter "{parameter}" is ignored because the stand-in for '
                    f'"{package}" does not support it',
                    origin=node.origin,
                    mark=f"{parameter}=",
                    hint=suggestion(parameter, macro.params),
                    values={"package": package, "name": parameter, "macro": node.tagName},
                )
            )

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
            raise space.XacroException(exc=ArgumentError(str(error))) from error

    def eval_text(text: str | None, symbols: Any) -> object:
        # Most texts contain no expression.
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
                f"{error.message} (in the expression ${{{shown}}})",
                code=error.code,
                hint=error.hint,
                values={**error.values, "expression": shown},
            ) from error
        except Exception as error:
            failure = space.XacroException(exc=error)
            failure.expression = shown
            raise failure from error

    def is_valid_name(name: str) -> bool:
        return name.isidentifier() and not keyword.iskeyword(name)

    def parse_macro_arg(text: str) -> tuple[str, tuple[str | None, str | None] | None, str]:
        if len(text) > MAX_PARAMETERS:
            raise ExpressionError(
                f"a macro's parameters are longer than {MAX_PARAMETERS} characters",
                values={"kind": "parameters", "most": MAX_PARAMETERS},
            )
        found = _PARAMETER.match(text)
        if found is None:
            name, *rest = text.split(None, 1)
            return name, None, rest[0] if rest else ""
        name, forward, default = found.groups()
        return name, (name if forward else None, default or None), text[found.end() :]

    def load_yaml(filename: str) -> object:
        if not str(filename).strip():
            raise DescriptionError(
                "the name of the YAML file is empty",
                code=codes.FILE_UNREADABLE,
                hint="It may be an argument that a launch file passes.",
            )
        path = Path(abs_filename_spec(str(filename)))
        lacking = FIND.search(str(filename))
        if path.exists():
            run.packages.require(path, "the file", run.origin())
        try:
            content = yaml_text.read(path)
        except FileNotFoundError:
            if lacking is not None:
                # Raises the error for the package that `Absences.find` did not find.
                run.packages.find(lacking[1], run.origin())
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
        """Evaluates a number with a unit in YAML, which can be an expression."""
        return float(evaluator.evaluate(text, symbols))

    def wrapped(value: object) -> object:
        return space.YamlListWrapper.wrap(value)

    def eval_all(node: Element, macros: object, symbols: object) -> None:
        run.place, run.macros, run.symbols = node, macros, symbols
        original.eval_all(node, macros, symbols)
        run.macros, run.symbols = macros, symbols

    def check_attrs(tag: Element, required: list[str], optional: list[str]) -> list[str | None]:
        run.place = tag
        if tag.tagName == "xacro:arg" and tag.hasAttribute("name"):
            run.declared.add(tag.getAttribute("name"))
        result: list[str | None] = original.check_attrs(tag, required, optional)
        return result

    def handle_macro_call(node: Element, macros: object, symbols: object) -> object:
        if not node.tagName.startswith(PREFIX):
            tag = node.tagName
            if not call_prefixed(node, macros, (call.tagName for call in run.calls)):
                return original.handle_macro_call(node, macros, symbols)
            run.warn_of_prefix(node, tag)
        run.place, run.macros, run.symbols = node, macros, symbols
        if node.tagName == "xacro:call":
            return original.handle_macro_call(node, macros, symbols)
        if run.absences.may_define_macros and not is_defined(
            node.tagName.removeprefix(PREFIX), macros, symbols
        ):
            leave_out_call(node, symbols)
            return True
        ignore_parameters(node, macros, symbols)
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
        """Does nothing: diagnostics contain the location."""

    def remove_previous_comments(_: object) -> None:
        """Does nothing: the parser ignores comments."""

    functions: tuple[Callable[..., object], ...] = (
        parse, eval_extension, eval_text, eval_all, check_attrs, handle_macro_call,
        message, warning, error, print_location, remove_previous_comments, abs_filename_spec,
        is_valid_name, parse_macro_arg, load_yaml, process_include,
    )  # fmt: skip
    vars(module).update({function.__name__: function for function in functions})
    vars(module).update(replace_node=replace_node, glob=SimpleNamespace(glob=matching))
    hidden = run.packages.reach is not None and not run.packages.reach.environment
    variables = RosEnvironment({} if hidden else os.environ, run.packages.file, run.assume)
    substitution.os = SimpleNamespace(environ=variables, path=os.path)
    substitution._eval_find = lambda name: run.absences.find(name, run.origin())

    evaluator = Evaluator(run.budget, namespace=space.NameSpace, dotted=space.YamlDictWrapper)
    symbols = symbols_of(
        space,
        {
            "load_yaml": load_yaml, "abs_filename": abs_filename_spec,
            "dotify": space.YamlDictWrapper, "arg": argument, "message": message,
            "warning": warning, "error": error, "print_location": print_location,
            "fatal": fatal, "tokenize": tokenize,
        },
        deprecated=run.warn_of_deprecated,
    )  # fmt: skip
    space._global_symbols = symbols
    substitution._eval = eval_extension_of(substitution, evaluator)
