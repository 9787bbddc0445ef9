"""Service types that have different versions under the same name in different ROS 2 releases.

The graph uses the newest version. Jazzy and Kilted have version 1 of simulation_interfaces,
which lacks the nested fields and the flags of version 2. Its types are in a package whose name
ends in ``_v1`` here.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from cartwheel.messages.convert import recast
from cartwheel.messages.ros2.types import Ros2Service, ros2_service
from cartwheel.messages.store import FIRST, service_name

_SIMULATION = "simulation_interfaces"
_TWO_VERSIONS = frozenset(
    f"{_SIMULATION}/srv/{name}"
    for name in ("GetSpawnables", "LoadWorld", "SetEntityState", "SpawnEntity")
)


@dataclass(frozen=True, slots=True)
class OlderService:
    """An older version of a service type, which clients may still use."""

    type: Ros2Service
    newest: str
    """Name of the service type in the graph."""

    def request(self, older: Any) -> Any:
        """Converts a request to the newest version."""
        made = recast(older, f"{self.newest}_Request")
        for field in ("entity_resource", "world_resource"):
            if hasattr(made, field):
                setattr(made, field, recast(older, f"{_SIMULATION}/msg/Resource"))
        for flag in ("set_pose", "set_twist"):
            # Version 1 has no such flags, and always sets the pose and the velocity.
            if hasattr(made, flag):
                setattr(made, flag, True)
        return made

    def response(self, newer: Any) -> Any:
        """Converts a response to this older version."""
        made = recast(newer, self.type.response)
        if hasattr(made, "spawnables"):
            made.spawnables = [_spawnable(each) for each in newer.spawnables]
        return made


def older_versions(name: str) -> tuple[OlderService, ...]:
    """Older versions of a service type ``pkg/srv/Name`` or ``pkg/Name``; usually empty."""
    full = service_name(name)
    if full not in _TWO_VERSIONS:
        return ()
    package, _, rest = full.partition("/")
    return (OlderService(ros2_service(f"{package}{FIRST}/{rest}"), full),)


def _spawnable(newer: Any) -> Any:
    made = recast(newer, f"{_SIMULATION}{FIRST}/msg/Spawnable")
    made.uri = newer.entity_resource.uri
    return made
