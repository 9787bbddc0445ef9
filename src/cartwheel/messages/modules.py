"""Attributes of the modules in `cartwheel.msgs`, whose types are described by their stubs."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from cartwheel.messages.store import is_bundled, message_class, store

_KINDS = ("msg", "srv", "action")


def module_functions(package: str) -> tuple[Callable[[str], Any], Callable[[], list[str]]]:
    """The functions ``__getattr__`` and ``__dir__`` of the module of a package.

    A class is created when it is first used.

    Args:
        package: The ROS package, such as ``nav_msgs``.
    """

    def find(name: str) -> Any:
        if not name.startswith("__"):
            for kind in _KINDS:
                full = f"{package}/{kind}/{name}"
                if is_bundled(full):
                    return message_class(full)
        raise AttributeError(f"{package} has no message type {name!r}")

    return find, lambda: names(package)


def names(package: str) -> list[str]:
    """Names of the built-in messages of a package, and of parts of its services and actions."""
    full = sorted(name for name in store().types if name.startswith(f"{package}/"))
    return [name.split("/")[2] for name in full if is_bundled(name)]
