"""The meaning of a plugin's tags, for rules that compare them with the robot."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

from cartwheel.description.model import Element

Role = Literal[
    "",
    "left_wheel",
    "right_wheel",
    "left_wheels",
    "right_wheels",
    "wheel_separation",
    "wheel_base",
    "wheel_radius",
    "wheel_diameter",
    "wheel_torque",
    "joint",
    "other_joint",
    "steering",
    "link",
    "frame",
    "odometry_frame",
    "rate",
    "topic",
    "command_topic",
    "namespace",
    "tcp_port",
    "udp_port",
]
"""Meaning of a tag.

- ``left_wheel``: the joint of a driven wheel; ``left_wheels``: joints separated by spaces.
- ``steering``: a joint that steers a wheel; ``joint``: any other joint that the plugin drives;
  ``other_joint``: a joint that it measures, or that follows another one.
- ``wheel_separation``: distance between wheels across the robot; ``wheel_base``: along it.
- ``link``: the link that the plugin measures or moves.
- ``frame``: the frame ID of messages, which is the name of a link.
- ``odometry_frame``: the frame of an odometry, in which the robot moves.
- ``rate``: how often per second the plugin does something.
- ``topic``: a topic on which the plugin publishes; ``namespace``: the first part of its name,
  which defaults to the plugin's name.
- ``command_topic``: the topic on which a drive plugin receives its commands.
- ``tcp_port``, ``udp_port``: a port that the plugin opens.
"""
WHEEL_ROLES: tuple[Role, ...] = ("left_wheel", "right_wheel", "left_wheels", "right_wheels")
DRIVEN_ROLES: tuple[Role, ...] = (*WHEEL_ROLES, "steering", "joint")
JOINT_ROLES: tuple[Role, ...] = (*DRIVEN_ROLES, "other_joint")


@dataclass(frozen=True, kw_only=True, slots=True)
class TagRole:
    """A tag with a meaning."""

    role: Role
    tags: tuple[str, ...]
    """Spellings of the tag; the first one that exists is read."""
    default: tuple[float | str, ...]
    """Value without the tag; empty if the tag is required or the value depends on others."""
    obsolete: tuple[str, ...] = ()
    """Spellings that Gazebo 11 ignores."""
    wheels: tuple[tuple[str, ...], ...] = ()
    """For a size: the tags of the measured wheels' joints, in groups. A distance has two groups."""

    def joints(self, element: Element) -> tuple[str, ...]:
        """Returns the joints in the tag, or the default joints; `element` contains the tag."""
        for name in self.tags:
            texts = [text for child in element.find_all(name) if (text := child.text.strip())]
            if texts:
                break
        else:
            texts = [str(joint) for joint in self.default]
        if self.role in ("left_wheels", "right_wheels"):
            return tuple(" ".join(texts).split())
        return tuple(texts)


def wheels(roles: tuple[TagRole, ...], side: Literal["left", "right"]) -> tuple[TagRole, ...]:
    """Returns the tags with the joints of driven wheels on one side."""
    return tuple(each for each in roles if each.role in (f"{side}_wheel", f"{side}_wheels"))
