"""Fixed joints between links of any models, which are created and removed at run time."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from cartwheel.codes import running, world
from cartwheel.component import Component, Scope
from cartwheel.errors import UnknownNameError
from cartwheel.messages import message_class
from cartwheel.simulation.dynamics.fixed_joints import AttachmentHandle

Place = tuple[str, str]
"""Names of a model and a link."""


class Attacher(Component):
    """Attaches pairs of links in their current relative pose, any number at the same time.

    Args:
        scope: The world and its names.
    """

    def __init__(self, scope: Scope) -> None:
        super().__init__(scope)
        self._surroundings = self.part.surroundings()
        self._joints: list[AttachmentHandle] = []
        self._pairs: dict[frozenset[Place], AttachmentHandle] = {}

    def reset(self) -> None:
        """Detaches all links."""
        super().reset()
        for joint in self._joints:
            joint.release()
        self._pairs.clear()

    def attached(self, one: Place, two: Place) -> bool:
        """Whether the two links are attached."""
        joint = self._pairs.get(frozenset((one, two)))
        return joint is not None and joint.held is not None

    def attach(self, one: Place, two: Place) -> None:
        """Attaches two links in their current relative pose."""
        free = (joint for joint in self._joints if joint.held is None)
        joint = next(free, None)
        if joint is None:
            joint = self.part.attachment()
            self._joints.append(joint)
        # If one of the links cannot move, it holds the other one.
        holder, link = (one, two) if two in self._surroundings.moving else (two, one)
        joint.hold(holder, link)
        self._pairs[frozenset((one, two))] = joint

    def detach(self, one: Place, two: Place) -> None:
        """Detaches two attached links."""
        self._pairs.pop(frozenset((one, two))).release()

    def place(self, model: str, link: str) -> Place:
        """Returns a link of a model. The link's name can begin with the model's name.

        Raises:
            UnknownNameError: The model or link does not exist.
        """
        links = [other for owner, other in self._surroundings.links if owner == model]
        if not links:
            models = {owner for owner, _ in self._surroundings.links}
            raise UnknownNameError("model", model, models, code=world.UNKNOWN_MODEL)
        link = link.removeprefix(f"{model}::")
        if link not in links:
            known = [f"{model}::{other}" for other in links]
            raise UnknownNameError("link", f"{model}::{link}", known, code=running.UNKNOWN_LINK)
        return model, link


@dataclass(frozen=True, kw_only=True, slots=True)
class DetachableJointConfig:
    parent_link: str
    """Link of this model."""
    child_model: str
    """Name of the other model, for the warning."""
    child_link: str
    """Name of its link, for the warning."""
    children: tuple[Place, ...]
    """Models and links that these names can mean. The first that exists is attached."""
    attach_topic: str
    """Topic of the Empty messages that attach the child again."""
    detach_topic: str
    """Topic of the Empty messages that detach the child."""
    state_topic: str
    """Topic of the state (String), ``attached`` or ``detached``, published when it changes."""
    warn: bool = True
    """Warn if the child does not exist at the start."""


class DetachableJoint(Component):
    """Attaches a link of a different model to a link of this model until a message detaches it.

    The links are attached when the simulation starts, in their current relative pose. A child that
    is spawned later is attached as soon as it exists.

    Args:
        scope: The parent's model and names.
        config: Links and topics.

    Raises:
        UnknownNameError: The parent link does not exist.
    """

    def __init__(self, scope: Scope, config: DetachableJointConfig) -> None:
        super().__init__(scope)
        part = self.part
        self._config = config
        part.link(config.parent_link, origin=self.origin)
        self._joint = part.attachment()
        self._surroundings = part.surroundings()
        self._pending = True
        self._warned = not config.warn
        self._String = message_class("std_msgs/msg/String")
        self._states = self.advertise(config.state_topic, "std_msgs/msg/String")
        self.subscribe(config.detach_topic, "std_msgs/msg/Empty", self._on_detach)
        self.subscribe(config.attach_topic, "std_msgs/msg/Empty", self._on_attach)
        part.schedule(0, before=self._attach, active=lambda: self._pending)

    def reset(self) -> None:
        """Attaches the child again at its initial pose."""
        super().reset()
        self._joint.release()
        self._pending = True

    def _on_attach(self, _: Any) -> None:
        self._pending = self._joint.held is None

    def _on_detach(self, _: Any) -> None:
        if self._joint.held is not None:
            self._joint.release()
            self._publish("detached")

    def _attach(self) -> None:
        config = self._config
        existing = (place for place in config.children if place in self._surroundings.links)
        link = next(existing, None)
        if link is not None:
            self._joint.hold((self.part.name, config.parent_link), link)
            self._pending = False
            self._publish("attached")
        elif not self._warned:
            self._warned = True
            self.warn(
                running.ATTACHMENT_FAILED,
                f'link "{config.child_link}" of model "{config.child_model}" does not exist yet, '
                "so it is not attached",
                values={"link": config.child_link, "model": config.child_model},
            )

    def _publish(self, state: str) -> None:
        if self._states.wanted:
            self._states.publish(self._String(state))
