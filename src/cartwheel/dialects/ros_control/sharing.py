"""Joints that two controllers command at the same time, by different interfaces.

In ROS 2, a controller claims interfaces of joints. Two controllers may therefore run that command
the position and the velocity of one joint. Gazebo's hardware then follows one of both commands.
"""

from __future__ import annotations

import contextlib
from collections.abc import Iterator, Sequence

from cartwheel.dialects.ros_control.controller import Controller
from cartwheel.dialects.ros_control.hardware import JointHardware


class SharedJoints:
    """Which of its controllers each joint follows.

    Args:
        priorities: The command interfaces. A joint follows the first one that is commanded.
    """

    def __init__(self, priorities: Sequence[str]) -> None:
        self._priorities = tuple(priorities)
        self._commanded: dict[JointHardware, list[tuple[str, Controller]]] = {}
        """The commanded interfaces of each joint with their controllers, the followed one first."""
        self.any = False
        """Whether two controllers command a joint."""

    def begin(self, controller: Controller) -> None:
        """Lets a controller command its joints."""
        for name, joint in controller.claims.items():
            by = self._commanded.setdefault(joint, [])
            by.append((controller.interfaces[name], controller))
            by.sort(key=lambda each: self._rank(each[0]))
            if by[0][1] is controller:
                joint.activate(by[0][0])
        self._count()

    def lost(self, controller: Controller) -> Iterator[tuple[JointHardware, str, Controller, str]]:
        """The commands that a controller's joints do not follow, or those that they follow instead.

        Yields:
            A joint that it shares, the interface and the controller that it does not follow, and
            the interface that it follows.
        """
        for joint in controller.claims.values():
            by = self._commanded.get(joint, [])
            for interface, other in by[1:]:
                if controller in (other, by[0][1]):
                    yield joint, interface, other, by[0][0]

    def end(self, controller: Controller) -> None:
        """Takes its joints from a controller. They follow the others that command them, if any."""
        for joint in controller.claims.values():
            before = self._commanded.pop(joint, [])
            by = [each for each in before if each[1] is not controller]
            if not by:
                joint.release()
                continue
            self._commanded[joint] = by
            if by[0] != before[0]:
                joint.activate(by[0][0])
        self._count()

    def clear(self) -> None:
        """Forgets all controllers."""
        self._commanded.clear()
        self._count()

    @contextlib.contextmanager
    def kept(self, controller: Controller) -> Iterator[None]:
        """Within the block, a controller's commands to joints that follow another one are lost."""
        lost = [
            (joint, joint.command, joint.rate, joint.damping, joint.strength)
            for joint in (controller.claims.values() if self.any else ())
            if (by := self._commanded.get(joint)) and by[0][1] is not controller
        ]
        yield
        for joint, command, rate, damping, strength in lost:
            joint.command, joint.rate = command, rate
            joint.damping, joint.strength = damping, strength

    def _rank(self, interface: str) -> int:
        known = interface in self._priorities
        return self._priorities.index(interface) if known else len(self._priorities)

    def _count(self) -> None:
        self.any = any(len(each) > 1 for each in self._commanded.values())
