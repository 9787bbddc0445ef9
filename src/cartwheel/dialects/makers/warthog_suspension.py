"""``libwarthog_suspension_plugin.so``: the suspension of Clearpath's Warthog."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

from cartwheel.devices.mechanisms.suspension import Suspension, SuspensionConfig
from cartwheel.dialects.plugin import Plugin
from cartwheel.dialects.tags import tag


@dataclass(frozen=True, kw_only=True, slots=True)
class WarthogSuspensionParameters:
    stiffness: float = tag(
        "suspension_k",
        unit="N m/rad",
        least=0.0,
        doc="Stiffness of the spring at each joint. The spring exerts no torque at position 0.",
    )
    damping: float = tag(
        "suspension_b", unit="N m s/rad", least=0.0, doc="Damping coefficient of each joint."
    )
    left: str = tag(
        "left_joint",
        default="left_diff_unit_joint",
        role="joint",
        doc="Suspension joint on the left side.",
    )
    right: str = tag(
        "right_joint",
        default="right_diff_unit_joint",
        role="joint",
        doc="Suspension joint on the right side.",
    )


class WarthogSuspension(Plugin[WarthogSuspensionParameters]):
    """Applies the torque of a spring and a damper to the suspension joint on each side of a robot.

    Original plugin: ``warthog_suspension_plugin`` in the package ``warthog_gazebo``, which supports
    only the default joint names.
    """

    filenames: ClassVar[tuple[str, ...]] = ("libwarthog_suspension_plugin.so",)

    def configure(self) -> None:
        config = self.config
        device = SuspensionConfig(
            joints=(config.left, config.right),
            stiffness=config.stiffness,
            damping=config.damping,
        )
        self.add(Suspension(self.scope, device))
