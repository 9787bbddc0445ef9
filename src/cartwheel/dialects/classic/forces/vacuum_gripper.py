"""``libgazebo_ros_vacuum_gripper.so``: a suction cup."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

from cartwheel.devices.grips.suction import SuctionCup, SuctionCupConfig
from cartwheel.dialects.plugin import Plugin
from cartwheel.dialects.tags import tag


@dataclass(frozen=True, kw_only=True, slots=True)
class VacuumGripperParameters:
    link: str = tag("bodyName", "link_name", role="link", doc="Link of the suction cup.")
    topic: str = tag(
        "topicName",
        default="grasping",
        doc="Topic of the Bool messages, which are true while an object is held. Gazebo's ROS 1 "
        "plugin requires this tag.",
    )
    reach: float = tag(
        "max_distance",
        default=0.05,
        unit="m",
        doc="Maximum distance between the cup's frame and the frame of the gripped link.",
    )
    fixed: tuple[str, ...] = tag(
        "fixed",
        default=(),
        doc="Name of a model or link that is never gripped. Repeat the tag for each name.",
    )


class VacuumGripper(Plugin[VacuumGripperParameters]):
    """Holds the nearest link of another model within reach, while the gripper is switched on.

    The held link keeps its pose relative to the cup, as with a fixed joint. In Gazebo, the link is
    pulled towards the cup instead. The services ``on`` and ``off`` switch the gripper on and off.
    If the ``<plugin>`` contains ``<link_name>`` (ROS 2), the service ``switch`` replaces ``on`` and
    ``off``. Original plugin: ``gazebo_ros_vacuum_gripper`` in the package ``gazebo_plugins``.
    """

    filenames: ClassVar[tuple[str, ...]] = ("libgazebo_ros_vacuum_gripper.so",)

    def configure(self) -> None:
        config = self.config
        device = SuctionCupConfig(
            link=config.link,
            topic=config.topic,
            reach=config.reach,
            excluded=frozenset(config.fixed),
            one_service=self.tag.element.find("bodyName") is None,
        )
        self.add(SuctionCup(self.scope, device))
