"""``libgazebo_grasp_fix.so``: attaches objects to a hand that grips them."""

from __future__ import annotations

import itertools
import math
from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from cartwheel.codes import devices
from cartwheel.description.model import Element
from cartwheel.dialects.plugin import Plugin
from cartwheel.dialects.tags import invalid, missing, tag
from cartwheel.geometry import Array, Vec3
from cartwheel.messages import message_class
from cartwheel.simulation.handles import LinkHandle

_LEAST_FORCE = 1e-4
"""N; smaller forces are ignored."""
_LEAST_RATIO = 0.3
"""Minimum ratio of the smaller to the larger of two gripping forces."""
_EVENTS = "/gazebo_grasp_plugin_event_republisher/grasp_events"
Place = tuple[str, str]
"""Names of a model and a link."""


@dataclass(frozen=True, kw_only=True, slots=True)
class GraspFixParameters:
    arms: tuple[str, ...] = tag(
        "arm",
        default=(),
        nested=True,
        doc="A hand: `<arm_name>`, `<palm_link>`, and a `<gripper_link>` for each finger. Repeat "
        "the tag for each hand.",
    )
    angle: float = tag(
        "forces_angle_tolerance",
        default=120.0,
        unit="°",
        doc="Two fingers grip an object if the angle between their forces exceeds this "
        "value, which must be from 90 to 180.",
    )
    rate: float = tag(
        "update_rate", default=5.0, unit="Hz", doc="Rate at which contacts are checked."
    )
    most: int = tag("max_grip_count", default=10, doc="Maximum value of the grip counters.")
    threshold: int | None = tag(
        "grip_count_threshold",
        default=None,
        doc="An object is attached when a grip counter exceeds this value. Default: half of "
        "`<max_grip_count>`.",
    )
    tolerance: float = tag(
        "release_tolerance",
        default=0.005,
        unit="m",
        doc="An object can be released when its distance to a finger has changed by more than "
        "this value.",
    )
    pass_through: bool = tag(
        "disable_collisions_on_attach",
        default=False,
        doc="Disable the collisions of the attached object.",
    )
    contact_topic: str = tag("contact_topic", default="", doc="No effect.")


class GraspFix(Plugin[GraspFixParameters]):
    """Attaches an object to the palm while fingers grip it from opposite sides.

    Contacts are checked at ``<update_rate>``. A collision is gripped if the angle between the
    forces of two fingers on it exceeds ``<forces_angle_tolerance>``, and the smaller force is at
    least 0.3 times the larger one. Each check adds 1 to the grip counter of a gripped collision,
    and subtracts 1 from all other counters.

    An object is attached to the palm by a fixed joint when the grip counter of one of its
    collisions exceeds ``<grip_count_threshold>``. The object is released when the counter no longer
    exceeds the threshold and the object's distance to a finger has changed by more than
    ``<release_tolerance>``. A hand holds one object at a time.

    Events are published on ``/gazebo_grasp_plugin_event_republisher/grasp_events``, as by the
    republisher of the original package. Original plugin: ``gazebo_grasp_plugin`` by Jennifer
    Buehler.
    """

    filenames: ClassVar[tuple[str, ...]] = ("libgazebo_grasp_fix.so",)
    parameters: ClassVar[type] = GraspFixParameters

    def configure(self) -> None:
        config = self.config
        if config.angle < 90 or config.angle > 180:
            place = self.place_of("forces_angle_tolerance")
            raise invalid("forces_angle_tolerance", config.angle, "from 90 to 180", place)
        self.check_above_zero(update_rate=config.rate)
        self.check_not_negative("tolerance")
        self._surroundings = self.part.surroundings()
        arms = [self._hand(element) for element in self.tag.element.find_all("arm")]
        if not arms:
            self.warn(devices.PLUGIN_IDLE, "the plugin has no <arm>, so it grasps nothing")
        self._hands = arms
        self._threshold = config.most // 2 if config.threshold is None else config.threshold
        self._Event = message_class("gazebo_grasp_plugin_ros/msg/GazeboGraspEvent")
        self._events = self.advertise(_EVENTS, "gazebo_grasp_plugin_ros/msg/GazeboGraspEvent")
        self.part.schedule(config.rate, after=self._look)

    def reset(self) -> None:
        for hand in self._hands:
            hand.forget()

    def _hand(self, element: Element) -> _Hand:
        names = {}
        for name in ("arm_name", "palm_link"):
            child = element.find(name)
            if child is None:
                raise missing("arm", name, element.origin)
            names[name] = child.text.strip()
        fingers = [each.text.strip() for each in element.find_all("gripper_link")]
        if not fingers:
            raise missing("arm", "gripper_link", element.origin)
        links = [self.part.link(name, origin=element.origin) for name in fingers]
        self.part.link(names["palm_link"], origin=element.origin)
        return _Hand(self, names["arm_name"], names["palm_link"], links)

    def _look(self) -> None:
        for hand in self._hands:
            pressed = hand.pressed(self._surroundings.moving)
            gripped = {
                name for name, forces in pressed.items() if _holds(forces, self.config.angle)
            }
            for name in gripped:
                count = hand.counts[name] = min(hand.counts.get(name, 0) + 1, self.config.most)
                if count > self._threshold and hand.object is None:
                    hand.take(name, list(pressed[name]), collides=not self.config.pass_through)
                    self._publish_event(hand, name, attached=True)
            for name in hand.counts.keys() - gripped:
                count = hand.counts[name] = max(hand.counts[name] - 1, 0)
                let_go = name == hand.object and count <= self._threshold
                if let_go and hand.opened(self.config.tolerance):
                    hand.release()
                    hand.counts[name] = 0
                    self._publish_event(hand, name, attached=False)

    def _publish_event(self, hand: _Hand, name: str, *, attached: bool) -> None:
        if self._events.wanted:
            self._events.publish(self._Event(hand.name, name, attached))


class _Hand:
    """A palm and its fingers."""

    def __init__(
        self, plugin: Plugin[GraspFixParameters], name: str, palm: str, fingers: list[LinkHandle]
    ) -> None:
        self.name = name
        self.counts: dict[str, int] = {}
        """Grip counters by collision."""
        self.object: str | None = None
        """The attached collision."""
        self._part, self._palm = plugin.part, palm
        self._grip = plugin.part.attachment()
        description = plugin.part.description
        self._fingers = {
            f"{finger.name}::{collision.name}": finger
            for finger in fingers
            for link in description.links
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
            model, _, link = contact.second.rpartition("::")[0].partition("::")
            if model == self._part.name or (model, link) not in moving:
                continue
            finger = contact.first.partition("::")[2]
            forces = forces_by_collision.setdefault(contact.second, {})
            forces[finger] = forces.get(finger, np.zeros(3)) - contact.force
            x, y, z = contact.position.tolist()
            self._points[contact.second, finger] = (x, y, z)
        return forces_by_collision

    def take(self, name: str, fingers: list[str], *, collides: bool) -> None:
        """Attaches the link of a collision to the palm."""
        model, _, link = name.rpartition("::")[0].partition("::")
        self.object = name
        self._grip.hold((self._part.name, self._palm), (model, link), collides=collides)
        place = self._grip.link_pose().position
        self._marks = []
        for each in fingers:
            finger, point = self._fingers[each], self._points[name, each]
            local = finger.pose.inverse().apply(point)
            self._marks.append((finger, local, math.dist(point, place)))

    def opened(self, tolerance: float) -> bool:
        """Whether a finger has left the object, or the object no longer exists."""
        if self._grip.held is None:
            return True
        place = self._grip.link_pose().position
        return any(
            abs(math.dist(finger.pose.apply(local), place) - distance) > tolerance
            for finger, local, distance in self._marks
        )

    def release(self) -> None:
        """Detaches the object."""
        self.object = None
        self._grip.release()

    def forget(self) -> None:
        """Restores the initial state after a reset."""
        self.release()
        self.counts.clear()


def _holds(forces: dict[str, Array], angle: float) -> bool:
    """Whether two of the forces are sufficiently opposite and similar in size to grip."""
    for one, two in itertools.combinations(forces.values(), 2):
        a, b = float(np.linalg.norm(one)), float(np.linalg.norm(two))
        if min(a, b) < _LEAST_FORCE or min(a, b) < _LEAST_RATIO * max(a, b):
            continue
        cosine = float(one @ two) / (a * b)
        if math.degrees(math.acos(min(1.0, max(-1.0, cosine)))) > angle:
            return True
    return False
