"""The plugins by file name and by sensor type.

A plugin's module is imported when a model uses the plugin. Importing all of them takes as long as
the rest of the startup.
"""

from __future__ import annotations

import contextlib
import dataclasses
import functools
import importlib
import importlib.metadata
import re
from collections.abc import Iterator, Sequence
from contextvars import ContextVar
from typing import Any

from cartwheel.dialects.generated import PLUGINS, SENSORS
from cartwheel.dialects.plugin import Plugin

ROS_CONTROL = "gazebo_ros_control"
OF_FETCH = "fetch_gazebo_plugin"
"""The controller manager of Fetch, whose controllers are in files of ROS 1 as well."""
Plugins = Sequence[type[Plugin[Any]]]
_ADDED: ContextVar[Plugins] = ContextVar("added plugins", default=())


def short_name(filename: str) -> str:
    """Returns a plugin's name without path, ``lib``, ``.so`` and outdated vendor prefixes."""
    stem = filename.rsplit("/", 1)[-1]
    stem = re.sub(r"\.(so|dylib|dll)$", "", stem)
    stem = stem.removeprefix("lib")
    # Some names contain a major version: ignition-gazebo6-, gz-sim8-.
    return re.sub(r"^(ignition-gazebo|gz-sim)\d*-", "gz-sim-", stem)


def plugin_named(filename: str, more: Plugins = ()) -> type[Plugin[object]] | None:
    """Returns the plugin for a file name, or None.

    Args:
        filename: Name in a ``<plugin>`` tag.
        more: Plugins that take precedence over those of installed packages, which take precedence
            over Cartwheel's own.
    """
    name = short_name(filename)
    for plugin in (*more, *_ADDED.get(), *_third()):
        if name in _names(plugin):
            return plugin
    if name not in PLUGINS and name.endswith(f"_{ROS_CONTROL}"):
        # Other vendors derive plugins from it: Baxter, HSR, Schunk.
        name = ROS_CONTROL
    ours = _within(PLUGINS[name]) if name in PLUGINS else ()
    return next((plugin for plugin in ours if name in _names(plugin)), None)


def plugin_serving(kind: str, more: Plugins = ()) -> type[Plugin[object]] | None:
    """Returns the plugin for sensors of a type that need no ``<plugin>``, or None."""
    for plugin in (*more, *_ADDED.get(), *_third()):
        if kind in plugin.serves:
            return plugin
    ours = _within(SENSORS[kind]) if kind in SENSORS else ()
    return next((plugin for plugin in ours if kind in plugin.serves), None)


def plugin_names(more: Plugins = ()) -> list[str]:
    """Returns the short names of all plugins."""
    return [
        *PLUGINS,
        *(name for plugin in (*_third(), *_ADDED.get(), *more) for name in _names(plugin)),
    ]


@contextlib.contextmanager
def adding(plugins: Plugins) -> Iterator[None]:
    """Within the block, these plugins take precedence over those of installed packages."""
    before = _ADDED.set((*plugins, *_ADDED.get()))
    try:
        yield
    finally:
        _ADDED.reset(before)


def all_plugins() -> list[type[Plugin[object]]]:
    """Returns all plugins: those with a file name, then those for sensors without a plugin."""
    plugins = [plugin_named(name) for name in plugin_names()]
    plugins += [plugin_serving(kind) for kind in SENSORS]
    return list(dict.fromkeys(plugin for plugin in plugins if plugin is not None))


def _third() -> tuple[type[Plugin[object]], ...]:
    """Plugins in installed packages. For equal names, the last installed takes precedence."""
    return _installed()[0]


def unloadable() -> tuple[str, ...]:
    """Returns a message for each installed plugin that cannot be loaded."""
    return _installed()[1]


@functools.cache
def _installed() -> tuple[tuple[type[Plugin[object]], ...], tuple[str, ...]]:
    plugins: list[type[Plugin[object]]] = []
    broken: list[str] = []
    for entry in importlib.metadata.entry_points(group="cartwheel.plugins"):
        package = entry.dist.name if entry.dist else entry.value
        try:
            plugin = checked_plugin(entry.load(), entry.value)
        except (Exception, SystemExit) as error:  # noqa: BLE001 - code in a different package
            broken.append(
                f'The plugin "{entry.name}" of the installed package "{package}" cannot be '
                f"loaded: {type(error).__name__}: {error}."
            )
        else:
            plugins.insert(0, plugin)
    return tuple(plugins), tuple(broken)


def checked_plugin(plugin: object, name: str) -> type[Plugin[object]]:
    """Returns a class from a different package if it is a complete plugin.

    Args:
        plugin: The class.
        name: Name of the class for the error.

    Raises:
        TypeError: It is not a subclass of `Plugin`, or an attribute is missing or invalid.
    """
    if not (isinstance(plugin, type) and issubclass(plugin, Plugin)):
        raise TypeError(f"{name} must be a subclass of Plugin")
    if isinstance(getattr(plugin, "filenames", ""), str):
        raise TypeError(f"{name}.filenames must be a tuple of strings")
    if not all(isinstance(each, str) for each in (*plugin.filenames, *plugin.serves)):
        raise TypeError(f"{name}.filenames and {name}.serves must contain only strings")
    if not dataclasses.is_dataclass(getattr(plugin, "parameters", None)):
        raise TypeError(f"{name}.parameters must be a dataclass")
    for item in dataclasses.fields(plugin.parameters):
        if "tags" not in item.metadata:
            raise TypeError(f"{name}.parameters.{item.name} must be defined with tag()")
    if plugin.configure is Plugin.configure:
        raise TypeError(f"{name} must define the method configure()")
    return plugin


def _names(plugin: type[Plugin[object]]) -> Iterator[str]:
    return map(short_name, plugin.filenames)


@functools.cache
def _within(module: str) -> tuple[type[Plugin[object]], ...]:
    """The plugins that a module in this package defines."""
    imported = importlib.import_module(f"cartwheel.dialects.{module}")
    return tuple(
        each
        for each in vars(imported).values()
        if isinstance(each, type)
        and issubclass(each, Plugin)
        and each.__module__ == imported.__name__
        and hasattr(each, "filenames")
    )
