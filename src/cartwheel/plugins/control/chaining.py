"""Controllers that command other controllers: ros2_control's reference interfaces."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import replace

from cartwheel.plugins.control.hardware import JointHardware


class Reference(JointHardware):
    """A joint as a chained controller offers it: its state is the joint's, its command is not.

    Args:
        owner: The controller that takes the commands.
        joint: What it measures and commands; may be a reference of yet another one.
        interface: Of the commands.
    """

    def __init__(self, owner: str, joint: JointHardware, interface: str) -> None:
        # Handles and limits are those of the joint; `Hardware` alone writes to it.
        vars(self).update(vars(joint))
        self.owner = owner
        self.name = f"{owner}/{joint.name}"
        self.interface = interface
        self.interfaces = replace(joint.interfaces, name=self.name, commands=(interface,))
        self.pids = {}
        self.taken = False
        """Whether another controller commands it, and not a topic."""

    @property
    def full_name(self) -> str:
        """As ROS 2 lists it: ``controller/joint/velocity``."""
        return f"{self.name}/{self.interface}"

    def activate(self, interface: str) -> None:
        super().activate(interface)
        self.taken = True

    def release(self) -> None:
        super().release()
        self.taken = False

    @property
    def own_name(self) -> str:
        """As its controller calls it."""
        return self.full_name.removeprefix(f"{self.owner}/")


def owners(claims: Iterable[JointHardware]) -> list[str]:
    """The controllers that claims of another controller lead to."""
    found = (each.owner for each in claims if isinstance(each, Reference))
    return list(dict.fromkeys(found))
