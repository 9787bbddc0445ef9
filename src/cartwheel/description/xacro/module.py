"""Creates independent copies of the xacro module.

xacro keeps its state in global variables. With a copy for each expansion, threads can expand files
at the same time and do not affect each other. Creating a copy takes 1.5 ms.
"""

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
    """A new copy of xacro's module."""
    main, substitution = _codes()
    module = ModuleType(_NAME)
    # Its submodules import each other by this name, regardless of other xacro modules.
    vars(module).update(__package__=_NAME, __path__=[])
    exec(main, vars(module))  # noqa: S102 (the code of the installed package)
    inner = ModuleType(f"{_NAME}.substitution_args")
    vars(inner).update(__package__=_NAME)
    exec(substitution, vars(inner))  # noqa: S102
    vars(module).update(substitution=inner)
    return module


@lru_cache(maxsize=1)
def _codes() -> tuple[CodeType, CodeType]:
    """The code of xacro's module and of its module for ``$(…)``.

    It is loaded at first use, because loading is slow.
    """
    folder = _folder()
    package = folder / "__init__.py"
    # Its stateless submodules are imported below this name.
    spec = importlib.util.spec_from_file_location(
        _NAME, package, submodule_search_locations=[str(folder)]
    )
    assert spec is not None
    sys.modules[_NAME] = importlib.util.module_from_spec(spec)
    return tuple(_code_of(file) for file in (package, folder / "substitution_args.py"))  # type: ignore[return-value]


def _folder() -> Path:
    """The folder of the xacro version that Cartwheel requires.

    A sourced ROS workspace may have its own, older xacro earlier in the path.
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
