"""Shared state of the readers of a URDF document, and the poses in it."""

from __future__ import annotations

from dataclasses import dataclass, field

from cartwheel.description.elements import numbers
from cartwheel.description.elements.xml import Node
from cartwheel.description.model import Material
from cartwheel.description.sdf.context import Context, Version
from cartwheel.geometry import Pose


@dataclass(slots=True)
class UrdfContext(Context):
    """Shared state of the readers of one URDF. SDF in its ``<gazebo>`` tags has this version."""

    version: Version = (1, 9)
    materials: dict[str, Material] = field(default_factory=dict)
    """Materials defined for the whole robot."""
    undirected: set[str] = field(default_factory=set)
    """Joints whose axis has length 0."""


def read_origin(node: Node) -> Pose:
    """The ``<origin xyz rpy>`` of an element; identity if missing."""
    origin = node.child("origin")
    if origin is None:
        return Pose()
    xyz = numbers.position(origin.vec3_of("xyz", (0.0, 0.0, 0.0)), "origin xyz", origin.origin)
    return Pose.from_xyz_rpy(xyz, origin.vec3_of("rpy", (0.0, 0.0, 0.0)))
