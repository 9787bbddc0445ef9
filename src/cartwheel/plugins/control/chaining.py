"""Controllers that command other controllers: ros2_control's reference interfaces."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import replace
from typing import Any

from cartwheel.plugins.control.files import ControllerEntry
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


def in_order(entries: Sequence[ControllerEntry]) -> list[ControllerEntry]:
    """Controllers of a file so that each comes after those whose references it names."""
    names = {entry.name: entry for entry in entries}
    done: dict[str, ControllerEntry] = {}

    def take(entry: ControllerEntry, above: tuple[str, ...]) -> None:
        if entry.name in done or entry.name in above:
            return
        for other in _named(entry.values, names):
            take(names[other], (*above, entry.name))
        done[entry.name] = entry

    for entry in entries:
        take(entry, ())
    return list(done.values())


def _named(values: Any, names: Mapping[str, Any]) -> list[str]:
    """Of some controllers those that begin a text of the parameters, before a slash."""
    if isinstance(values, str):
        return [first] if (first := values.partition("/")[0]) in names and "/" in values else []
    if isinstance(values, Mapping):
        values = values.values()
    elif not isinstance(values, list):
        return []
    return [name for value in values for name in _named(value, names)]
