"""Attributes of the modules in `cartwheel.msgs`, whose types are described by their stubs."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from cartwheel.messages.store import TWIN, is_bundled, message_class, type_names

_KINDS = ("msg", "srv", "action")


def module_functions(package: str) -> tuple[Callable[[str], Any], Callable[[], list[str]]]:
    """The functions ``__getattr__`` and ``__dir__`` of the module of a package.

    A class is created when it is first used.

    Args:
        package: The ROS package, such as ``nav_msgs``. A name that only the package of the other
            ROS version has is an ImportError that states its module.
    """

    def find(name: str) -> Any:
        if not name.startswith("__"):
            if (full := _type(package, name)) is not None:
                return message_class(full)
            other = package.removesuffix(TWIN) if package.endswith(TWIN) else package + TWIN
            if _type(other, name) is not None:
                # Python would replace an AttributeError by an error without this message.
                raise ImportError(
                    f"{package} has no message type {name!r}; write "
                    f"`from cartwheel.msgs.{other} import {name}`",
                    name=f"cartwheel.msgs.{package}",
                )
        raise AttributeError(f"{package} has no message type {name!r}")

    return find, lambda: names(package)


def _type(package: str, name: str) -> str | None:
    """The full name of a built-in type; None if it does not exist."""
    found = (f"{package}/{kind}/{name}" for kind in _KINDS)
    return next((full for full in found if is_bundled(full)), None)


def names(package: str) -> list[str]:
    """Names of the built-in messages of a package, and of parts of its services and actions."""
    full = [name for name in type_names() if name.startswith(f"{package}/")]
    return [name.split("/")[2] for name in full if is_bundled(name)]
