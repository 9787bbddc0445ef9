"""Loads mesh files as triangles, placed as in rviz and Gazebo.

STL, OBJ and DAE, which most robots use, are read here, because they must load within the first
second. PLY and glTF are read with trimesh, whose import alone takes 0.1 s.

Coordinate axes are used as written in the file. COLLADA's ``<up_axis>`` and glTF's y-up axis are
ignored, because rviz and Gazebo ignore both, and published robots have matching ``rpy`` values.
COLLADA's ``<unit>`` is applied, as in both programs.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np

from cartwheel.codes.files import FILE_MISSING
from cartwheel.description import model
from cartwheel.description.files.regular_files import read_regular
from cartwheel.description.meshes.dae import read_dae
from cartwheel.description.meshes.generic import read_with_trimesh
from cartwheel.description.meshes.kept import Kept
from cartwheel.description.meshes.obj import read_obj
from cartwheel.description.meshes.standing import Standing, standing_pieces
from cartwheel.description.meshes.stl import glance, read_stl
from cartwheel.description.meshes.submesh import (
    MOST_BYTES,
    MOST_TRIANGLES,
    Floats,
    Ints,
    MeshError,
    Submesh,
    memory_of,
    scale_submesh,
    unique_rows,
)
from cartwheel.errors import Origin
from cartwheel.similar_names import meant, suggestion

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

_MOST_FILES = 1 << 30
"""Maximum memory of the cached files, bytes."""
_MOST_DERIVED = 1 << 28
"""Maximum memory of cached surfaces, and of cached collision geometry, bytes."""
_COARSER = "Reduce the mesh, for example with Blender's Decimate modifier."


class _Loaded:
    """The contents of a file.

    Args:
        submeshes: The parts, or a function that reads them at the first access.
        notes: See `mesh_notes`.
        size: See `known_size`.
        memory: The memory of the contents, bytes.
    """

    def __init__(
        self,
        submeshes: Callable[[], tuple[Submesh, ...]] | tuple[Submesh, ...],
        notes: tuple[str, ...] = (),
        size: float | None = None,
        *,
        memory: int,
    ) -> None:
        self._submeshes = submeshes
        self._named: dict[str, tuple[Submesh, ...]] | None = None
        self.notes = notes
        self.size = size
        self.memory = memory

    @property
    def submeshes(self) -> tuple[Submesh, ...]:
        if callable(self._submeshes):
            self._submeshes = self._submeshes()
        return self._submeshes

    def named(self, name: str) -> tuple[Submesh, ...]:
        """The parts with a name. Gazebo uses the node's name, or else the geometry's."""
        if self._named is None:
            named: dict[str, list[Submesh]] = {}
            for part in self.submeshes:
                named.setdefault(part.name, []).append(part)
            nodes = frozenset(named)
            for part in self.submeshes:
                if part.geometry not in nodes:
                    named.setdefault(part.geometry, []).append(part)
            self._named = {key: tuple(parts) for key, parts in named.items()}
        return self._named.get(name, ())


def load_mesh(mesh: model.Mesh, *, origin: Origin | None = None) -> tuple[Submesh, ...]:
    """The mesh's submeshes, scaled, in the frame of the visual or collision.

    Files are cached by modification time and size; the arrays are shared and read-only.

    Args:
        mesh: The file, its scale, and the selected submesh.
        origin: The element that refers to the file, for the error.

    Raises:
        MeshError: The file is missing, empty, damaged or in an unsupported format.
    """
    _check_scale(mesh, origin)
    loaded = _loaded(mesh.path, origin)
    submeshes = loaded.submeshes if mesh.submesh is None else _select(mesh, loaded, origin)
    return tuple(scale_submesh(submesh, mesh.scale) for submesh in submeshes)


def check_mesh(mesh: model.Mesh, *, origin: Origin | None = None) -> None:
    """Raises the errors of `load_mesh`, but reads the triangles only where they may cause one.

    Args:
        mesh: As for `load_mesh`.
        origin: As for `load_mesh`.

    Raises:
        MeshError: As `load_mesh`.
    """
    _check_scale(mesh, origin)
    loaded = _loaded(mesh.path, origin)
    if mesh.submesh is not None:
        _select(mesh, loaded, origin)


def known_size(mesh: model.Mesh) -> float | None:
    """A lower bound of the mesh's size in m, known without reading its triangles.

    A mesh with a known size has no images, colours and normals. None if nothing is known.

    Raises:
        MeshError: As `load_mesh`.
    """
    size = _loaded(mesh.path, None).size
    return None if size is None else size * min(abs(factor) for factor in mesh.scale)


def _check_scale(mesh: model.Mesh, origin: Origin | None) -> None:
    # Outside this range, single-precision coordinates under- or overflow.
    if not all(1e-30 < abs(factor) < 1e30 for factor in mesh.scale):
        raise MeshError(
            mesh.path,
            f"the scale {mesh.scale} reduces the mesh to zero size",
            origin=origin,
            values={"scale": mesh.scale},
        )


def mesh_notes(mesh: model.Mesh) -> tuple[str, ...]:
    """Parts of the file that are not shown as written: missing textures, parts without a surface.

    Raises:
        MeshError: As `load_mesh`.
    """
    return _loaded(mesh.path, None).notes


def convex_hull_input(submeshes: Sequence[Submesh]) -> tuple[Floats, Ints]:
    """All submeshes as one surface with merged vertices, as input for the convex hull.

    Returns:
        Vertices (n, 3) in metres and faces (m, 3).
    """
    if not submeshes:
        return np.zeros((0, 3), dtype=np.float32), np.zeros((0, 3), dtype=np.int32)
    vertices, faces = submeshes[0].vertices, submeshes[0].faces
    if len(submeshes) > 1:
        offsets = np.cumsum([0, *(len(part.vertices) for part in submeshes)])
        vertices = np.concatenate([part.vertices for part in submeshes])
        faces = np.concatenate(
            [part.faces + offset for part, offset in zip(submeshes, offsets, strict=False)]
        )
    first, inverse = unique_rows(vertices)
    return vertices[first], inverse[faces].astype(np.int32)


def surface_of(mesh: model.Mesh) -> tuple[Floats, Ints]:
    """The surface of a whole mesh, as from `convex_hull_input`, in read-only arrays.

    Raises:
        MeshError: As `load_mesh`.
    """
    return _surfaces.get((mesh, _changed(mesh)), lambda: _surface(mesh))


def _surface(mesh: model.Mesh) -> tuple[Floats, Ints]:
    vertices, faces = convex_hull_input(load_mesh(mesh))
    vertices.flags.writeable = faces.flags.writeable = False
    return vertices, faces


def standing_parts(mesh: model.Mesh) -> Standing:
    """Collision geometry of a fixed mesh; see `standing`.

    Raises:
        MeshError: As `load_mesh`.
    """
    return _standing.get((mesh, _changed(mesh)), lambda: standing_pieces(*surface_of(mesh)))


def _changed(mesh: model.Mesh) -> int:
    """When the mesh's file was modified, ns; 0 if it does not exist."""
    try:
        return mesh.path.stat().st_mtime_ns
    except OSError:
        return 0


_Key = tuple[model.Mesh, int]
_surfaces: Kept[_Key, tuple[Floats, Ints]] = Kept(
    _MOST_DERIVED, lambda arrays: sum(each.nbytes for each in arrays)
)
_standing: Kept[_Key, Standing] = Kept(
    _MOST_DERIVED, lambda found: sum(piece.nbytes for piece in found.pieces)
)


def _select(mesh: model.Mesh, loaded: _Loaded, origin: Origin | None) -> tuple[Submesh, ...]:
    assert mesh.submesh is not None
    chosen = loaded.named(mesh.submesh)
    if not chosen:
        parts = loaded.submeshes
        known = sorted({name for part in parts for name in (part.name, part.geometry)} - {""})
        raise MeshError(
            mesh.path,
            f'the file has no submesh "{mesh.submesh}"',
            origin=origin,
            hint=suggestion(mesh.submesh, known),
            meant=meant(mesh.submesh, known),
            values={"submesh": mesh.submesh},
        )
    if not mesh.center_submesh:
        return chosen
    points = np.concatenate([part.vertices for part in chosen])
    centre = (points.min(axis=0) + points.max(axis=0)) / 2
    return tuple(replace(part, vertices=part.vertices - centre) for part in chosen)


def _loaded(path: Path, origin: Origin | None) -> _Loaded:
    try:
        status = path.stat()
        key = (path, status.st_mtime_ns, status.st_size)
        return _files.get(key, lambda: _read(path, status.st_size))
    except MeshError as error:
        raise MeshError(
            path,
            error.reason,
            code=error.code,
            origin=origin,
            hint=error.hint,
            meant=error.meant,
            values=error.values,
        ) from error
    except FileNotFoundError:
        raise MeshError(path, "the file does not exist", code=FILE_MISSING, origin=origin) from None
    except OSError as error:
        raise MeshError(
            path, f"the file cannot be read: {error.strerror}", origin=origin
        ) from error


# Time and size are parts of the keys, so that a changed file is loaded again.
_files: Kept[tuple[Path, int, int], _Loaded] = Kept(_MOST_FILES, lambda loaded: loaded.memory)


def _read(path: Path, size: int) -> _Loaded:
    kind = path.suffix.lower().lstrip(".")
    reader = _READERS.get(kind)
    if reader is None:
        known = ", ".join(sorted(_READERS))
        raise MeshError(
            path,
            f'the format "{kind}" is not supported',
            hint=f"Convert it to a supported format: {known}.",
            values={"format": kind},
        )
    if not size:
        raise MeshError(path, "the file is empty")
    if size > MOST_BYTES:
        raise MeshError(
            path,
            f"the file size is {size >> 20} MiB; the limit is {MOST_BYTES >> 20} MiB",
            hint=_COARSER,
            values={"bytes": size, "most": MOST_BYTES},
        )
    notes: list[str] = []
    try:
        data = read_regular(path, MOST_BYTES)
        least = glance(data, MOST_TRIANGLES) if reader is _stl else None
        if least is not None:
            # Most visuals of a simulation without cameras are never looked at.
            return _Loaded(lambda: tuple(read_stl(data)), size=least, memory=size)
        submeshes = reader(path, data, notes)
    except (OSError, MemoryError):
        raise
    except Exception as error:  # a damaged file may cause any error in its reader
        raise MeshError(path, str(error) or type(error).__name__) from error
    if not submeshes:
        raise MeshError(path, "the file has no triangles")
    count = sum(len(part.faces) for part in submeshes)
    if count > MOST_TRIANGLES:
        raise MeshError(
            path,
            f"the file has {count} triangles; the limit is {MOST_TRIANGLES}",
            hint=_COARSER,
            values={"triangles": count, "most": MOST_TRIANGLES},
        )
    return _Loaded(tuple(submeshes), tuple(notes), memory=sum(map(memory_of, submeshes)))


def _stl(_path: Path, data: bytes, _notes: list[str]) -> list[Submesh]:
    return read_stl(data)


_READERS: dict[str, Callable[[Path, bytes, list[str]], list[Submesh]]] = {
    "stl": _stl,
    "stlb": _stl,
    "obj": read_obj,
    "dae": read_dae,
    "ply": read_with_trimesh,
    "glb": read_with_trimesh,
    "gltf": read_with_trimesh,
}
