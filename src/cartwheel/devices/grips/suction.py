"""Suction cups."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from cartwheel.component import Component, Scope
from cartwheel.messages import message_class, service_classes

_EMPTY = "std_srvs/srv/Empty"
_SET_BOOL = "std_srvs/srv/SetBool"


@dataclass(frozen=True, kw_only=True, slots=True)
class SuctionCupConfig:
    link: str
    """Link of the cup."""
    topic: str
    """Topic of a Bool that is true while an object is held."""
    reach: float
    """Maximum distance between the frames of the cup and of the gripped link, m."""
    excluded: frozenset[str] = frozenset()
    """Models and links that are never gripped."""
    one_service: bool = False
    """Offer the service ``switch`` (SetBool) instead of ``on`` and ``off`` (Empty)."""


class SuctionCup(Component):
    """While switched on, holds the nearest link of a different model that is within reach.

    The held link keeps its pose relative to the cup, as with a fixed joint.

    Args:
        scope: The cup's model and names.
        config: Link, reach and topic.

    Raises:
        UnknownNameError: The link does not exist.
    """

    def __init__(self, scope: Scope, config: SuctionCupConfig) -> None:
        super().__init__(scope)
        part = self.part
        self._config = config
        self._link = part.link(config.link, origin=self.origin)
        self._attachment = part.attachment()
        self._surroundings = part.surroundings()
        self._on = False
        self._Bool = message_class("std_msgs/msg/Bool")
        self._publisher = self.advertise(config.topic, "std_msgs/msg/Bool")
        if config.one_service:
            _, self._SetBoolResponse = service_classes(_SET_BOOL)
            self.serve("switch", _SET_BOOL, self._on_switch)
        else:
            _, self._EmptyResponse = service_classes(_EMPTY)
            self.serve("on", _EMPTY, lambda _: self._switched(on=True))
            self.serve("off", _EMPTY, lambda _: self._switched(on=False))
        part.schedule(
            0, before=self._grip, active=lambda: self._on and self._attachment.held is None
        )
        part.schedule(0, after=self._publish, topics=self.publishers)

    def reset(self) -> None:
        """Switches the cup off."""
        super().reset()
        self._switch(on=False)

    def _switched(self, *, on: bool) -> Any:
        self._switch(on=on)
        return self._EmptyResponse()

    def _on_switch(self, request: Any) -> Any:
        changed = bool(request.data) != self._on
        self._switch(on=bool(request.data))
        state = "on" if self._on else "off"
        message = f"{'' if changed else 'already '}{state}"
        return self._SetBoolResponse(success=changed, message=message)

    def _switch(self, *, on: bool) -> None:
        self._on = on
        if not on:
            self._attachment.release()

    def _grip(self) -> None:
        """Grips the nearest movable link within reach."""
        position, _ = self._link.place()
        distances = self._surroundings.distances(position)
        excluded = {self.part.name, *self._config.excluded}
        for index in distances.argsort(kind="stable"):
            if distances[index] > self._config.reach:
                return
            model, link = place = self._surroundings.links[index]
            if place in self._surroundings.moving and not {model, link} & excluded:
                self._attachment.hold((self.part.name, self._link.name), place)
                return

    def _publish(self) -> None:
        self._publisher.publish(self._Bool(self._attachment.held is not None))
