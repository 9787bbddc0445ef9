"""Mesh files as triangles in metres."""

from cartwheel.description.meshes.loading import (
    convex_hull_input,
    load_mesh,
    mesh_notes,
    standing_parts,
)
from cartwheel.description.meshes.submesh import MeshError, Submesh

__all__ = [
    "MeshError",
    "Submesh",
    "convex_hull_input",
    "load_mesh",
    "mesh_notes",
    "standing_parts",
]
