"""Commanded forces on the links of a model, for one step or until they are cleared."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from cartwheel.component import Component, Scope
from cartwheel.geometry import Array, Vec3
from cartwheel.simulation.dynamics.external_servos import WrenchHandle

_WRENCH, _ENTITY = "ros_gz_interfaces/msg/EntityWrench", "ros_gz_interfaces/msg/Entity"
_MODEL, _LINK = 2, 3
"""Types of entities."""


@dataclass(frozen=True, kw_only=True, slots=True)
class StatedWrench:
    """A force and a torque on a link from the beginning."""

    link: str
    force: Vec3
    """N, in the world."""
    torque: Vec3
    """N m, in the world."""


@dataclass(frozen=True, kw_only=True, slots=True)
class EntityWrenchConfig:
    links: tuple[str, ...]
    """The links of the model; the first one is the canonical link."""
    topic: str
    """Topic of the wrenches (EntityWrench) for one step. The names of those that persist, and of
    their removal (Entity), begin with it."""
    stated: tuple[StatedWrench, ...] = ()
    """Wrenches that persist."""


class EntityWrench(Component):
    """Applies commanded wrenches at the centres of mass of the links of a model.

    Args:
        scope: The model and its names.
        config: Links and topics.

    Raises:
        UnknownNameError: A link does not exist.
    """

    def __init__(self, scope: Scope, config: EntityWrenchConfig) -> None:
        super().__init__(scope)
        part = self.part
        self._config = config
        self._handles: dict[str, WrenchHandle] = {
            link: part.wrench(link, origin=self.origin) for link in config.links
        }
        self._applied: set[str] = set()
        self._begin()
        self.subscribe(config.topic, _WRENCH, self._on_wrench)
        self.subscribe(f"{config.topic}/persistent", _WRENCH, self._on_persistent)
        self.subscribe(f"{config.topic}/clear", _ENTITY, self._on_clear)
        part.schedule(0, before=self._apply, active=lambda: self._changed)

    def reset(self) -> None:
        """Removes the commanded wrenches."""
        super().reset()
        self._applied.clear()
        self._begin()

    def _begin(self) -> None:
        self._once: dict[str, Array] = {}
        self._persistent: dict[str, Array] = {}
        for each in self._config.stated:
            self._add(self._persistent, each.link, np.array([*each.force, *each.torque]))
        self._changed = bool(self._persistent)

    def _on_wrench(self, message: Any) -> None:
        self._take(self._once, message)

    def _on_persistent(self, message: Any) -> None:
        self._take(self._persistent, message)

    def _take(self, wrenches: dict[str, Array], message: Any) -> None:
        link = self._target(message.entity)
        if link is not None:
            f, t = message.wrench.force, message.wrench.torque
            self._add(wrenches, link, np.array([f.x, f.y, f.z, t.x, t.y, t.z]))
            self._changed = True

    @staticmethod
    def _add(wrenches: dict[str, Array], link: str, value: Array) -> None:
        wrenches[link] = wrenches.get(link, np.zeros(6)) + value

    def _on_clear(self, entity: Any) -> None:
        link = self._target(entity)
        if link is not None and self._persistent.pop(link, None) is not None:
            self._changed = True

    def _target(self, entity: Any) -> str | None:
        """The link of this model that an entity names; None if it is another model's."""
        model, _, link = str(entity.name).partition("::")
        if entity.type == _MODEL and entity.name == self.part.name:
            return self._config.links[0]
        if entity.type == _LINK and model == self.part.name and link in self._handles:
            return link
        return None

    def _apply(self) -> None:
        now = {**self._persistent}
        for link, value in self._once.items():
            self._add(now, link, value)
        for link in self._applied | now.keys():
            total = now.get(link, np.zeros(6)).tolist()
            self._handles[link].apply(total[:3], total[3:])
        self._applied = set(now)
        # What acts for one step is removed before the next one.
        self._changed = bool(self._once)
        self._once = {}
