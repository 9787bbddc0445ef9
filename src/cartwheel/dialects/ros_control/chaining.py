"""Chained controllers: the reference interfaces of ros2_control."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import replace

from cartwheel.dialects.ros_control.hardware import JointHardware


class Reference(JointHardware):
    """A reference interface: a joint's state, and a command that another controller executes.

    Args:
        owner: The controller that executes the commands.
        joint: Joint that the owner measures and commands, or a reference of another controller.
        interface: Interface of the commands.
    """

    def __init__(self, owner: str, joint: JointHardware, interface: str) -> None:
        # Handles and limits are those of the joint. Only `Hardware` writes to the joint.
        vars(self).update(vars(joint))
        self.owner = owner
        self.name = f"{owner}/{joint.name}"
        self.interface = interface
        self.interfaces = replace(joint.interfaces, name=self.name, commands=(interface,))
        self.pids = {}
        self.taken = False
        """Whether another controller commands the reference, instead of a topic."""

    @property
    def full_name(self) -> str:
        """Name in ROS 2: ``controller/joint/velocity``."""
        return f"{self.name}/{self.interface}"

    def activate(self, interface: str) -> None:
        super().activate(interface)
        self.taken = True

    def release(self) -> None:
        super().release()
        self.taken = False

    @property
    def own_name(self) -> str:
        """Name without the controller: ``joint/velocity``."""
        return self.full_name.removeprefix(f"{self.owner}/")


def owners(claims: Iterable[JointHardware]) -> list[str]:
    """Returns the names of the controllers whose references are claimed."""
    names = (each.owner for each in claims if isinstance(each, Reference))
    return list(dict.fromkeys(names))
