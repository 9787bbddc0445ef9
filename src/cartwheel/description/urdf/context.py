"""Shared state of the readers of a URDF document, and the poses in it."""

from __future__ import annotations

from dataclasses import dataclass, field

from cartwheel.description.elements import numbers
from cartwheel.description.elements.xml import Node
from cartwheel.description.files.packages import Packages
from cartwheel.description.model import Material
from cartwheel.errors import Diagnostic
from cartwheel.geometry import Pose


@dataclass(kw_only=True, slots=True)
class UrdfContext:
    """Shared state of the readers of one URDF."""

    packages: Packages
    materials: dict[str, Material] = field(default_factory=dict)
    """Materials defined for the whole robot."""
    diagnostics: list[Diagnostic] = field(default_factory=list)

    def report(self, diagnostic: Diagnostic) -> None:
        """Adds a diagnostic."""
        self.diagnostics.append(diagnostic)


def read_origin(node: Node) -> Pose:
    """The ``<origin xyz rpy>`` of an element; identity if missing."""
    origin = node.child("origin")
    if origin is None:
        return Pose()
    xyz = numbers.position(origin.vec3_of("xyz", (0.0, 0.0, 0.0)), "origin xyz", origin.origin)
    return Pose.from_xyz_rpy(xyz, origin.vec3_of("rpy", (0.0, 0.0, 0.0)))
