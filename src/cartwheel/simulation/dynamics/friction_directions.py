"""Rotates contact frames so that both friction coefficients apply in the right direction.

MuJoCo aligns the first tangent of a contact with the world's y axis. Its collision functions are in
a public, writable table indexed by the two shape types. This module wraps the relevant entries to
set the first tangent. The table is shared by the whole process, so each wrapper looks up the model
of the contact. A wrapper takes ten times as long as most collision functions, so the engine's own
returns to the table when no model needs the wrapper any more. The rotations of the bodies come from
the data that the engine passes, so directions also apply to copies of the data.
"""

from __future__ import annotations

import ctypes
import math
import mmap
import threading
import weakref
from collections import Counter
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import mujoco
import numpy as np

from cartwheel.codes import world as world_codes
from cartwheel.errors import SimulationError
from cartwheel.world.pairs import Alignment

_TYPES = int(mujoco.mjtGeom.mjGEOM_SDF) + 1
"""Number of colliding shape types: rows and columns of the table."""
_NUMBERS = 10
"""Values per contact: distance, position, normal, first tangent."""
_Found = ctypes.c_double * _NUMBERS
_Rotation = ctypes.c_double * 9
_Collide = ctypes.CFUNCTYPE(
    ctypes.c_int,
    ctypes.c_void_p,
    ctypes.c_void_p,
    ctypes.c_void_p,
    ctypes.c_int,
    ctypes.c_int,
    ctypes.c_double,
)
_SEARCHED = 1 << 20
"""Bytes of the engine's data in which a pointer is searched."""
_ALONG_NORMAL = 1e-3
"""Minimum component of a direction perpendicular to the normal."""
_STEEP = math.sqrt(0.5)
_CHECK = """<mujoco><worldbody><geom type="plane" size="1 1 1"/>
<body pos="0 0 0.09"><freejoint/><geom type="capsule" size="0.1 0.2" zaxis="1 2 0"/></body>
</worldbody></mujoco>"""


class Directions:
    """Friction directions of one model and all its data, active while this object exists.

    Args:
        model: The MuJoCo model.
        alignments: Pairs with direction-dependent coefficients; usually empty.

    Raises:
        SimulationError: The engine's contact layout is not supported.
    """

    def __init__(self, model: Any, alignments: Sequence[Alignment]) -> None:
        self.active = bool(alignments)
        if not alignments:
            return
        self._rules: dict[tuple[int, int], tuple[int, float, float, float, bool]] = {}
        kinds = set()
        for each in alignments:
            geoms = model.geom(each.first).id, model.geom(each.second).id
            body = model.body(each.body).id if each.body is not None else -1
            rule = (body, *each.direction, each.across)
            self._rules[geoms] = self._rules[geoms[::-1]] = rule
            first, second = sorted(int(model.geom_type[geom]) for geom in geoms)
            kinds.add((first, second))
        _TABLE.serve(model, self, kinds)

    def tangent(
        self, first: int, second: int, normal: Sequence[float], rotations: int
    ) -> list[float] | None:
        """The tangent along which the first friction coefficient of a contact applies.

        Args:
            first: Geom index.
            second: Geom index.
            normal: Unit vector in world axes.
            rotations: Address of the rotation matrices of all bodies, row by row.

        Returns:
            None if this pair has no alignment, or if the direction is parallel to the normal.
        """
        rule = self._rules.get((first, second))
        if rule is None:
            return None
        body, x, y, z, across = rule
        a, b, c = normal
        if body < 0:
            # the choice that ODE makes
            x, y, z = (0.0, -c, b) if abs(c) > _STEEP else (-b, a, 0.0)
        else:
            r = _Rotation.from_address(rotations + body * ctypes.sizeof(_Rotation))
            x, y, z = (
                r[0] * x + r[1] * y + r[2] * z,
                r[3] * x + r[4] * y + r[5] * z,
                r[6] * x + r[7] * y + r[8] * z,
            )
        length = math.sqrt(x * x + y * y + z * z)
        along = a * x + b * y + c * z
        x, y, z = x - along * a, y - along * b, z - along * c
        if math.sqrt(x * x + y * y + z * z) < _ALONG_NORMAL * length:
            return None
        return [b * z - c * y, c * x - a * z, a * y - b * x] if across else [x, y, z]


class _Table:
    """The engine's table of collision functions."""

    def __init__(self) -> None:
        # The garbage collector may end directions while others begin.
        self._lock = threading.RLock()
        self._served: weakref.WeakValueDictionary[int, Directions] = weakref.WeakValueDictionary()
        self._functions: dict[tuple[int, int], Any] = {}
        """References to our functions; the engine stores only addresses."""
        self._own: dict[tuple[int, int], int] = {}
        """The addresses of the engine's functions that were replaced."""
        self._users: Counter[tuple[int, int]] = Counter()
        """Number of directions that need our function."""
        self._entries: Any = None
        self._rotations = 0
        """Where a pointer to the bodies' rotations is in the engine's data, bytes."""

    def serve(self, model: Any, directions: Directions, kinds: set[tuple[int, int]]) -> None:
        """Registers a model's directions for contacts of these shape types."""
        with self._lock:
            if self._entries is None:
                self._entries = _entries()
                self._rotations = _rotations_offset()
            self._served[model._address] = directions
            self._users.update(kinds)
            weakref.finalize(directions, self._end, frozenset(kinds)).atexit = False
            for kind in sorted(kinds):
                index = kind[0] * _TYPES + kind[1]
                if kind not in self._functions:
                    self._own[kind] = self._entries[index]
                    self._functions[kind] = self._around(_Collide(self._own[kind]))
                self._entries[index] = ctypes.cast(self._functions[kind], ctypes.c_void_p).value

    def _end(self, kinds: frozenset[tuple[int, int]]) -> None:
        with self._lock:
            self._users.subtract(kinds)
            for kind in kinds:
                if not self._users[kind] and kind in self._own:
                    self._entries[kind[0] * _TYPES + kind[1]] = self._own[kind]

    def _around(self, find: Any) -> Any:
        served, offset = self._served, self._rotations

        def collide(model: int, data: int, found: int, *rest: Any) -> int:
            count: int = find(model, data, found, *rest)
            directions = served.get(model) if count else None
            if directions is not None:
                rotations: int = ctypes.c_size_t.from_address(data + offset).value
                size = _NUMBERS * ctypes.sizeof(ctypes.c_double)
                for number in range(count):
                    numbers: Any = _Found.from_address(found + number * size)
                    tangent = directions.tangent(rest[0], rest[1], numbers[4:7], rotations)
                    if tangent is not None:
                        numbers[7:10] = tangent
            return count

        return _Collide(collide)


def _entries() -> Any:
    """The engine's table, after a test that its entries work as expected.

    Raises:
        SimulationError: The table's layout is unexpected.
    """
    library = ctypes.CDLL(str(_library()))
    entries = (ctypes.c_void_p * (_TYPES * _TYPES)).in_dll(library, "mjCOLLISIONFUNC")
    model = mujoco.MjModel.from_xml_string(_CHECK)
    data = mujoco.MjData(model)
    mujoco.mj_kinematics(model, data)
    kinds = [int(kind) for kind in model.geom_type]
    # Reference case: two contacts, one at each end of a capsule, with tangents along its axis.
    buffer = (ctypes.c_double * (_NUMBERS * 8))()
    find = _Collide(entries[kinds[0] * _TYPES + kinds[1]] or 0)
    count = find(model._address, data._address, ctypes.addressof(buffer), 0, 1, 0.0)
    axis = data.geom_xmat[1].reshape(3, 3)[:, 2]
    for number in range(2):
        numbers = list(buffer[number * _NUMBERS : (number + 1) * _NUMBERS])
        expected = [0.09 - 0.1, 0.0, 0.0, 1.0, *axis]
        if count != 2 or not all(
            math.isclose(a, b, abs_tol=1e-9)
            for a, b in zip([numbers[0], *numbers[4:]], expected, strict=True)
        ):
            raise _unsupported()
    return entries


def _rotations_offset() -> int:
    """Returns where a pointer to the bodies' rotations is in the engine's data, bytes.

    The pointer is a field of ``mjData``, so a search that stops at the first match stays within it.

    Raises:
        SimulationError: The data's layout is unexpected.
    """
    model = mujoco.MjModel.from_xml_string(_CHECK)
    offsets = {_offset_of(data, data.xmat.ctypes.data) for data in map(mujoco.MjData, [model] * 2)}
    if len(offsets) != 1 or None in offsets:
        raise _unsupported()
    return offsets.pop() or 0


def _offset_of(data: Any, pointer: int) -> int | None:
    start, size = data._address, ctypes.sizeof(ctypes.c_size_t)
    address = start
    while address < start + _SEARCHED:
        # To the end of the page, which is readable if its beginning is.
        count = (mmap.PAGESIZE - address % mmap.PAGESIZE) // size
        words = np.ctypeslib.as_array((ctypes.c_size_t * count).from_address(address))
        places = np.flatnonzero(words == pointer)
        if len(places):
            return int(address - start + places[0] * size)
        address += count * size
    return None


def _unsupported() -> SimulationError:
    return SimulationError(
        f"MuJoCo {mujoco.__version__} computes contacts in a way that this version of "
        "Cartwheel does not support, so anisotropic friction (mu1 ≠ mu2) is not available",
        code=world_codes.FRICTION_DIRECTION_UNSUPPORTED,
        hint="Install an older MuJoCo, or set mu1 and mu2 to the same value.",
    )


def _library() -> Path:
    """The engine's library, which is already loaded."""
    folder = Path(mujoco.__file__).parent
    found = sorted(
        path
        for pattern in ("libmujoco*.so*", "libmujoco*.dylib", "mujoco.dll")
        for path in folder.glob(pattern)
    )
    if not found:
        raise SimulationError(
            f"MuJoCo's library is not in {folder}, so anisotropic friction (mu1 ≠ mu2) is not "
            "available",
            code=world_codes.FRICTION_DIRECTION_UNSUPPORTED,
            hint="Reinstall MuJoCo.",
        )
    return found[0]


_TABLE = _Table()
