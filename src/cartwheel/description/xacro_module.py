"""Copies of the module xacro, each with a state of its own."""

from __future__ import annotations

import importlib.util
import sys
from functools import lru_cache
from importlib.machinery import SourceFileLoader
from pathlib import Path
from types import CodeType, ModuleType

from cartwheel.codes.files import XACRO_NOT_INSTALLED
from cartwheel.errors import DescriptionError

_NAME = "_cartwheel_xacro"


def fresh_xacro() -> ModuleType:
    """A copy of xacro's module that nobody else has."""
    main, substitution = _codes()
    module = ModuleType(_NAME)
    # Its own modules find each other by this name, whatever else is called xacro.
    vars(module).update(__package__=_NAME, __path__=[])
    exec(main, vars(module))  # noqa: S102 (the code of the installed package)
    inner = ModuleType(f"{_NAME}.substitution_args")
    vars(inner).update(__package__=_NAME)
    exec(substitution, vars(inner))  # noqa: S102
    vars(module).update(substitution=inner)
    return module


@lru_cache(maxsize=1)
def _codes() -> tuple[CodeType, CodeType]:
    """The code of xacro's module and of its part for ``$(…)``.

    It is read at the first use, since that takes a while.
    """
    folder = _folder()
    package = folder / "__init__.py"
    # Those of its modules that have no state are found below this name.
    spec = importlib.util.spec_from_file_location(
        _NAME, package, submodule_search_locations=[str(folder)]
    )
    assert spec is not None
    sys.modules[_NAME] = importlib.util.module_from_spec(spec)
    return tuple(_code_of(file) for file in (package, folder / "substitution_args.py"))  # type: ignore[return-value]


def _folder() -> Path:
    """Where the xacro lies that Cartwheel needs.

    A sourced ROS workspace puts modules of its own before it, an older xacro among them.
    """
    for entry in sys.path:
        folder = Path(entry, "xacro")
        if (folder / "substitution_args.py").is_file():
            return folder
    raise DescriptionError(
        "the Python package xacro 2 is not installed",
        code=XACRO_NOT_INSTALLED,
        hint="Run pip install 'xacro>=2.1', or reinstall Cartwheel.",
    )


def _code_of(file: Path) -> CodeType:
    loader = SourceFileLoader(file.stem, str(file))
    code = loader.get_code(file.stem)
    assert code is not None
    return code
