"""Hands: objects between fingers are attached to the palm."""

from __future__ import annotations

import itertools
import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from cartwheel.component import Component, Scope
from cartwheel.devices.grips.attachment import Place
from cartwheel.errors import Origin
from cartwheel.geometry import Array, Vec3
from cartwheel.messages import message_class
from cartwheel.simulation import Part
from cartwheel.simulation.handles import LinkHandle

_LEAST_FORCE = 1e-4
"""Smaller forces are ignored, N."""
_LEAST_RATIO = 0.3
"""Minimum ratio of the smaller to the larger of two gripping forces."""
_EVENT = "gazebo_grasp_plugin_ros/msg/GazeboGraspEvent"


@dataclass(frozen=True, kw_only=True, slots=True)
class HandConfig:
    """A palm and its fingers."""

    name: str
    """Name of the hand in events."""
    palm: str
    """Link to which objects are attached."""
    fingers: tuple[str, ...]
    """Links of the fingers."""
    origin: Origin | None
    """File and line for errors about unknown links."""


@dataclass(frozen=True, kw_only=True, slots=True)
class GraspConfig:
    hands: tuple[HandConfig, ...]
    """The hands. Each holds one object at a time."""
    angle: float
    """Two fingers grip an object if the angle between their forces exceeds this value, rad."""
    rate: float
    """Rate at which contacts are checked, Hz; 0: every step."""
    most: int
    """Maximum value of the grip counters."""
    threshold: int
    """An object is attached when a grip counter exceeds this value."""
    tolerance: float
    """An object can be released when its distance to a finger has changed by more than this, m."""
    collides: bool
    """Whether attached objects still collide."""
    event_topic: str
    """Topic of the events (GazeboGraspEvent)."""


class Grasp(Component):
    """Attaches an object to the palm while fingers grip it from opposite sides.

    A collision is gripped if the angle between the forces of two fingers on it exceeds the
    configured angle, and the smaller force is at least 0.3 times the larger one. Each check adds 1
    to the grip counter of a gripped collision, and subtracts 1 from all other counters.

    An object is attached when the grip counter of one of its collisions exceeds the threshold. It
    is released when the counter no longer exceeds the threshold and the object's distance to a
    finger has changed by more than the tolerance.

    Args:
        scope: The hands' model and names.
        config: Hands and thresholds.

    Raises:
        UnknownNameError: A link does not exist.
    """

    def __init__(self, scope: Scope, config: GraspConfig) -> None:
        super().__init__(scope)
        self._config = config
        self._surroundings = self.part.surroundings()
        self._hands = [_Hand(self.part, hand) for hand in config.hands]
        self._Event = message_class(_EVENT)
        self._events = self.advertise(config.event_topic, _EVENT)
        self.part.schedule(config.rate, after=self._check)

    def reset(self) -> None:
        """Releases all objects."""
        super().reset()
        for hand in self._hands:
            hand.reset()

    def _check(self) -> None:
        config = self._config
        for hand in self._hands:
            pressed = hand.pressed(self._surroundings.moving)
            gripped = {
                name
                for name, forces in pressed.items()
                if oppose(list(forces.values()), config.angle)
            }
            for name in gripped:
                count = hand.counts[name] = min(hand.counts.get(name, 0) + 1, config.most)
                if count > config.threshold and hand.object is None:
                    hand.attach(name, list(pressed[name]), collides=config.collides)
                    self._publish_event(hand, name, attached=True)
            for name in hand.counts.keys() - gripped:
                count = hand.counts[name] = max(hand.counts[name] - 1, 0)
                loose = name == hand.object and count <= config.threshold
                if loose and hand.opened(config.tolerance):
                    hand.release()
                    hand.counts[name] = 0
                    self._publish_event(hand, name, attached=False)

    def _publish_event(self, hand: _Hand, name: str, *, attached: bool) -> None:
        if self._events.wanted:
            self._events.publish(self._Event(hand.name, name, attached))


class _Hand:
    """The state of a hand."""

    def __init__(self, part: Part, config: HandConfig) -> None:
        self.name = config.name
        self.counts: dict[str, int] = {}
        """Grip counters by collision."""
        self.object: str | None = None
        """The attached collision."""
        fingers = [part.link(name, origin=config.origin) for name in config.fingers]
        part.link(config.palm, origin=config.origin)
        self._part, self._palm = part, config.palm
        self._attachment = part.attachment()
        self._fingers = {
            f"{finger.name}::{collision.name}": finger
            for finger in fingers
            for link in part.description.links
            if link.name == finger.name
            for collision in link.collisions
        }
        self._marks: list[tuple[LinkHandle, Vec3, float]] = []
        """Contact points in the fingers' frames, and their distance to the object's frame."""
        self._points: dict[tuple[str, str], Vec3] = {}

    def pressed(self, moving: frozenset[Place]) -> dict[str, dict[str, Array]]:
        """Returns the forces on movable collisions in N, by collision and finger."""
        forces_by_collision: dict[str, dict[str, Array]] = {}
        self._points = {}
        for contact in self._part.contacts(self._fingers):
            model, link = _link_of(contact.second)
            if model == self._part.name or (model, link) not in moving:
                continue
            finger = contact.first.partition("::")[2]
            forces = forces_by_collision.setdefault(contact.second, {})
            forces[finger] = forces.get(finger, np.zeros(3)) - contact.force
            x, y, z = contact.position.tolist()
            self._points[contact.second, finger] = (x, y, z)
        return forces_by_collision

    def attach(self, name: str, fingers: list[str], *, collides: bool) -> None:
        """Attaches the link of a collision to the palm."""
        self.object = name
        self._attachment.hold((self._part.name, self._palm), _link_of(name), collides=collides)
        place = self._attachment.link_pose().position
        self._marks = []
        for each in fingers:
            finger, point = self._fingers[each], self._points[name, each]
            local = finger.pose.inverse().apply(point)
            self._marks.append((finger, local, math.dist(point, place)))

    def opened(self, tolerance: float) -> bool:
        """Whether a finger has left the object, or the object no longer exists."""
        if self._attachment.held is None:
            return True
        place = self._attachment.link_pose().position
        return any(
            abs(math.dist(finger.pose.apply(local), place) - distance) > tolerance
            for finger, local, distance in self._marks
        )

    def release(self) -> None:
        """Detaches the object."""
        self.object = None
        self._attachment.release()

    def reset(self) -> None:
        """Restores the initial state."""
        self.release()
        self.counts.clear()


def _link_of(collision: str) -> Place:
    """Returns the model and the link of a collision, ``model::link::collision``."""
    model, _, link = collision.rpartition("::")[0].partition("::")
    return model, link


def oppose(forces: Sequence[Array], angle: float) -> bool:
    """Whether two of the forces are sufficiently opposite and similar in size to grip.

    Args:
        forces: Forces in N, shape (3,) each.
        angle: Two forces are opposite if the angle between them exceeds this value, rad.
    """
    for one, two in itertools.combinations(forces, 2):
        a, b = float(np.linalg.norm(one)), float(np.linalg.norm(two))
        if min(a, b) < _LEAST_FORCE or min(a, b) < _LEAST_RATIO * max(a, b):
            continue
        cosine = float(one @ two) / (a * b)
        if math.acos(min(1.0, max(-1.0, cosine))) > angle:
            return True
    return False
