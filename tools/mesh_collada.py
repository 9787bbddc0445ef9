"""Writes solids with one material each to a COLLADA file for Gazebo, RViz and Cartwheel.

Units are metres, z is up. The same solids give the same bytes.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from mesh_solids import Solid, joined

# Edges with a larger angle between their faces have sharp shading.
SMOOTH_ANGLE = math.radians(40)


@dataclass(frozen=True)
class Material:
    """A named colour, in COLLADA's Lambert model with a highlight."""

    name: str
    diffuse: tuple[float, float, float]
    specular: float = 0.1
    shininess: float = 20.0


@dataclass
class Mesh:
    """Solids with one material each, written to one COLLADA file."""

    path: str
    parts: list[tuple[Material, Solid]] = field(default_factory=list)

    def add(self, material: Material, *solids: Solid) -> None:
        self.parts += [(material, solid) for solid in solids]

    def by_material(self) -> list[tuple[Material, Solid]]:
        materials: dict[Material, list[Solid]] = {}
        for material, solid in self.parts:
            materials.setdefault(material, []).append(solid)
        return [(material, joined(solids)) for material, solids in materials.items()]

    def triangles(self) -> int:
        return sum(len(solid.faces) for _, solid in self.parts)

    def write(self, root: Path) -> None:
        target = root / self.path
        target.parent.mkdir(parents=True, exist_ok=True)
        target.write_text(collada(self.by_material()), encoding="utf-8", newline="\n")


def corner_normals(solid: Solid) -> np.ndarray:
    """One normal per corner (m, 3, 3): the area-weighted mean of the faces around its vertex that
    meet its own face at less than SMOOTH_ANGLE.
    """
    corners = solid.vertices[solid.faces]
    area = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    unit = area / np.linalg.norm(area, axis=1)[:, None]
    around: dict[tuple[float, ...], list[int]] = {}
    keys = [[tuple(np.round(p, 6) + 0.0) for p in face] for face in corners]
    for index, face in enumerate(keys):
        for key in face:
            around.setdefault(key, []).append(index)
    normals: np.ndarray = np.zeros(corners.shape)
    limit = math.cos(SMOOTH_ANGLE)
    for index, face in enumerate(keys):
        for k, key in enumerate(face):
            near = [other for other in around[key] if unit[other] @ unit[index] > limit]
            total = area[near].sum(axis=0)
            normals[index, k] = total / np.linalg.norm(total)
    return normals


def numbers(values: np.ndarray, digits: int) -> str:
    """Numbers as short text. Rounding also removes differences between processors."""
    rounded = np.round(values, digits) + 0.0
    return " ".join(f"{value:.{digits}f}".rstrip("0").rstrip(".") for value in rounded.ravel())


def source(identifier: str, values: np.ndarray, digits: int) -> str:
    text = numbers(values, digits)
    return f"""\
        <source id="{identifier}">
          <float_array id="{identifier}-array" count="{values.size}">{text}</float_array>
          <technique_common>
            <accessor source="#{identifier}-array" count="{len(values)}" stride="3">
              <param name="X" type="float"/>
              <param name="Y" type="float"/>
              <param name="Z" type="float"/>
            </accessor>
          </technique_common>
        </source>
"""


def effect(material: Material) -> str:
    red, green, blue = (f"{value:g}" for value in material.diffuse)
    shine = f"{material.specular:g}"
    return f"""\
    <effect id="{material.name}-effect">
      <profile_COMMON>
        <technique sid="common">
          <phong>
            <emission><color>0 0 0 1</color></emission>
            <ambient><color>{red} {green} {blue} 1</color></ambient>
            <diffuse><color>{red} {green} {blue} 1</color></diffuse>
            <specular><color>{shine} {shine} {shine} 1</color></specular>
            <shininess><float>{material.shininess:g}</float></shininess>
          </phong>
        </technique>
      </profile_COMMON>
    </effect>
"""


def geometry(material: Material, solid: Solid) -> str:
    name = material.name
    points, point_index = np.unique(
        np.round(solid.vertices[solid.faces].reshape(-1, 3), 6) + 0.0, axis=0, return_inverse=True
    )
    normals, normal_index = np.unique(
        np.round(corner_normals(solid).reshape(-1, 3), 4) + 0.0, axis=0, return_inverse=True
    )
    index = np.column_stack([point_index.ravel(), normal_index.ravel()]).ravel()
    return f"""\
    <geometry id="{name}-mesh" name="{name}">
      <mesh>
{source(f"{name}-positions", points, 6)}{source(f"{name}-normals", normals, 4)}\
        <vertices id="{name}-vertices">
          <input semantic="POSITION" source="#{name}-positions"/>
        </vertices>
        <triangles material="{name}" count="{len(solid.faces)}">
          <input semantic="VERTEX" source="#{name}-vertices" offset="0"/>
          <input semantic="NORMAL" source="#{name}-normals" offset="1"/>
          <p>{" ".join(map(str, index))}</p>
        </triangles>
      </mesh>
    </geometry>
"""


def node(material: Material) -> str:
    name = material.name
    return f"""\
      <node id="{name}-node" name="{name}">
        <instance_geometry url="#{name}-mesh">
          <bind_material>
            <technique_common>
              <instance_material symbol="{name}" target="#{name}-material"/>
            </technique_common>
          </bind_material>
        </instance_geometry>
      </node>
"""


def collada(parts: Sequence[tuple[Material, Solid]]) -> str:
    # The format requires a date; with a fixed one, two runs give identical files.
    materials = [material for material, _ in parts]
    library = "".join(
        f'    <material id="{m.name}-material" name="{m.name}">'
        f'<instance_effect url="#{m.name}-effect"/></material>\n'
        for m in materials
    )
    return f"""\
<?xml version="1.0" encoding="utf-8"?>
<COLLADA xmlns="http://www.collada.org/2005/11/COLLADASchema" version="1.4.1">
  <asset>
    <contributor><authoring_tool>tools/make_meshes.py</authoring_tool></contributor>
    <created>2000-01-01T00:00:00</created>
    <modified>2000-01-01T00:00:00</modified>
    <unit name="meter" meter="1"/>
    <up_axis>Z_UP</up_axis>
  </asset>
  <library_effects>
{"".join(map(effect, materials))}  </library_effects>
  <library_materials>
{library}  </library_materials>
  <library_geometries>
{"".join(geometry(m, solid) for m, solid in parts)}  </library_geometries>
  <library_visual_scenes>
    <visual_scene id="scene" name="scene">
{"".join(map(node, materials))}    </visual_scene>
  </library_visual_scenes>
  <scene>
    <instance_visual_scene url="#scene"/>
  </scene>
</COLLADA>
"""
