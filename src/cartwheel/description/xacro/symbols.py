"""Names in xacro's expressions: functions, `$(eval …)`, and YAML with units."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

from cartwheel import yaml_text
from cartwheel.codes.files import YAML_MALFORMED
from cartwheel.description.elements import xml
from cartwheel.description.expressions import BUILTINS, MATH, Evaluator, Function
from cartwheel.errors import DescriptionError, Origin

_GLOBAL = ["list", "dict", "map", "len", "str", "float", "int", "bool", "min", "max", "round"]
_DEPRECATED = (
    ("python", "sorted"), ("python", "range"), ("xacro", "load_yaml"), ("xacro", "abs_filename"),
    ("xacro", "dotify"),
)  # fmt: skip
_MESSAGES = frozenset({"message", "warning", "error", "print_location"})


def symbols_of(
    module: Any,
    functions: Mapping[str, Callable[..., Any]],
    *,
    deprecated: Callable[[str, str], None],
) -> dict[str, Any]:
    """The names in all expressions: xacro's own, with limited functions.

    Args:
        module: The copy of xacro's module.
        functions: Functions in the namespace ``xacro``.
        deprecated: Reports the use of a deprecated name; its second argument is the current name.
    """

    def offered(name: str, plain: Callable[..., Any]) -> Function:
        def run(evaluator: Evaluator, *args: Any, **named: Any) -> Any:
            for each in args:
                evaluator.budget.weigh(each)
            found = plain(*args, **named)
            return "" if name in _MESSAGES else evaluator.budget.result(found)

        return Function(f"xacro.{name}", run)

    def outside(space: str, name: str) -> Function:
        current = spaces[space][name]

        def run(evaluator: Evaluator, *args: Any, **named: Any) -> Any:
            deprecated(name, f"{space}.{name}")
            return current.run(evaluator, *args, **named)

        return Function(name, run)

    own = {name: offered(name, plain) for name, plain in functions.items()}
    contents = {"python": BUILTINS, "math": MATH, "xacro": own}
    spaces = {name: module.NameSpace() for name in contents}
    for name, content in contents.items():
        dict.update(spaces[name], content)
    return {
        **spaces,
        **MATH,
        **{name: BUILTINS[name] for name in _GLOBAL},
        **{name: outside(space, name) for space, name in _DEPRECATED},
    }


def eval_extension_of(substitution: Any, evaluator: Evaluator) -> Callable[..., str]:
    """The evaluator of ``$(eval …)``, whose names are the arguments and a few functions."""

    def plain(name: str, called: Callable[..., Any]) -> Function:
        return Function(name, lambda _, *args: called(*args))

    def run(text: str, context: dict[str, Any]) -> str:
        given = context.setdefault("arg", {})

        def value(name: str) -> object:
            return substitution.convert_value(substitution._eval_arg(name, given), "auto")

        names = {
            **{name: BUILTINS[name] for name in ("list", "dict", "map", "str", "float", "int")},
            **MATH,
            "true": True, "false": False,
            "env": plain("env", substitution._eval_env),
            "optenv": plain("optenv", substitution._eval_optenv),
            "find": plain("find", substitution._eval_find),
            "arg": plain("arg", value),
            "dirname": plain("dirname", lambda: substitution._eval_dirname(context["filename"])),
        }  # fmt: skip
        found = evaluator.evaluate(text, _Arguments(names, given, value))
        return str(found)

    return run


class _Arguments(dict[str, Any]):
    """Names in ``$(eval …)``: given names first, then the arguments."""

    def __init__(
        self, names: dict[str, Any], given: Mapping[str, str], value: Callable[[str], Any]
    ) -> None:
        super().__init__(names)
        self._given = given
        self._value = value

    def __missing__(self, name: str) -> Any:
        if name not in self._given:
            raise KeyError(name)
        return self._value(name)


_UNITS = {
    "!radians": 1.0, "!degrees": math.pi / 180.0, "!meters": 1.0, "!millimeters": 0.001,
    "!foot": 0.3048, "!inches": 0.0254,
}  # fmt: skip


def read_yaml(text: str, path: Path, number: Callable[[str], float]) -> object:
    """The contents of a YAML file; numbers with units are xacro expressions."""
    import yaml

    class Loader(yaml_text.loader()):  # type: ignore[misc]
        """For this file only: xacro itself adds its units to PyYAML's loader."""

    for unit, factor in _UNITS.items():
        Loader.add_constructor(
            unit, lambda loader, node, factor=factor: number(loader.construct_scalar(node)) * factor
        )
    try:
        return yaml.load(text, Loader=Loader)  # noqa: S506 (a SafeLoader)
    except yaml.YAMLError as error:
        mark = getattr(error, "problem_mark", None)
        raise DescriptionError(
            f"the file is not valid YAML: {getattr(error, 'problem', None) or error}",
            code=YAML_MALFORMED,
            origin=Origin(file=xml.shown_path(path), line=mark.line + 1 if mark else 0),
        ) from None
