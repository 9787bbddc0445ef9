"""``libwarthog_suspension_plugin.so``: the suspension of Clearpath's Warthog."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

from cartwheel.dialects.plugin import Plugin
from cartwheel.dialects.tags import tag


@dataclass(frozen=True, kw_only=True, slots=True)
class WarthogSuspensionParameters:
    stiffness: float = tag(
        "suspension_k",
        unit="N m/rad",
        doc="Stiffness of each joint's spring, which is at rest at position 0.",
    )
    damping: float = tag("suspension_b", unit="N m s/rad", doc="Damping of each joint.")
    left: str = tag(
        "left_joint", default="left_diff_unit_joint", doc="Suspension joint on the left side."
    )
    right: str = tag(
        "right_joint", default="right_diff_unit_joint", doc="Suspension joint on the right side."
    )


class WarthogSuspension(Plugin[WarthogSuspensionParameters]):
    """Applies a spring and a damper to the suspension joint on each side.

    Original plugin: ``warthog_suspension_plugin`` in the package ``warthog_gazebo``, which supports
    only the default joint names.
    """

    filenames: ClassVar[tuple[str, ...]] = ("libwarthog_suspension_plugin.so",)
    parameters: ClassVar[type] = WarthogSuspensionParameters

    def configure(self) -> None:
        config, part, origin = self.config, self.part, self.tag.origin
        self.check_not_negative("stiffness", "damping")
        self._sides = [
            (part.joint(name, origin=origin), part.servo(name, max_effort=None, origin=origin))
            for name in (config.left, config.right)
        ]
        part.schedule(0, before=self._bear)

    def _bear(self) -> None:
        for joint, servo in self._sides:
            effort = -self.config.stiffness * joint.position
            servo.command_effort(effort, damping=self.config.damping)
