"""Modules of the same package that launch files in Python import, such as shared constants."""

from __future__ import annotations

import ast
from collections.abc import Iterator
from pathlib import Path

from cartwheel.description.files.package_folders import is_file, package_above, package_name
from cartwheel.description.files.regular_files import read_regular_text
from cartwheel.description.launches.python.actions import called_functions
from cartwheel.description.launches.use import Facts

_MOST = 20
"""Maximum number of modules that a launch file may import, also indirectly."""
_DEEPEST = 10
"""Maximum number of dots of a relative import."""
_LOOK = 100
"""Steps of a look at a file."""


def with_imports(tree: ast.Module, path: Path, facts: Facts) -> ast.Module:
    """A launch file with the functions and variables of the modules that it imports, before its own
    statements.

    Modules are searched beside the file that imports them, and in its package.
    Functions that the launch file does not call are left out. All lines are that of the import.

    Args:
        tree: The launch file.
        path: Its path.
        facts: Finds packages, with the remaining effort.
    """
    body = [*_imported(tree.body, path, facts, {path})]
    if not body:
        return tree
    whole = ast.Module(body=[*body, *tree.body], type_ignores=[])
    called = called_functions(whole)
    kept = [
        each
        for each in body
        if not isinstance(each, ast.FunctionDef) or called.get(each.name) is each
    ]
    return ast.Module(body=[*kept, *tree.body], type_ignores=[])


def _imported(
    body: list[ast.stmt], path: Path, facts: Facts, seen: set[Path], line: int = 0
) -> Iterator[ast.stmt]:
    """The definitions of the modules that statements import, those of the deepest first.

    Args:
        body: The statements.
        path: The file that contains them.
        facts: Finds packages, with the remaining effort.
        seen: The files that were read.
        line: The line of the import in the launch file; 0 for its own statements.
    """
    for each in body:
        if not isinstance(each, ast.ImportFrom):
            continue
        module = _found(each, path, facts)
        if module is None or module in seen or len(seen) > _MOST:
            continue
        seen.add(module)
        try:
            content = read_regular_text(module).removeprefix("\ufeff")
            facts.effort.spend(len(content))
            tree = ast.parse(content)
        except (OSError, SyntaxError, ValueError, RecursionError, MemoryError):
            continue
        at = line or each.lineno
        yield from _imported(tree.body, module, facts, seen, at)
        for one in tree.body:
            if isinstance(one, ast.FunctionDef | ast.Assign | ast.AnnAssign):
                for node in ast.walk(one):
                    facts.effort.spend()
                    if isinstance(node, ast.stmt | ast.expr):
                        node.lineno = at
                yield one


def _found(statement: ast.ImportFrom, path: Path, facts: Facts) -> Path | None:
    """The file of a module in the package of the file that imports it; None if it is elsewhere."""
    parts = (statement.module or "").split(".") if statement.module else []
    package = package_above(path.parent)
    home, folder = package or path.parent, path.parent
    for _ in range(min(statement.level, _DEEPEST) - 1):
        folder = folder.parent
    candidates = [folder.joinpath(*parts)]
    if package is not None and not statement.level and parts[0] == package_name(package):
        # A package of Python has its modules in a folder of its own name.
        candidates.append(package.joinpath(*parts))
    for each in candidates:
        facts.effort.spend(_LOOK)
        if each == home or not each.is_relative_to(home):
            continue
        for file in (each.with_name(f"{each.name}.py"), each / "__init__.py"):
            if is_file(file):
                return file
    return None
