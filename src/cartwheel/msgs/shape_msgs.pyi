"""Message types of shape_msgs. Written by `make catalogue`; do not edit."""

from dataclasses import dataclass
from typing import ClassVar

import numpy as np
from numpy.typing import ArrayLike

from cartwheel.msgs import _converted, geometry_msgs

@dataclass(init=False)
class Mesh:
    __msgtype__: ClassVar[str]
    triangles: _converted.List[MeshTriangle] = ...
    vertices: _converted.List[geometry_msgs.Point] = ...
    def __init__(
        self,
        triangles: list[MeshTriangle] | tuple[MeshTriangle, ...] = ...,
        vertices: list[geometry_msgs.Point] | tuple[geometry_msgs.Point, ...] = ...,
    ) -> None: ...

@dataclass(init=False)
class MeshTriangle:
    __msgtype__: ClassVar[str]
    vertex_indices: _converted.Array[np.uint32] = ...
    def __init__(
        self,
        vertex_indices: ArrayLike = ...,
    ) -> None: ...

@dataclass(init=False)
class Plane:
    __msgtype__: ClassVar[str]
    coef: _converted.Array[np.float64] = ...
    def __init__(
        self,
        coef: ArrayLike = ...,
    ) -> None: ...

@dataclass(init=False)
class SolidPrimitive:
    __msgtype__: ClassVar[str]
    BOX: ClassVar[int]
    SPHERE: ClassVar[int]
    CYLINDER: ClassVar[int]
    CONE: ClassVar[int]
    PRISM: ClassVar[int]
    BOX_X: ClassVar[int]
    BOX_Y: ClassVar[int]
    BOX_Z: ClassVar[int]
    SPHERE_RADIUS: ClassVar[int]
    CYLINDER_HEIGHT: ClassVar[int]
    CYLINDER_RADIUS: ClassVar[int]
    CONE_HEIGHT: ClassVar[int]
    CONE_RADIUS: ClassVar[int]
    PRISM_HEIGHT: ClassVar[int]
    type: int = ...
    dimensions: _converted.Array[np.float64] = ...
    polygon: geometry_msgs.Polygon = ...
    def __init__(
        self,
        type: int = ...,
        dimensions: ArrayLike = ...,
        polygon: geometry_msgs.Polygon = ...,
    ) -> None: ...
