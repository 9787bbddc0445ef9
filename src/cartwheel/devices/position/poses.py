"""Poses of a model and its parts as transforms."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import partial
from typing import Any

from cartwheel.component import Component, Scope
from cartwheel.devices.transforms import TF_MESSAGE, TRANSFORM_STAMPED, transform_stamped
from cartwheel.geometry import Pose
from cartwheel.graph import Publisher
from cartwheel.messages import header, message_class
from cartwheel.simulation.handles import LinkHandle

_Transform = tuple[str, str, Callable[[], Pose]]
"""Frame, child frame, and a function that returns the pose of the child in the frame."""


@dataclass(frozen=True, kw_only=True, slots=True)
class ModelPosesConfig:
    model: bool
    """Publish the pose of the model in the world."""
    links: bool
    """Publish the poses of links in the model."""
    visuals: bool
    """Publish the poses of visuals in their links."""
    collisions: bool
    """Publish the poses of collisions in their links."""
    sensors: bool
    """Publish the poses of sensors in their links."""
    one_message: bool
    """Publish one TFMessage with all poses instead of a TransformStamped for each."""
    topic: str
    """Topic of the poses."""
    rate: float
    """Publish rate, Hz; 0: every step."""
    static_topic: str | None = None
    """Topic of the poses that no joint can change. None: they are published on `topic`."""
    static_rate: float = 0.0
    """Publish rate of `static_topic`, Hz; 0: every step."""


class ModelPoses(Component):
    """Publishes the poses of a model and of its links, visuals, collisions and sensors.

    Each pose is relative to the parent frame. Frames are named ``<model>``, ``<model>/<link>`` and
    ``<model>/<link>/<part>``. A prefix of the model's frames replaces the model's name.

    Args:
        scope: The model and its names.
        config: Parts, topics and rates.
    """

    def __init__(self, scope: Scope, config: ModelPosesConfig) -> None:
        super().__init__(scope)
        part = self.part
        self._config = config
        self._name = part.frame_prefix.strip("/") or part.name
        self._links = {link.name: part.link(link.name) for link in part.description.links}
        self._root = self._links[part.description.canonical_link]
        self._to_model = part.description.canonical_pose.inverse()
        self._TFMessage = message_class(TF_MESSAGE)
        transforms = list(self._transforms())
        if config.static_topic is not None:
            moving = self._moving()
            static = [each for each in transforms if each[1] not in moving]
            transforms = [each for each in transforms if each[1] in moving]
            self._offer(config.static_topic, static, config.static_rate)
        self._offer(config.topic, transforms, config.rate)

    def _offer(self, topic: str, transforms: list[_Transform], rate: float) -> None:
        kind = TF_MESSAGE if self._config.one_message else TRANSFORM_STAMPED
        publisher = self.advertise(topic, kind, rate=rate or None)
        self.part.schedule(
            rate,
            after=lambda: self._publish(publisher, transforms),
            topics=[publisher],
        )

    def _publish(self, publisher: Publisher, transforms: list[_Transform]) -> None:
        messages = [self._message(*transform) for transform in transforms]
        if self._config.one_message:
            publisher.publish(self._TFMessage(messages))
            return
        for message in messages:
            publisher.publish(message)

    def _message(self, frame: str, child: str, current: Callable[[], Pose]) -> Any:
        pose = current()
        moment = header(self.part.time_ns, frame)
        return transform_stamped(moment, child, pose.position, pose.orientation)

    def _model(self) -> Pose:
        return self._root.pose @ self._to_model

    def _in_model(self, link: LinkHandle) -> Pose:
        return self._model().inverse() @ link.pose

    def _transforms(self) -> Iterator[_Transform]:
        config, name = self._config, self._name
        if config.model:
            yield self.part.world.name, name, self._model
        for link in self.part.description.links:
            own = f"{name}/{_slashed(link.name)}"
            if config.links:
                yield name, own, partial(self._in_model, self._links[link.name])
            for wanted, parts in (
                (config.visuals, link.visuals),
                (config.collisions, link.collisions),
                (config.sensors, link.sensors),
            ):
                for part in parts if wanted else ():
                    yield own, f"{own}/{_slashed(part.name)}", partial(_constant, part.pose)

    def _moving(self) -> set[str]:
        """Returns the frames of links at movable joints. The canonical link is the reference."""
        description = self.part.description
        links = {
            link
            for joint in description.joints
            if joint.type != "fixed"
            for link in (joint.parent, joint.child)
        }
        moving = links - {description.canonical_link}
        return {f"{self._name}/{_slashed(link)}" for link in moving}


def _constant(pose: Pose) -> Pose:
    return pose


def _slashed(name: str) -> str:
    return name.replace("::", "/")
