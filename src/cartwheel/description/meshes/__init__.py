"""Mesh files as triangles in metres."""

from cartwheel.description.meshes.loading import (
    check_mesh,
    convex_hull_input,
    known_size,
    load_mesh,
    mesh_notes,
    standing_parts,
    surface_of,
)
from cartwheel.description.meshes.submesh import MeshError, Submesh

__all__ = [
    "MeshError",
    "Submesh",
    "check_mesh",
    "convex_hull_input",
    "known_size",
    "load_mesh",
    "mesh_notes",
    "standing_parts",
    "surface_of",
]
