"""``libgazebo_underactuated_finger.so``: a tendon that bends the joints of a finger."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

from cartwheel.codes import devices
from cartwheel.description.model import Element
from cartwheel.devices.joints.finger import Finger, FingerConfig, FingerJointConfig
from cartwheel.dialects.plugin import Plugin
from cartwheel.dialects.tags import invalid, number, required, tag
from cartwheel.simulation.limits import FARTHEST

_LEAST_SCALE = 1 / FARTHEST


@dataclass(frozen=True, kw_only=True, slots=True)
class UnderactuatedFingerParameters:
    actuated_joint: str = tag(
        "actuatedJoint", role="joint", doc="Joint of the motor that pulls the tendon."
    )
    joints: tuple[str, ...] = tag(
        "virtualJoint",
        default=(),
        nested=True,
        doc="A joint of the finger. The tags inside are `<name>` and `<scale_factor>`. The "
        "joint's target angle is the motor's angle divided by the scale factor. The tag "
        "`<pid_gains>` has no effect, because a position servo moves the joint. Repeat the "
        "tag for each joint.",
    )


class UnderactuatedFinger(Plugin[UnderactuatedFingerParameters]):
    """Bends the joints of a tendon-driven finger in proportion to the angle of its motor.

    Each joint bends up to its position limit. A joint that is blocked by an obstacle exerts at most
    its effort limit, while the other joints continue to bend. Original plugin:
    ``gazebo_underactuated_finger`` in the package ``pal_gazebo_plugins``.
    """

    filenames: ClassVar[tuple[str, ...]] = ("libgazebo_underactuated_finger.so",)

    def configure(self) -> None:
        elements = list(self.tag.element.find_all("virtualJoint"))
        config = FingerConfig(
            motor=self.config.actuated_joint, joints=tuple(_joint(each) for each in elements)
        )
        self.add(Finger(self.scope, config))
        if not elements:
            self.warn(
                devices.PLUGIN_IDLE, "the plugin has no <virtualJoint>, so the finger does not bend"
            )


def _joint(element: Element) -> FingerJointConfig:
    name, factor = required(element, "name"), required(element, "scale_factor")
    scale = number(factor, least=-FARTHEST, most=FARTHEST)
    if abs(scale) < _LEAST_SCALE:
        wanted = f"at least {_LEAST_SCALE:g} or at most {-_LEAST_SCALE:g}"
        raise invalid("scale_factor", scale, wanted, factor.origin)
    return FingerJointConfig(name=name.text.strip(), scale=scale, origin=element.origin)
