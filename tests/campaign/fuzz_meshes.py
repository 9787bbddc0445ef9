"""Mesh files of every format, as the visual and as the collision of a static model."""

from __future__ import annotations

import itertools
from collections.abc import Callable
from pathlib import Path

from tests.campaign import mutating
from tests.campaign.target import Target

from cartwheel.errors import CartwheelError

_MODELS = Path(__file__).parents[2]
_LARGEST = 60_000
"""Bytes of a seed; larger ones make few inputs."""


def _files(suffix: str) -> list[bytes]:
    found = []
    for folder in ("robots", "models"):
        for path in sorted((_MODELS / folder).rglob(f"*{suffix}")):
            data = path.read_bytes()
            if len(data) <= _LARGEST:
                found.append(data)
    return found[:12]


def _reader(suffix: str) -> Callable[[bytes], None]:
    numbers = itertools.count()

    def run_one(data: bytes) -> None:
        import numpy as np

        from cartwheel.description.meshes import load_mesh, standing_parts
        from cartwheel.description.model import Mesh

        # Files are cached by name, time and size: each input is another file.
        path = Path(f"mesh{next(numbers)}{suffix}").resolve()
        path.write_bytes(data)
        mesh = Mesh(uri="", path=path)
        try:
            for part in load_mesh(mesh):
                assert np.isfinite(part.vertices).all()
                assert part.faces.min() >= 0
                assert part.faces.max() < len(part.vertices)
            standing_parts(mesh)
        finally:
            path.unlink()

    return run_one


def _stl() -> list[bytes]:
    text = b"solid a\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\n"
    return [*_files(".stl"), text + b"endloop\nendfacet\nendsolid a\n", _exported("stl")]


def _exported(kind: str) -> bytes:
    import trimesh

    data = trimesh.creation.annulus(0.2, 0.5, 1.0, sections=8).export(file_type=kind)
    return data.encode() if isinstance(data, str) else data


def _obj() -> list[bytes]:
    text = b"mtllib a.mtl\no a\nv 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nvt 0 0\nvt 1 0\nvn 0 0 1\n"
    faces = b"usemtl m\nf 1/1/1 2/2/1 3/1/1\nf -1 -2 -3\nf 1//1 2//1 4//1\nf 1 2 3 4\n"
    return [text + faces, _exported("obj"), *_files(".obj")]


_KINDS = {
    "stl": (_stl, mutating.binary),
    "obj": (_obj, mutating.text),
    "dae": (lambda: [*_files(".dae"), _exported("dae")], mutating.xml),
    "glb": (lambda: [_exported("glb"), *_files(".glb")], mutating.binary),
    "ply": (lambda: [_exported("ply")], mutating.binary),
}
TARGETS = tuple(
    Target(
        name=kind,
        seeds=seeds,
        run_one=_reader(f".{kind}"),
        allowed=(CartwheelError,),
        mutate=mutate,
    )
    for kind, (seeds, mutate) in _KINDS.items()
)
