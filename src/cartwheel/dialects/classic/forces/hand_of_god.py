"""``libgazebo_ros_hand_of_god.so``: a link that is pulled to a tf frame."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

from cartwheel.devices.contact.force import FrameSpring, FrameSpringConfig
from cartwheel.dialects.plugin import Plugin
from cartwheel.dialects.tags import tag


@dataclass(frozen=True, kw_only=True, slots=True)
class HandOfGodParameters:
    link: str = tag(
        "linkName", "link_name", role="link", doc="Link to pull. Gravity does not act on it."
    )
    frame: str = tag(
        "frameId",
        "frame_id",
        default="hog",
        doc="Prefix of the frames `<frameId>_desired` (target) and `<frameId>_actual` (current "
        "pose). If the `<plugin>` contains `<ros>`, the default is `world`.",
    )
    stiffness: float = tag(
        "kl", default=200.0, unit="N/m", least=0.0, doc="Stiffness of the linear spring."
    )
    turning: float = tag(
        "ka",
        default=200.0,
        unit="N m/rad",
        least=0.0,
        doc="Stiffness of the rotational spring. As in Gazebo, the actual stiffness is half of "
        "this value.",
    )


class HandOfGod(Plugin[HandOfGodParameters]):
    """Pulls a link to the pose of a tf frame with a critically damped spring.

    The target is the pose of the frame ``<frameId>_desired`` relative to ``world``. Until tf
    provides this transform, the link is not pulled. The spring acts only on this link: no other
    body receives a reaction force. The link's pose is published as the frame ``<frameId>_actual``.
    Original plugin: ``gazebo_ros_hand_of_god`` in the package ``gazebo_plugins``.
    """

    filenames: ClassVar[tuple[str, ...]] = ("libgazebo_ros_hand_of_god.so",)

    def configure(self) -> None:
        config, element = self.config, self.tag.element
        name = config.frame
        if element.find("ros") is not None and element.find("frame_id") is None:
            name = "world"
        device = FrameSpringConfig(
            link=config.link,
            target=f"{name}_desired",
            actual=f"{name}_actual",
            stiffness=config.stiffness,
            half_angle_stiffness=config.turning,
        )
        self.add(FrameSpring(self.scope, device))
