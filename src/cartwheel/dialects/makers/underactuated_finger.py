"""``libgazebo_underactuated_finger.so``: a tendon that bends the joints of a finger."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import ClassVar

from cartwheel.codes import devices
from cartwheel.description.model import Element
from cartwheel.dialects.plugin import Plugin
from cartwheel.dialects.tags import invalid, missing, number, tag
from cartwheel.simulation.limits import FARTHEST
from cartwheel.simulation.servo import ServoHandle

_LEAST_SCALE = 1 / FARTHEST


@dataclass(frozen=True, kw_only=True, slots=True)
class UnderactuatedFingerParameters:
    actuated_joint: str = tag("actuatedJoint", doc="Joint of the motor that pulls the tendon.")
    joints: tuple[str, ...] = tag(
        "virtualJoint",
        default=(),
        nested=True,
        doc="A joint of the finger: `<name>` and `<scale_factor>`. The joint's target is "
        "the motor's angle divided by the scale factor. `<pid_gains>` has no effect, "
        "because a position servo moves the joint. Repeat the tag for each joint.",
    )


@dataclass(frozen=True, kw_only=True, slots=True)
class _Phalanx:
    servo: ServoHandle
    scale: float
    limits: tuple[float, float]


class UnderactuatedFinger(Plugin[UnderactuatedFingerParameters]):
    """Bends the joints of a finger in proportion to a motor's angle, up to the joint limits.

    A joint that meets an obstacle exerts at most its effort limit; the other joints continue to
    bend. Original plugin: ``gazebo_underactuated_finger`` in the package ``pal_gazebo_plugins``.
    """

    filenames: ClassVar[tuple[str, ...]] = ("libgazebo_underactuated_finger.so",)
    parameters: ClassVar[type] = UnderactuatedFingerParameters

    def configure(self) -> None:
        self._motor = self.part.joint(self.config.actuated_joint, origin=self.tag.origin)
        self._phalanges = [
            self._phalanx(element) for element in self.tag.element.find_all("virtualJoint")
        ]
        if not self._phalanges:
            self.warn(
                devices.PLUGIN_IDLE, "the plugin has no <virtualJoint>, so the finger does not bend"
            )
        self.part.schedule(0, before=self._bend)

    def _phalanx(self, element: Element) -> _Phalanx:
        children = {}
        for each in ("name", "scale_factor"):
            child = element.find(each)
            if child is None:
                raise missing("virtualJoint", each, element.origin)
            children[each] = child
        scale = number(children["scale_factor"], least=-FARTHEST, most=FARTHEST)
        if abs(scale) < _LEAST_SCALE:
            wanted = f"at least {_LEAST_SCALE:g} or at most {-_LEAST_SCALE:g}"
            raise invalid("scale_factor", scale, wanted, children["scale_factor"].origin)
        name = children["name"].text.strip()
        servo = self.part.servo(name, max_effort=None, origin=element.origin)
        joint = self.part.description.joint(name)
        low, high = (joint.axis.lower, joint.axis.upper) if joint is not None else (None, None)
        return _Phalanx(
            servo=servo,
            scale=scale,
            limits=(-math.inf if low is None else low, math.inf if high is None else high),
        )

    def _bend(self) -> None:
        pulled = self._motor.position
        for phalanx in self._phalanges:
            low, high = phalanx.limits
            phalanx.servo.command_position(min(max(pulled / phalanx.scale, low), high))
