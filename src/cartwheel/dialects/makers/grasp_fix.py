"""``libgazebo_grasp_fix.so``: attaches objects to a hand that grips them."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import ClassVar

from cartwheel.codes import devices
from cartwheel.description.model import Element
from cartwheel.devices.grips.grasp import Grasp, GraspConfig, HandConfig
from cartwheel.dialects.plugin import Plugin
from cartwheel.dialects.tags import SMALLEST, missing, required, tag

_EVENTS = "/gazebo_grasp_plugin_event_republisher/grasp_events"


@dataclass(frozen=True, kw_only=True, slots=True)
class GraspFixParameters:
    arms: tuple[str, ...] = tag(
        "arm",
        default=(),
        nested=True,
        doc="A hand. The tags inside are `<arm_name>`, `<palm_link>`, and a `<gripper_link>` "
        "for each finger. Repeat the tag for each hand.",
    )
    angle: float = tag(
        "forces_angle_tolerance",
        default=120.0,
        unit="degrees",
        least=90.0,
        most=180.0,
        doc="Two fingers grip an object if the angle between their forces exceeds this "
        "value, which must be between 90 and 180.",
    )
    rate: float = tag(
        "update_rate",
        default=5.0,
        unit="Hz",
        least=SMALLEST,
        doc="Rate at which contacts are checked.",
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
        least=0.0,
        doc="An object can be released when its distance to a finger has changed by more than "
        "this value.",
    )
    pass_through: bool = tag(
        "disable_collisions_on_attach",
        default=False,
        doc="Whether to disable the collisions of the attached object.",
    )
    contact_topic: str = tag(
        "contact_topic",
        default="",
        doc="No effect: the plugin reads contacts directly from the simulation.",
    )


class GraspFix(Plugin[GraspFixParameters]):
    """Attaches an object to the palm of a hand while fingers grip it from opposite sides.

    Contacts are checked at ``<update_rate>``. A collision of an object counts as gripped if two
    fingers press on it from sufficiently different directions: the angle between their forces must
    exceed ``<forces_angle_tolerance>``, and the smaller force must be at least 0.3 times the larger
    one. Each collision has a grip counter. Each check adds 1 to the counters of gripped collisions,
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

    def configure(self) -> None:
        config = self.config
        hands = tuple(_hand(element) for element in self.tag.element.find_all("arm"))
        if not hands:
            self.warn(devices.PLUGIN_IDLE, "the plugin has no <arm>, so it grasps nothing")
        device = GraspConfig(
            hands=hands,
            angle=math.radians(config.angle),
            rate=config.rate,
            most=config.most,
            threshold=config.most // 2 if config.threshold is None else config.threshold,
            tolerance=config.tolerance,
            collides=not config.pass_through,
            event_topic=_EVENTS,
        )
        self.add(Grasp(self.scope, device))


def _hand(element: Element) -> HandConfig:
    name, palm = (required(element, each).text.strip() for each in ("arm_name", "palm_link"))
    fingers = tuple(each.text.strip() for each in element.find_all("gripper_link"))
    if not fingers:
        raise missing("arm", "gripper_link", element.origin)
    return HandConfig(name=name, palm=palm, fingers=fingers, origin=element.origin)
