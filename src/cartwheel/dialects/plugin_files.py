"""Plugins in Python files that the user specifies, with ``--plugin`` for example."""

from __future__ import annotations

import contextlib
import importlib.util
import sys
import traceback
from collections.abc import Iterator, Sequence
from importlib.machinery import SourceFileLoader
from pathlib import Path
from types import CodeType
from typing import Any

from cartwheel.codes import devices
from cartwheel.codes.graph import MESSAGE_DEFINITION_INVALID
from cartwheel.dialects.catalogue import adding, checked_plugin, short_name
from cartwheel.dialects.plugin import Plugin
from cartwheel.errors import CartwheelError, GraphError, Origin

_IMPORT_HINT = (
    "A plugin file can import installed packages, and modules in the folders of PYTHONPATH."
)


class _UncachedLoader(SourceFileLoader):
    """Compiles a file each time.

    Python's compiled files are valid for a source of the same size that was changed in the same
    second, so a plugin that was just changed would run as it was before.
    """

    def get_code(self, fullname: str) -> CodeType:
        path = self.get_filename(fullname)
        return self.source_to_code(self.get_data(path), path)


class PluginFiles:
    """The plugins in the specified files of one simulation. Later files take precedence."""

    def __init__(self) -> None:
        self.classes: tuple[type[Plugin[Any]], ...] = ()

    def load(self, path: Path) -> None:
        """Executes a file and adds the plugins that it defines.

        Raises:
            CartwheelError: The file does not exist, raises an exception or defines no plugin.
        """
        self.classes = (*_plugins_in(path), *self.classes)


@contextlib.contextmanager
def using(paths: Sequence[Path]) -> Iterator[None]:
    """Within the block, the plugins in the files are known to checks and to simulations.

    Args:
        paths: Python files, which are executed.

    Raises:
        CartwheelError: As `PluginFiles.load`.
    """
    files = PluginFiles()
    for path in paths:
        files.load(path)
    with adding(files.classes):
        yield


def _plugins_in(path: Path) -> list[type[Plugin[Any]]]:
    origin = Origin(file=str(path))
    values = {"path": str(path)}
    if not path.is_file():
        raise CartwheelError(
            f'the plugin file "{path}" does not exist',
            code=devices.PLUGIN_FILE_INVALID,
            values=values,
        )
    # A dataclass looks up its module in sys.modules while it is defined.
    name = f"_cartwheel_plugin_{abs(hash(path.resolve())):x}"
    specification = importlib.util.spec_from_file_location(name, path)
    if specification is None or specification.loader is None:
        raise CartwheelError(
            f'the plugin file "{path}" must be a Python file',
            code=devices.PLUGIN_FILE_INVALID,
            hint="Its name must end in .py.",
            values=values,
        )
    loader = specification.loader
    if isinstance(loader, SourceFileLoader):
        loader = specification.loader = _UncachedLoader(name, str(path))
    module = importlib.util.module_from_spec(specification)
    sys.modules[name] = module
    try:
        loader.exec_module(module)
        defined = [
            checked_plugin(each, each.__name__)
            for each in vars(module).values()
            if isinstance(each, type) and issubclass(each, Plugin) and each.__module__ == name
        ]
        _check_distinct(defined)
    except GraphError as error:
        del sys.modules[name]
        if error.code is MESSAGE_DEFINITION_INVALID:
            raise  # The fault is in the file of a message type.
        raise _unloadable(path, error) from error
    except (Exception, SystemExit) as error:
        del sys.modules[name]
        raise _unloadable(path, error) from error
    if not defined:
        raise CartwheelError(
            "the file defines no plugin",
            code=devices.PLUGIN_FILE_INVALID,
            origin=origin,
            hint="A plugin is a subclass of cartwheel.plugin.Plugin.",
            values=values,
        )
    return defined


def _unloadable(path: Path, error: BaseException) -> CartwheelError:
    return CartwheelError(
        f"the plugin file cannot be loaded: {type(error).__name__}: {error}",
        code=devices.PLUGIN_FILE_INVALID,
        origin=Origin(file=str(path), line=_line(error, path)),
        hint=_IMPORT_HINT if isinstance(error, ImportError) else "",
        values={"path": str(path)},
    )


def _check_distinct(plugins: Sequence[type[Plugin[Any]]]) -> None:
    """Raises an error if two plugins of one file have the same file name."""
    owners: dict[str, type[Plugin[Any]]] = {}
    for plugin in plugins:
        for name in map(short_name, plugin.filenames):
            owner = owners.setdefault(name, plugin)
            if owner is not plugin:
                raise TypeError(
                    f'{owner.__name__} and {plugin.__name__} have the same file name "{name}"'
                )


def _line(error: BaseException, path: Path) -> int:
    """Returns the last line of the file that the exception passed through; 0 if there is none."""
    if isinstance(error, SyntaxError) and error.filename == str(path):
        return error.lineno or 0
    frames = traceback.extract_tb(error.__traceback__)
    lines = [frame.lineno or 0 for frame in frames if frame.filename == str(path)]
    return lines[-1] if lines else 0


def raised_at(error: BaseException, plugin: type[Plugin[Any]]) -> str:
    """Where the file of a plugin raised an error, for messages; empty if it did not."""
    path = getattr(sys.modules.get(plugin.__module__), "__file__", None)
    line = _line(error, Path(path)) if path else 0
    return f" ({Path(path).name}:{line})" if path and line else ""
