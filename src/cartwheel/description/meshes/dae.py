"""Reads COLLADA files: the triangles of the visual scene, placed by its nodes, in metres."""

from __future__ import annotations

import math
import re
import xml.etree.ElementTree as ET
from collections.abc import Iterator
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from cartwheel.description.meshes.corners import weld
from cartwheel.description.meshes.dae_material import Library, MaterialLook, read_look
from cartwheel.description.meshes.number_text import floats_of, integers_of
from cartwheel.description.meshes.submesh import MOST_TRIANGLES, Submesh

Array = NDArray[np.float64]
MAX_DEPTH = 100
MAX_INSTANCES = 20_000
"""Maximum number of node instances: nodes that refer to each other can multiply without limit."""

_VALUE = re.compile(rb"""(?<==)"[^"]*"|(?<==)'[^']*'""")
"""An attribute's value."""
_SURFACES = ("triangles", "polylist", "polygons", "tristrips", "trifans")
_NO_SURFACES = ("lines", "linestrips")


def read_dae(path: Path, data: bytes, notes: list[str]) -> list[Submesh]:
    """One submesh for each primitive of each geometry in the scene.

    Args:
        path: The file; textures are relative to it.
        data: Its contents.
        notes: Receives notes about skipped parts.

    Raises:
        ValueError: What is wrong with the file.
    """
    if b"<!ENTITY" in data:
        raise ValueError("the file declares XML entities, which are not allowed")
    try:
        root = _parsed(data)
    except ET.ParseError as error:
        raise ValueError(f"malformed XML: {error}") from None
    for element in root.iter():
        element.tag = element.tag.rpartition("}")[2]  # ignore the COLLADA version
    if root.tag != "COLLADA":
        raise ValueError(f"the file is not a COLLADA file: its root element is <{root.tag}>")
    return _Scene(path, root, notes).submeshes()


def _parsed(data: bytes) -> ET.Element:
    """The XML tree; some exporters write ``<`` in names, which Gazebo's reader accepts."""
    try:
        return ET.fromstring(data)  # noqa: S314 - entities are refused by the caller
    except ET.ParseError:
        mended = _VALUE.sub(lambda match: match[0].replace(b"<", b"&lt;"), data)
        if mended == data:
            raise
        return ET.fromstring(mended)  # noqa: S314


class _Scene:
    def __init__(self, path: Path, root: ET.Element, notes: list[str]) -> None:
        self.path = path
        self.root = root
        self.notes = notes
        self.library = Library(root)
        self.instances = 0
        self.triangles = 0
        self._geometries: dict[str, list[_Primitive]] = {}
        self._looks: dict[str, MaterialLook] = {}

    def _note(self, text: str) -> None:
        if text not in self.notes:
            self.notes.append(text)

    def submeshes(self) -> list[Submesh]:
        unit = self.root.find("asset/unit")
        metres = float(unit.get("meter", "1")) if unit is not None else 1.0
        if not (math.isfinite(metres) and metres > 0):
            raise ValueError(
                f"the length unit in <asset> must be positive and finite (got {metres} m)"
            )
        base = np.diag([metres, metres, metres, 1.0])
        result: list[Submesh] = []
        scene = self._visual_scene()
        if scene is not None:
            for node in scene.findall("node"):
                result += self._node(node, base, 0)
        else:  # some exporters write only geometry, without a scene
            for geometry in self.root.iterfind("library_geometries/geometry"):
                result += self._place(geometry, base, {}, geometry.get("name", ""))
        return result

    def _visual_scene(self) -> ET.Element | None:
        instance = self.root.find("scene/instance_visual_scene")
        if instance is not None:
            found = self.library.get(instance.get("url", ""))
            if found is not None:
                return found
        return self.root.find("library_visual_scenes/visual_scene")

    def _node(self, node: ET.Element, outer: Array, depth: int) -> Iterator[Submesh]:
        self.instances += 1
        if depth > MAX_DEPTH or self.instances > MAX_INSTANCES:
            raise ValueError("the COLLADA <node> elements refer to each other in a cycle")
        transform = outer @ self._transform(node)
        name = node.get("name") or node.get("id") or ""
        for child in node:
            if child.tag == "node":
                yield from self._node(child, transform, depth + 1)
            elif child.tag == "instance_node":
                yield from self._node(self._require(child.get("url", "")), transform, depth + 1)
            elif child.tag == "instance_geometry":
                geometry = self._require(child.get("url", ""))
                yield from self._place(geometry, transform, _bindings(child), name)
            elif child.tag == "instance_controller":
                skin = self._require(child.get("url", "")).find("skin")
                if skin is None:
                    self._note(
                        f'the COLLADA <controller> of node "{name}" has no <skin> and is ignored'
                    )
                    continue
                bind = skin.find("bind_shape_matrix")
                pose = transform @ _matrix(bind) if bind is not None else transform
                geometry = self._require(skin.get("source", ""))
                yield from self._place(geometry, pose, _bindings(child), name)

    def _require(self, url: str) -> ET.Element:
        found = self.library.get(url)
        if found is None:
            raise ValueError(f'the file refers to "{url}", but contains no element with this ID')
        return found

    def _transform(self, node: ET.Element) -> Array:
        result = np.eye(4)
        for step in node:
            if step.tag == "matrix":
                result = result @ _matrix(step)
            elif step.tag == "translate":
                move = np.eye(4)
                move[:3, 3] = _floats(step, 3)
                result = result @ move
            elif step.tag == "scale":
                result = result @ np.diag([*_floats(step, 3), 1.0])
            elif step.tag == "rotate":
                result = result @ _rotation(_floats(step, 4))
            elif step.tag in ("lookat", "skew"):
                self._note(
                    f"the <{step.tag}> of a COLLADA <node> is not supported and has no effect"
                )
        return result

    def _place(
        self, geometry: ET.Element, transform: Array, bindings: dict[str, str], node: str
    ) -> Iterator[Submesh]:
        key = geometry.get("id", str(id(geometry)))
        if key not in self._geometries:
            self._geometries[key] = list(self._primitives(geometry))
        geometry_name = geometry.get("name") or geometry.get("id") or node
        linear = transform[:3, :3]
        size = float(np.linalg.det(linear))
        if abs(size) < 1e-30:
            raise ValueError(f'node "{node}" scales its geometry to zero size')
        for primitive in self._geometries[key]:
            self.triangles += int(np.maximum(primitive.counts - 2, 0).sum())
            if self.triangles > MOST_TRIANGLES:
                raise ValueError(f"the file contains more than {MOST_TRIANGLES} triangles")
            look = self._look(bindings.get(primitive.material, primitive.material))
            points, corners = primitive.points
            normals = primitive.normals
            submesh = weld(
                node or geometry_name,
                primitive.counts,
                (points @ linear.T + transform[:3, 3], corners),
                normals=(normals[0] @ np.linalg.inv(linear), normals[1]) if normals else None,
                uv=primitive.uv,
                rgba=look.rgba,
                texture=look.texture if primitive.uv else None,
            )
            if submesh is not None:
                submesh = replace(submesh, geometry=geometry_name)
                yield submesh if size > 0 else _turned(submesh)

    def _look(self, material: str) -> MaterialLook:
        if material not in self._looks:
            self._looks[material] = read_look(self.library, material, self.path, self.notes)
        return self._looks[material]

    def _primitives(self, geometry: ET.Element) -> Iterator[_Primitive]:
        mesh = geometry.find("mesh")
        if mesh is None:
            self._note(f'geometry "{geometry.get("id", "")}" has no <mesh> and is ignored')
            return
        for element in mesh:
            if element.tag in _SURFACES:
                primitive = self._primitive(element)
                if primitive is not None:
                    yield primitive
            elif element.tag in _NO_SURFACES:
                self._note(f"the COLLADA elements <{element.tag}> are ignored")

    def _primitive(self, element: ET.Element) -> _Primitive | None:
        offsets: dict[str, tuple[int, str]] = {}
        stride = 0
        for each in element.findall("input"):
            offset = int(each.get("offset", "0"))
            stride = max(stride, offset + 1)
            # The first set of texture coordinates is used for colours.
            offsets.setdefault(each.get("semantic", ""), (offset, each.get("source", "")))
        if "VERTEX" not in offsets or stride > 64:
            raise ValueError(f"a COLLADA <{element.tag}> has no valid VERTEX input")
        for each in self._require(offsets["VERTEX"][1]).findall("input"):
            offsets.setdefault(
                each.get("semantic", ""), (offsets["VERTEX"][0], each.get("source", ""))
            )
        if "POSITION" not in offsets:
            raise ValueError(f"the vertices of a COLLADA <{element.tag}> have no POSITION input")
        counts, indices = _polygons(element, stride)
        if not len(counts):
            return None

        def table(semantic: str, width: int) -> tuple[Array, NDArray[np.int64]] | None:
            if semantic not in offsets:
                return None
            offset, source = offsets[semantic]
            return self._source(source, width), indices[:, offset]

        points = table("POSITION", 3)
        assert points is not None
        return _Primitive(
            material=element.get("material", ""),
            counts=counts,
            points=points,
            normals=table("NORMAL", 3),
            uv=table("TEXCOORD", 2),
        )

    def _source(self, url: str, width: int) -> Array:
        source = self._require(url)
        array = source.find("float_array")
        if array is None:
            raise ValueError(f'the COLLADA <source> "{url}" has no <float_array>')
        values = floats_of(array.text or "")
        accessor = source.find("technique_common/accessor")
        stride = int(accessor.get("stride", "1")) if accessor is not None else width
        start = int(accessor.get("offset", "0")) if accessor is not None else 0
        if not width <= stride <= 64 or start < 0:
            raise ValueError(
                f'the COLLADA <source> "{url}" has {stride} numbers per row, '
                f"but {width} are required"
            )
        # The accessor's count is ignored: some exporters write the number of values there.
        rows = (len(values) - start) // stride
        return values[start : start + max(rows, 0) * stride].reshape(-1, stride)[:, :width]


@dataclass(frozen=True, slots=True, eq=False)
class _Primitive:
    material: str
    counts: NDArray[np.int64]
    points: tuple[Array, NDArray[np.int64]]
    normals: tuple[Array, NDArray[np.int64]] | None
    uv: tuple[Array, NDArray[np.int64]] | None


def _polygons(element: ET.Element, stride: int) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """Corners of each polygon, and indices of shape (corners, stride)."""
    lists = [p for p in element.iter("p") if p.text and p.text.strip()]
    rows = [integers_of(p.text or "") for p in lists]
    for row in rows:
        if len(row) % stride:
            raise ValueError(f"the index list of a COLLADA <{element.tag}> is truncated")
    if not rows:
        return np.zeros(0, dtype=np.int64), np.zeros((0, stride), dtype=np.int64)
    if element.tag in ("tristrips", "trifans"):
        rows = [_strip(row.reshape(-1, stride), element.tag).reshape(-1) for row in rows]
    indices = np.concatenate(rows).reshape(-1, stride)
    if element.tag == "polygons":
        counts = np.array([len(row) // stride for row in rows], dtype=np.int64)
    elif element.tag == "polylist":
        vcount = element.find("vcount")
        counts = integers_of((vcount.text or "") if vcount is not None else "")
    else:
        if len(indices) % 3:
            raise ValueError(f"the index list of a COLLADA <{element.tag}> is truncated")
        counts = np.full(len(indices) // 3, 3, dtype=np.int64)
    return counts, indices


def _strip(row: NDArray[np.int64], kind: str) -> NDArray[np.int64]:
    """Converts a strip or fan to separate triangles."""
    i = np.arange(max(0, len(row) - 2))
    if kind == "trifans":
        return row[np.stack([np.zeros_like(i), i + 1, i + 2], axis=1)]
    odd = i % 2  # every second triangle of a strip is reversed
    return row[np.stack([i, i + 1 + odd, i + 2 - odd], axis=1)]


def _turned(submesh: Submesh) -> Submesh:
    """Reverses the faces, which a mirroring node turns inside out."""
    return replace(submesh, faces=np.ascontiguousarray(submesh.faces[:, ::-1]))


def _bindings(instance: ET.Element) -> dict[str, str]:
    found = instance.iterfind("bind_material/technique_common/instance_material")
    return {each.get("symbol", ""): each.get("target", "") for each in found}


def _floats(element: ET.Element, count: int) -> Array:
    values = floats_of(element.text or "")
    if len(values) != count or not np.isfinite(values).all():
        raise ValueError(f"a COLLADA <{element.tag}> must contain {count} finite numbers")
    return values


def _matrix(element: ET.Element) -> Array:
    return _floats(element, 16).reshape(4, 4)


def _rotation(values: Array) -> Array:
    """Converts COLLADA's axis and angle in degrees."""
    result = np.eye(4)
    length = float(np.linalg.norm(values[:3]))
    if length > 1e-12:
        x, y, z = (float(c) for c in values[:3] / length)
        angle = math.radians(float(values[3]))
        K = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
        result[:3, :3] += math.sin(angle) * K + (1 - math.cos(angle)) * (K @ K)
    return result
