"""Joints that follow other joints: mimic joints, and the differential of a rocker-bogie chassis."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, ClassVar

from cartwheel.codes import devices
from cartwheel.description.elements.numbers import MOST_RATIO
from cartwheel.description.model import Element, Mimic
from cartwheel.dialects.plugin import Plugin
from cartwheel.dialects.tags import missing, number, tag
from cartwheel.errors import PluginError
from cartwheel.simulation.limits import FARTHEST


@dataclass(frozen=True, kw_only=True, slots=True)
class MimicJointParameters:
    joint: str = tag(
        "joint", default="left_joint", role="other_joint", doc="Joint whose position is mimicked."
    )
    mimic_joint: str = tag(
        "mimicJoint", default="right_joint", role="other_joint", doc="Joint that mimics `<joint>`."
    )
    multiplier: float = tag(
        "multiplier",
        default=1.0,
        most=MOST_RATIO,
        doc="Factor m. The position of `<mimicJoint>` is m times the position of `<joint>`, plus "
        "`<offset>`.",
    )
    offset: float = tag(
        "offset",
        default=0.0,
        unit="rad or m",
        most=FARTHEST,
        doc="Added to the position of `<mimicJoint>`.",
    )
    max_effort: float = tag(
        "maxEffort",
        default=1.0,
        unit="N m or N",
        doc="No effect: the joint mimics the position exactly.",
    )
    sensitiveness: float = tag(
        "sensitiveness",
        default=0.0,
        unit="rad or m",
        doc="No effect: the joint mimics even the smallest motion.",
    )
    has_pid: str | None = tag(
        "hasPID", default=None, doc="No effect: the joint mimics the position exactly."
    )


class MimicJoint(Plugin[MimicJointParameters]):
    """Makes the position of a joint follow the position of another joint.

    In a URDF, a joint with ``<mimic>`` has the same effect without a plugin. Original plugin:
    ``MimicJointPlugin`` in the package ``roboticsgroup_upatras_gazebo_plugins``.
    """

    filenames: ClassVar[tuple[str, ...]] = (
        "libroboticsgroup_upatras_gazebo_mimic_joint_plugin.so",
        "libroboticsgroup_gazebo_mimic_joint_plugin.so",
        "libgazebo_mimic_joint_plugin.so",
        "libtmc_gazebo_mimic_plugin.so",
    )

    def configure(self) -> None:
        config = self.config
        _check_different(self, config.joint, config.mimic_joint)
        mimic = Mimic(joint=config.joint, multiplier=config.multiplier, offset=config.offset)
        self.part.mimic(config.mimic_joint, mimic, origin=self.tag.origin)


@dataclass(frozen=True, kw_only=True, slots=True)
class MimicListParameters:
    mimics: tuple[str, ...] = tag(
        "mimic",
        default=(),
        nested=True,
        doc="A joint that mimics the joint in the attribute or tag `joint`, with `offset` and "
        "`multiplier` as for a `<mimic>` in a URDF. The gains and limits of the controller, such "
        "as `P` and `command_max`, have no effect: the position is mimicked exactly. Repeat the "
        "tag for each joint.",
    )


class MimicList(Plugin[MimicListParameters]):
    """Makes the positions of several joints follow those of other joints.

    Original plugin: ``MimicPlugin`` in the package ``seed_r7_gazebo``.
    """

    filenames: ClassVar[tuple[str, ...]] = ("libmimic_plugin.so",)

    def configure(self) -> None:
        for element in self.tag.element.find_all("mimic"):
            follower, stated = element.text.strip(), _stated(element, "joint")
            if not follower or stated is None:
                raise missing("mimic", "joint", element.origin)
            leader = stated.text.strip()
            _check_different(self, leader, follower)
            multiplier, offset = (_stated(element, name) for name in ("multiplier", "offset"))
            mimic = Mimic(
                joint=leader,
                multiplier=1.0 if multiplier is None else number(multiplier, most=MOST_RATIO),
                offset=0.0 if offset is None else number(offset, most=FARTHEST),
            )
            self.part.mimic(follower, mimic, origin=element.origin)


def _stated(element: Element, name: str) -> Element | None:
    """An attribute, or a child of this name; None if there is neither."""
    text = element.attribute(name)
    if text is None:
        return element.find(name)
    return Element(tag=name, text=text, origin=element.origin)


@dataclass(frozen=True, kw_only=True, slots=True)
class DifferentialParameters:
    first: str = tag(
        "jointA", default="left_joint", role="other_joint", doc="First of the two coupled joints."
    )
    second: str = tag(
        "jointB",
        default="right_joint",
        role="other_joint",
        doc="Second of the two coupled joints. It turns by the same angle as the first one.",
    )
    force: float = tag(
        "forceConstant", default=0.0, unit="N m/rad", doc="No effect: the coupling is rigid."
    )


class Differential(Plugin[DifferentialParameters]):
    """Couples two joints so that their angles are always equal, as in a rocker-bogie suspension.

    The coupling is rigid. In Gazebo, the joints are coupled by a spring with the stiffness
    ``<forceConstant>``. Original plugin: ``differential_plugin`` in the packages
    ``leo_gazebo_plugins`` and ``leo_gz_plugins``.
    """

    filenames: ClassVar[tuple[str, ...]] = (
        "libleo_gazebo_differential_plugin.so",
        "libleo_gz_differential_plugin.so",
    )

    def configure(self) -> None:
        config = self.config
        _check_different(self, config.first, config.second)
        mimic = Mimic(joint=config.first, multiplier=1.0, offset=0.0, mutual=True)
        self.part.mimic(config.second, mimic, origin=self.tag.origin)


def _check_different(plugin: Plugin[Any], joint: str, follower: str) -> None:
    if joint == follower:
        raise PluginError(
            f'joint "{joint}" cannot mimic itself',
            code=devices.PLUGIN_PARAMETER_INVALID,
            origin=plugin.tag.origin,
            values={"joint": joint},
        )
