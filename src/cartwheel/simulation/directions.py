"""Turns the frames of contacts, so that friction's two coefficients count where they should.

The engine lays the first tangent of a contact along the world's y axis, whatever touches. Its
functions that find contacts stand in a table by the types of the two shapes, which is there to be
written to: around those that matter a function is put here that says where the first tangent is.
The table is the process's, so each function looks up whose contact it is.
"""

from __future__ import annotations

import ctypes
import math
import threading
import weakref
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import mujoco

from cartwheel.codes import world as world_codes
from cartwheel.errors import SimulationError
from cartwheel.world.pairs import Alignment

_TYPES = int(mujoco.mjtGeom.mjGEOM_SDF) + 1
"""Types of shapes that collide: rows and columns of the table."""
_NUMBERS = 10
"""Of a contact as it is found: distance, position, normal, first tangent."""
_Found = ctypes.c_double * _NUMBERS
_Collide = ctypes.CFUNCTYPE(
    ctypes.c_int,
    ctypes.c_void_p,
    ctypes.c_void_p,
    ctypes.c_void_p,
    ctypes.c_int,
    ctypes.c_int,
    ctypes.c_double,
)
_ALONG_NORMAL = 1e-3
"""Of a direction: less than that across the normal says nothing."""
_STEEP = math.sqrt(0.5)
_CHECK = """<mujoco><worldbody><geom type="plane" size="1 1 1"/>
<body pos="0 0 0.09"><freejoint/><geom type="capsule" size="0.1 0.2" zaxis="1 2 0"/></body>
</worldbody></mujoco>"""


class Directions:
    """Where friction counts of one model and its data, for as long as it is kept.

    Args:
        model: MuJoCo's.
        data: MuJoCo's.
        alignments: The pairs whose coefficients differ by direction; mostly none.

    Raises:
        SimulationError: The engine's contacts are not those that this is written for.
    """

    def __init__(self, model: Any, data: Any, alignments: Sequence[Alignment]) -> None:
        if not alignments:
            return
        self._turns = data.xmat
        self._rules: dict[tuple[int, int], tuple[int, float, float, float, bool]] = {}
        kinds = set()
        for each in alignments:
            geoms = model.geom(each.first).id, model.geom(each.second).id
            body = model.body(each.body).id if each.body is not None else -1
            rule = (body, *each.direction, each.across)
            self._rules[geoms] = self._rules[geoms[::-1]] = rule
            first, second = sorted(int(model.geom_type[geom]) for geom in geoms)
            kinds.add((first, second))
        _TABLE.serve(data, self, kinds)

    def tangent(self, first: int, second: int, normal: Sequence[float]) -> list[float] | None:
        """Along which the first coefficient of a contact counts, across its normal.

        Args:
            first: Geom.
            second: Geom.
            normal: Unit vector, in the world.

        Returns:
            None where these two have no rule, or where the direction is along the normal.
        """
        rule = self._rules.get((first, second))
        if rule is None:
            return None
        body, x, y, z, across = rule
        a, b, c = normal
        if body < 0:
            # ODE's own choice.
            x, y, z = (0.0, -c, b) if abs(c) > _STEEP else (-b, a, 0.0)
        else:
            r = self._turns[body].tolist()
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
    """The engine's table of functions that find contacts."""

    def __init__(self) -> None:
        self._lock = threading.Lock()
        self._served: weakref.WeakValueDictionary[int, Directions] = weakref.WeakValueDictionary()
        self._functions: dict[tuple[int, int], Any] = {}
        """Ours; the engine keeps but an address."""
        self._entries: Any = None

    def serve(self, data: Any, directions: Directions, kinds: set[tuple[int, int]]) -> None:
        """Asks a model's directions from now on, at contacts of these types of shapes."""
        with self._lock:
            if self._entries is None:
                self._entries = _entries()
            self._served[data._address] = directions
            for first, second in sorted(kinds - set(self._functions)):
                index = first * _TYPES + second
                function = self._around(_Collide(self._entries[index]))
                self._functions[first, second] = function
                self._entries[index] = ctypes.cast(function, ctypes.c_void_p).value

    def _around(self, find: Any) -> Any:
        served = self._served

        def collide(model: int, data: int, found: int, *rest: Any) -> int:
            count: int = find(model, data, found, *rest)
            directions = served.get(data) if count else None
            if directions is not None:
                size = _NUMBERS * ctypes.sizeof(ctypes.c_double)
                for number in range(count):
                    numbers: Any = _Found.from_address(found + number * size)
                    tangent = directions.tangent(rest[0], rest[1], numbers[4:7])
                    if tangent is not None:
                        numbers[7:10] = tangent
            return count

        return _Collide(collide)


def _entries() -> Any:
    """The engine's table, after a look at whether what stands in it does what is expected.

    Raises:
        SimulationError: It does not.
    """
    library = ctypes.CDLL(str(_library()))
    entries = (ctypes.c_void_p * (_TYPES * _TYPES)).in_dll(library, "mjCOLLISIONFUNC")
    model = mujoco.MjModel.from_xml_string(_CHECK)
    data = mujoco.MjData(model)
    mujoco.mj_kinematics(model, data)
    kinds = [int(kind) for kind in model.geom_type]
    # The engine itself lays the tangent along a capsule's axis: two contacts, one at each end.
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
            raise SimulationError(
                f"MuJoCo {mujoco.__version__} computes contacts in a way that this version of "
                "Cartwheel does not support, so friction cannot differ by direction",
                code=world_codes.FRICTION_DIRECTION_UNSUPPORTED,
                hint="Install an older MuJoCo, or give mu1 and mu2 the same value.",
            )
    return entries


def _library() -> Path:
    """The engine's library, which is loaded already."""
    folder = Path(mujoco.__file__).parent
    found = sorted(
        path
        for pattern in ("libmujoco*.so*", "libmujoco*.dylib", "mujoco.dll")
        for path in folder.glob(pattern)
    )
    if not found:
        raise SimulationError(
            f"MuJoCo's library is not in {folder}, so friction cannot differ by direction",
            code=world_codes.FRICTION_DIRECTION_UNSUPPORTED,
            hint="Install MuJoCo again.",
        )
    return found[0]


_TABLE = _Table()
