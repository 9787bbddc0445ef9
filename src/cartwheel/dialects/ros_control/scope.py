"""The names of a controller's topics and services."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from cartwheel.component import Scope
from cartwheel.graph import resolve_name


@dataclass(kw_only=True, slots=True)
class ControllerScope(Scope):
    """The names of a controller, which are below its own name."""

    name: str
    """The controller's name."""
    outer: Scope
    """The scope of the controller manager's plugin."""
    base: str
    """Namespace of the controller manager."""
    own: Mapping[str, str]
    """New names of the controller's topics by their names before the remapping."""

    def resolve(self, name: str) -> str:
        """Returns a topic name after remapping; below the controller's name unless global."""
        full = self._full(f"~/{name}")
        for source, target in self.own.items():
            if self._full(source) == full:
                full = self._full(target)
                break
        return self.outer.resolve(full)

    def published(self, name: str, type_name: str) -> str:  # noqa: ARG002
        """Returns `resolve`: controllers' topics are ROS topics already."""
        return self.resolve(name)

    def _full(self, name: str) -> str:
        """Resolves a name as a node does: ``~/…`` is below the controller's name."""
        space = self.base.strip("/")
        if name.startswith("~/"):
            name, space = name.removeprefix("~/"), f"{space}/{self.name}"
        return resolve_name(name, space)
