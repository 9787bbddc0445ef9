"""Reports that a model has touched another one for some time."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from cartwheel.component import Component, Scope
from cartwheel.messages import message_class, service_classes


@dataclass(frozen=True, kw_only=True, slots=True)
class TouchConfig:
    collisions: frozenset[str]
    """The model's own collisions, ``link::collision``."""
    target: str
    """Part of the name ``model::link::collision`` of what must be touched."""
    seconds: float
    """Time for which it must be touched without a pause, s."""
    topic: str
    """Topic of the Bool message."""
    service: str
    """Service that starts or stops the watch (SetBool)."""
    enabled: bool
    """Whether the watch starts with the simulation."""


class Touch(Component):
    """Publishes `true` once when a model has touched a target for some time, and then stops.

    Args:
        scope: The model and its names.
        config: What must be touched, for how long, and the topic.
    """

    def __init__(self, scope: Scope, config: TouchConfig) -> None:
        super().__init__(scope)
        self._config = config
        self._Bool = message_class("std_msgs/msg/Bool")
        self._publisher = self.advertise(config.topic, "std_msgs/msg/Bool")
        _, self._Response = service_classes("std_srvs/srv/SetBool")
        self.serve(config.service, "std_srvs/srv/SetBool", self._on_request)
        self.part.schedule(0, after=self._watch, active=lambda: self._enabled)
        self.reset()

    def reset(self) -> None:
        super().reset()
        self._enabled = self._config.enabled
        self._since_ns: int | None = None

    def _on_request(self, request: Any) -> Any:
        self._enabled, self._since_ns = bool(request.data), None
        return self._Response(success=True, message="")

    def _watch(self) -> None:
        config = self._config
        contacts = self.part.contacts(config.collisions)
        if not any(config.target in contact.second for contact in contacts):
            self._since_ns = None
            return
        now = self.part.time_ns
        if self._since_ns is None:
            self._since_ns = now
        if (now - self._since_ns) * 1e-9 >= config.seconds:
            self._enabled, self._since_ns = False, None
            self._publisher.publish(self._Bool(data=True))
