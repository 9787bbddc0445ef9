"""No code goes by the words of a message, except adapters to those of other libraries.

Nor does a test, unless it has the mark `wording`.
"""

from __future__ import annotations

import ast
import re
from collections.abc import Collection, Iterator
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
ADAPTERS = {
    "src/cartwheel/world/build.py": "MuJoCo",
    "src/cartwheel/bridges/foxglove/slow.py": "the Foxglove SDK",
    "src/cartwheel/description/xacro/errors.py": "xacro",
}
"""The modules that match the messages of a library, and the library."""
_EXAMINE = frozenset(
    ("startswith", "endswith", "find", "index", "count", "search", "match", "fullmatch", "findall")
)
_LINES = frozenset(("partition", "rpartition", "split", "splitlines", "strip", "lower"))
"""Methods that lead to a part of the text."""


def is_error(node: ast.expr) -> bool:
    """Whether an expression is an error, by its name."""
    name = node.id if isinstance(node, ast.Name) else getattr(node, "attr", "")
    return "error" in name


def is_text(node: ast.expr, names: Collection[str] = ()) -> bool:
    """Whether an expression is the text of an error or diagnostic, or a part of it.

    Args:
        node: The expression.
        names: Variables that are such texts.
    """
    if isinstance(node, ast.Call) and isinstance(node.func, ast.Attribute):
        if node.func.attr in _LINES:
            return is_text(node.func.value, names)
        return node.func.attr == "getMessage"
    if isinstance(node, ast.Subscript):
        return is_text(node.value, names)
    if isinstance(node, ast.BoolOp):
        return any(is_text(each, names) for each in node.values)
    if isinstance(node, ast.Call) and isinstance(node.func, ast.Name) and node.func.id == "str":
        return any(map(is_error, node.args))
    if isinstance(node, ast.Name):
        return node.id in names
    return isinstance(node, ast.Attribute) and node.attr in ("message", "hint", "args")


def texts_of(function: ast.AST) -> set[str]:
    """The variables of a function that are texts of errors or diagnostics."""
    return {
        target.id
        for node in ast.walk(function)
        if isinstance(node, ast.Assign) and is_text(node.value)
        for target in node.targets
        if isinstance(target, ast.Name)
    }


def examinations(tree: ast.AST) -> set[int]:
    """The lines on which a text is compared or searched."""
    functions = [node for node in ast.walk(tree) if isinstance(node, ast.FunctionDef)]
    found = set(_examinations(tree, ()))
    for scope in functions or [tree]:
        if names := texts_of(scope):
            found.update(_examinations(scope, names))
    return found


def _examinations(tree: ast.AST, names: Collection[str]) -> Iterator[int]:
    for node in ast.walk(tree):
        if isinstance(node, ast.Compare):
            kinds = (ast.Eq, ast.NotEq, ast.In, ast.NotIn)
            texts = [is_text(each, names) for each in (node.left, *node.comparators)]
            if any(texts) and not all(texts) and any(isinstance(each, kinds) for each in node.ops):
                yield node.lineno
        elif isinstance(node, ast.Call) and isinstance(node.func, ast.Attribute):
            examined = (node.func.value, *node.args)
            if node.func.attr in _EXAMINE and any(is_text(each, names) for each in examined):
                yield node.lineno


FILES = sorted(
    str(file.relative_to(ROOT))
    for folder in ("src", "tools", "benchmarks")
    for file in (ROOT / folder).glob("**/*.py")
)


_MAY_EXAMINE = re.compile(r"\.\s*(?:message|hint|args|getMessage)\b|\bstr\s*\((?s:.{0,300}?)error")
"""What a file contains at least that examines a text; to parse all files takes seconds."""


def test_no_text_of_an_error_is_examined() -> None:
    texts = ((file, (ROOT / file).read_text()) for file in FILES)
    found = {
        file: examinations(ast.parse(text)) for file, text in texts if _MAY_EXAMINE.search(text)
    }
    lines = [
        f"{file}:{line}"
        for file, numbers in found.items()
        for line in sorted(numbers)
        if file not in ADAPTERS
    ]
    assert not lines, f"{lines}: compare the code and the values instead"
    assert not [file for file in ADAPTERS if not found[file]]


def is_marked(node: ast.stmt) -> bool:
    """Whether a test, or with `pytestmark` its file, has the mark `wording`."""
    marks = getattr(node, "decorator_list", [])
    if isinstance(node, ast.Assign) and ast.unparse(node.targets[0]) == "pytestmark":
        marks = [node.value]
    return any("mark.wording" in ast.unparse(each) for each in marks)


def unmarked_examinations(tree: ast.Module) -> set[int]:
    """The lines of tests without the mark on which a text is compared or searched."""
    if any(is_marked(node) for node in tree.body if isinstance(node, ast.Assign)):
        return set()
    return {line for node in tree.body if not is_marked(node) for line in examinations(node)}


def test_a_test_that_compares_words_has_the_mark() -> None:
    lines = [
        f"{file.relative_to(ROOT)}:{line}"
        for file in sorted((ROOT / "tests").glob("**/*.py"))
        if _MAY_EXAMINE.search(text := file.read_text())
        for line in sorted(unmarked_examinations(ast.parse(text)))
    ]
    assert not lines, f"{lines}: compare the code and the values, or set the mark"


def test_a_mark_is_noticed() -> None:
    compared = 'def test_it():\n    assert "no" in caught.value.message\n'
    marked = f"@pytest.mark.wording\n{compared}"
    assert unmarked_examinations(ast.parse(compared)) == {2}
    assert unmarked_examinations(ast.parse(f"{marked}\n{compared}")) == {6}
    assert not unmarked_examinations(ast.parse(marked))
    assert not unmarked_examinations(ast.parse(f"pytestmark = pytest.mark.wording\n{compared}"))


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
        ('text = str(failure.error) or "x"\nif "x" in text: pass', True),
        ('def f(error):\n text = error.message\n return re.search("x", text)', True),
        ("error.code is MISSING", False),
        ('error.values["name"] == "x"', False),
        ('f"{error.message}, so it ends"', False),
        ("answer.message == error.message", False),
        ("if error.hint: pass", False),
    ],
)
def test_an_examination_is_noticed(code: str, found: bool) -> None:
    assert bool(examinations(ast.parse(code))) is found
    assert _MAY_EXAMINE.search(code) or not found
