"""Service types of which ROS 2's releases have different versions under one name.

The graph has the newest. Jazzy and Kilted have version 1 of simulation_interfaces, which lacks
what is nested or chosen by flags in version 2; its types are in a package here whose name ends
in ``_v1``.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from cartwheel.messages.convert import recast
from cartwheel.messages.ros2_types import Ros2Service, ros2_service
from cartwheel.messages.store import FIRST, service_name

_SIMULATION = "simulation_interfaces"
_TWO_VERSIONS = frozenset(
    f"{_SIMULATION}/srv/{name}"
    for name in ("GetSpawnables", "LoadWorld", "SetEntityState", "SpawnEntity")
)


@dataclass(frozen=True, slots=True)
class OlderService:
    """A version of a service type that others may still have."""

    type: Ros2Service
    newest: str
    """Name of the graph's type."""

    def request(self, older: Any) -> Any:
        """A request as the graph has it."""
        made = recast(older, f"{self.newest}_Request")
        for field in ("entity_resource", "world_resource"):
            if hasattr(made, field):
                setattr(made, field, recast(older, f"{_SIMULATION}/msg/Resource"))
        for flag in ("set_pose", "set_twist"):
            # There were none, nor one for accelerations, which were free to be ignored.
            if hasattr(made, flag):
                setattr(made, flag, True)
        return made

    def response(self, newer: Any) -> Any:
        """A response as they have it."""
        made = recast(newer, self.type.response)
        if hasattr(made, "spawnables"):
            made.spawnables = [_spawnable(each) for each in newer.spawnables]
        return made


def older_versions(name: str) -> tuple[OlderService, ...]:
    """The older versions of a service type ``pkg/srv/Name`` or ``pkg/Name``; mostly none."""
    full = service_name(name)
    if full not in _TWO_VERSIONS:
        return ()
    package, _, rest = full.partition("/")
    return (OlderService(ros2_service(f"{package}{FIRST}/{rest}"), full),)


def _spawnable(newer: Any) -> Any:
    made = recast(newer, f"{_SIMULATION}{FIRST}/msg/Spawnable")
    made.uri = newer.entity_resource.uri
    return made
