"""No code goes by the words of a message, except adapters to those of other libraries."""

from __future__ import annotations

import ast
from collections.abc import Iterator
from pathlib import Path

import pytest

SOURCE = Path(__file__).parents[2] / "src"
ADAPTERS = {
    "cartwheel/world/build.py": "MuJoCo",
    "cartwheel/bridges/foxglove/slow.py": "the Foxglove SDK",
}
"""The modules that match the messages of a library, and the library."""
_EXAMINE = frozenset(
    ("startswith", "endswith", "find", "index", "count", "search", "match", "fullmatch", "findall")
)
_LINES = frozenset(("partition", "rpartition", "split", "splitlines", "strip", "lower"))
"""Methods that lead to a part of the text."""


def is_text(node: ast.expr) -> bool:
    """Whether an expression is the text of an error or diagnostic, or a part of it."""
    if isinstance(node, ast.Call) and isinstance(node.func, ast.Attribute):
        if node.func.attr in _LINES:
            return is_text(node.func.value)
        return node.func.attr == "getMessage"
    if isinstance(node, ast.Subscript):
        return is_text(node.value)
    if isinstance(node, ast.Call) and isinstance(node.func, ast.Name) and node.func.id == "str":
        return any(isinstance(each, ast.Name) and "error" in each.id for each in node.args)
    return isinstance(node, ast.Attribute) and node.attr in ("message", "hint", "args")


def examinations(tree: ast.AST) -> Iterator[int]:
    """The lines on which a text is compared or searched."""
    for node in ast.walk(tree):
        if isinstance(node, ast.Compare):
            kinds = (ast.Eq, ast.NotEq, ast.In, ast.NotIn)
            texts = [is_text(each) for each in (node.left, *node.comparators)]
            if any(texts) and any(isinstance(each, kinds) for each in node.ops):
                yield node.lineno
        elif isinstance(node, ast.Call) and isinstance(node.func, ast.Attribute):
            examined = (node.func.value, *node.args)
            if node.func.attr in _EXAMINE and any(map(is_text, examined)):
                yield node.lineno


FILES = sorted(str(file.relative_to(SOURCE)) for file in SOURCE.glob("*/**/*.py"))


@pytest.mark.parametrize("file", FILES)
def test_no_text_of_an_error_is_examined(file: str) -> None:
    tree = ast.parse((SOURCE / file).read_text())
    lines = [f"src/{file}:{line}" for line in examinations(tree)]
    assert bool(lines) is (file in ADAPTERS), f"{lines}: compare the code and the values instead"


def test_adapters_exist() -> None:
    assert set(ADAPTERS) <= set(FILES)


@pytest.mark.parametrize(
    ("code", "found"),
    [
        ('"missing" in str(error)', True),
        ('error.message.startswith("no")', True),
        ('re.search("x", diagnostic.message)', True),
        ('each.hint == "Do it."', True),
        ('str(error).splitlines()[0] == "x"', True),
        ('error.args[0] != "x"', True),
        ("error.code is MISSING", False),
        ('error.values["name"] == "x"', False),
        ('f"{error.message}, so it ends"', False),
        ("if error.hint: pass", False),
    ],
)
def test_an_examination_is_noticed(code: str, found: bool) -> None:
    assert bool(list(examinations(ast.parse(code)))) is found
