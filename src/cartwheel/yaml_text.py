"""Loads untrusted YAML with limits on file size and number of values.

PyYAML's own loader expands aliases without limit: 400 bytes can represent more values than fit into
memory when something iterates over them.
"""

from __future__ import annotations

import ast
import math
import operator
import re
from collections.abc import Callable, Mapping
from functools import lru_cache
from pathlib import Path
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    import yaml

MAX_BYTES = 2_000_000
"""Maximum file size. The largest parameter files of public robots are 100 kB."""
MAX_DEPTH = 50
MAX_VALUES = 200_000
"""Maximum number of values in a document, including values repeated by aliases."""
_ANGLES = {"deg": math.pi / 180.0, "rad": 1.0}
"""Factors to radians by the function's name in a file of rosparam."""
_LONGEST_ANGLE = 100
"""Maximum length of the text of an angle."""
_EXPONENT = re.compile(r"[-+]?(?:\d+\.?\d*|\.\d+)[eE][-+]?\d+")
"""Numbers that YAML 1.1 reads as texts if the dot or the sign of the exponent is missing."""
_OPERATIONS: Mapping[type[ast.operator], Callable[[float, float], float]] = {
    ast.Add: operator.add,
    ast.Sub: operator.sub,
    ast.Mult: operator.mul,
    ast.Div: operator.truediv,
}


def read(path: Path, limit: int = MAX_BYTES) -> str:
    """The text of a YAML file.

    Raises:
        OSError: The file cannot be read, is not a regular file, or is larger than the limit.
        UnicodeDecodeError: The file is not valid UTF-8.
    """
    if not path.exists():
        raise FileNotFoundError(2, "No such file or directory", str(path))
    if not path.is_file():
        raise OSError("it is not a regular file")
    with path.open("rb") as file:
        content = file.read(limit + 1)
    if len(content) > limit:
        raise OSError(f"it is larger than {limit / 1e6:g} MB")
    return content.decode()


def load(text: str) -> Any:
    """Loads a YAML document: mappings, lists, strings, numbers and dates.

    Raises:
        yaml.YAMLError: The YAML is invalid or exceeds the limits.
    """
    import yaml

    return yaml.load(text, Loader=loader())  # noqa: S506 (a SafeLoader with bounds)


def fault(error: OSError | UnicodeDecodeError | yaml.YAMLError) -> tuple[str, int]:
    """Returns why a file cannot be read as YAML, as a sentence, and the line; 0 if unknown."""
    if isinstance(error, OSError):
        return f"the file cannot be read: {error.strerror or error}", 0
    if isinstance(error, UnicodeDecodeError):
        return "the file is not a text file", 0
    mark, problem = getattr(error, "problem_mark", None), getattr(error, "problem", None)
    text = f"the file is not valid YAML{f': {problem}' if problem else ''}"
    return text, mark.line + 1 if mark is not None else 0


@lru_cache(maxsize=1)
def loader() -> type[yaml.SafeLoader]:
    """A `yaml.SafeLoader` class with limits, for ``yaml.load`` and ``yaml.compose``.

    It is created at first use because importing yaml is slow.
    """
    import yaml

    class Loader(yaml.SafeLoader):
        def __init__(self, stream: Any) -> None:
            super().__init__(stream)
            self._depth = 0
            self._values = 0
            self._sizes: dict[int, int] = {}

        def compose_node(self, parent: Any, index: Any) -> Any:
            event: Any = self.peek_event()  # type: ignore[no-untyped-call]
            if self._depth >= MAX_DEPTH:
                raise yaml.composer.ComposerError(
                    None, None, f"nested more than {MAX_DEPTH} levels deep", event.start_mark
                )
            before = self._values
            mark: Any = event.start_mark
            self._depth += 1
            node = super().compose_node(parent, index)
            self._depth -= 1
            if isinstance(event, yaml.AliasEvent):
                if id(node) not in self._sizes:
                    raise yaml.composer.ComposerError(
                        None, None, f"the alias *{event.anchor} contains itself", mark
                    )
                self._values += self._sizes[id(node)]
            else:
                self._values += 1
                self._sizes[id(node)] = self._values - before
            if self._values > MAX_VALUES:
                raise yaml.composer.ComposerError(
                    None,
                    None,
                    f"more than {MAX_VALUES:,} values, with those of its aliases",
                    mark,
                )
            return node

        def construct_object(self, node: Any, deep: bool = False) -> Any:
            try:
                return super().construct_object(node, deep)
            except (ValueError, OverflowError) as error:  # an invalid date such as 2001-99-99
                problem = str(error)
            except (LookupError, TypeError, AttributeError):  # such as !!int with an empty text
                problem = f'expected a value of type "{node.tag.rpartition(":")[2]}"'
            raise yaml.constructor.ConstructorError(None, None, problem, node.start_mark)

    return Loader


@lru_cache(maxsize=1)
def rosparam_loader() -> type[yaml.SafeLoader]:
    """As `loader`, for the files that ROS 1 reads with rosparam.

    They may contain angles such as ``!degrees 90``, ``!radians pi/2``, ``deg(90)`` and
    ``rad(pi/2)``, which are loaded as numbers in rad.
    """

    class Loader(loader()):  # type: ignore[misc]
        pass

    for tag, name in (("!degrees", "deg"), ("!radians", "rad")):
        Loader.add_constructor(tag, _angle_constructor(_ANGLES[name]))
        pattern = re.compile(rf"^{name}\([^)]*\)$")
        Loader.add_implicit_resolver(tag, pattern, [name[0]])
    return Loader


def as_ros2(node: Any) -> None:
    """Merges mappings with the same key and reads ``1e6`` as a number, as ROS 2 does.

    In YAML 1.1, and in ROS 1, the last of the mappings is used, and ``1e6`` is a text.

    Args:
        node: The root of a composed YAML document, which is changed.
    """
    _as_ros2(node, {})


def _as_ros2(node: Any, seen: dict[int, Any]) -> None:
    """As `as_ros2`; `seen` contains the finished nodes by their identity."""
    if id(node) in seen:
        return
    seen[id(node)] = node
    if node.id == "scalar":
        if node.style is None and _EXPONENT.fullmatch(node.value):
            node.tag = "tag:yaml.org,2002:float"
        return
    if node.id == "mapping":
        node.value = _merged(node)
    for each in node.value:
        _as_ros2(each[1] if node.id == "mapping" else each, seen)


def _merged(mapping: Any) -> list[tuple[Any, Any]]:
    """The pairs of a mapping, in which mappings with the same key are one.

    Aliases may refer to a mapping several times, and it may be merged with itself. It is therefore
    copied: otherwise, a file of 200 bytes could double it until the memory is full.
    """
    kept: list[tuple[Any, Any]] = []
    places: dict[str, int] = {}
    copied: set[int] = set()
    for key, value in mapping.value:
        place = places.get(str(key.value))
        before: Any = None if place is None else kept[place][1]
        if place is None or not before.id == value.id == "mapping":
            places[str(key.value)] = len(kept)
            kept.append((key, value))
            continue
        if place not in copied:
            copied.add(place)
            marks = before.start_mark, before.end_mark
            before = type(before)(before.tag, [*before.value], *marks, before.flow_style)
            kept[place] = kept[place][0], before
        before.value += value.value
    return kept


def _angle_constructor(factor: float) -> Callable[[Any, Any], float]:
    def construct(loader: Any, node: Any) -> float:
        import yaml

        text: str = loader.construct_scalar(node)
        try:
            return _arithmetic(re.sub(r"^(?:deg|rad)\((.*)\)$", r"\1", text.strip())) * factor
        except (SyntaxError, ValueError, ArithmeticError, RecursionError):
            problem = f'expected an angle (got "{text[:_LONGEST_ANGLE]}")'
        raise yaml.constructor.ConstructorError(None, None, problem, node.start_mark)

    return construct


def _arithmetic(text: str) -> float:
    """The value of a sum or product of numbers and ``pi``.

    Raises:
        SyntaxError, ValueError: It contains anything else, or is too long.
        ArithmeticError: It has no value.
    """
    if len(text) > _LONGEST_ANGLE:
        raise ValueError

    def value(node: ast.expr) -> float:
        if isinstance(node, ast.Constant) and isinstance(node.value, int | float):
            return float(node.value)
        if isinstance(node, ast.Name) and node.id == "pi":
            return math.pi
        if isinstance(node, ast.UnaryOp) and isinstance(node.op, ast.UAdd | ast.USub):
            return value(node.operand) * (-1.0 if isinstance(node.op, ast.USub) else 1.0)
        if isinstance(node, ast.BinOp) and type(node.op) in _OPERATIONS:
            return _OPERATIONS[type(node.op)](value(node.left), value(node.right))
        raise ValueError

    return value(ast.parse(text.strip(), mode="eval").body)
