"""Poses and rotations. Only this module converts between quaternion orders.

Quaternions are ``(x, y, z, w)`` as in ROS. `to_wxyz` and `from_wxyz` convert to and from MuJoCo's
``(w, x, y, z)``. Roll, pitch and yaw are fixed-axis angles as in URDF and SDF: ``R = Rz(yaw)
Ry(pitch) Rx(roll)``. Units are metres and radians.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Sequence
from dataclasses import FrozenInstanceError, dataclass
from typing import Any, Never, TypeVar, overload

import numpy as np
from numpy.typing import NDArray

from cartwheel.codes.command import OPTION_INVALID
from cartwheel.errors import CartwheelError

Vec3 = tuple[float, float, float]
Quat = tuple[float, float, float, float]
"""``(x, y, z, w)``."""
Array = NDArray[np.float64]

T = TypeVar("T")

IDENTITY: Quat = (0.0, 0.0, 0.0, 1.0)
_SHORTEST, _LONGEST = 1.0 - 1e-6, 1.0 + 1e-6
"""Squared lengths between which a quaternion is a unit quaternion."""


def to_wxyz(q: Sequence[float]) -> Quat:
    """Converts ``(x, y, z, w)`` to the ``(w, x, y, z)`` of MuJoCo and viser."""
    return (float(q[3]), float(q[0]), float(q[1]), float(q[2]))


def from_wxyz(q: Sequence[float]) -> Quat:
    """Converts the ``(w, x, y, z)`` of MuJoCo and viser to ``(x, y, z, w)``."""
    return (float(q[1]), float(q[2]), float(q[3]), float(q[0]))


def quat_from_rpy(roll: float, pitch: float, yaw: float) -> Quat:
    """Rotation of fixed-axis roll, pitch, yaw in radians."""
    cr, sr = math.cos(roll / 2), math.sin(roll / 2)
    cp, sp = math.cos(pitch / 2), math.sin(pitch / 2)
    cy, sy = math.cos(yaw / 2), math.sin(yaw / 2)
    return (
        sr * cp * cy - cr * sp * sy,
        cr * sp * cy + sr * cp * sy,
        cr * cp * sy - sr * sp * cy,
        cr * cp * cy + sr * sp * sy,
    )


def rpy_from_quat(q: Sequence[float]) -> Vec3:
    """Fixed-axis roll, pitch and yaw in radians; pitch is within ±π/2."""
    x, y, z, w = q
    sin_pitch = max(-1.0, min(1.0, 2 * (w * y - z * x)))
    if abs(sin_pitch) > 1 - 1e-12:
        # Gimbal lock: roll and yaw rotate about the same axis, so roll is set to zero.
        yaw = math.atan2(-2 * (x * y - w * z), 1 - 2 * (x * x + z * z))
        return 0.0, math.copysign(math.pi / 2, sin_pitch), yaw
    return (
        math.atan2(2 * (w * x + y * z), 1 - 2 * (x * x + y * y)),
        math.asin(sin_pitch),
        math.atan2(2 * (w * z + x * y), 1 - 2 * (y * y + z * z)),
    )


def yaw_of(q: Sequence[float]) -> float:
    """Heading of a rotation about the world's z axis, rad."""
    x, y, z, w = q
    return math.atan2(2 * (w * z + x * y), 1 - 2 * (y * y + z * z))


def quat_multiply(a: Sequence[float], b: Sequence[float]) -> Quat:
    """The rotation `b` followed by `a`."""
    ax, ay, az, aw = a
    bx, by, bz, bw = b
    return (
        aw * bx + ax * bw + ay * bz - az * by,
        aw * by - ax * bz + ay * bw + az * bx,
        aw * bz + ax * by - ay * bx + az * bw,
        aw * bw - ax * bx - ay * by - az * bz,
    )


def quat_conjugate(q: Sequence[float]) -> Quat:
    """The inverse of a unit quaternion."""
    return (-q[0], -q[1], -q[2], q[3])


def quat_normalize(q: Sequence[float]) -> Quat:
    """Normalizes a quaternion; raises ValueError if its length is zero or not finite."""
    norm = math.sqrt(sum(c * c for c in q))
    if not math.isfinite(norm) or norm < 1e-12:
        raise ValueError("a quaternion of length zero is not a rotation")
    x, y, z, w = (float(c) / norm for c in q)
    return (x, y, z, w)


def rotate(q: Sequence[float], v: Sequence[float]) -> Vec3:
    """Rotates vector `v` by `q`."""
    x, y, z, w = q
    vx, vy, vz = v
    tx, ty, tz = 2 * (y * vz - z * vy), 2 * (z * vx - x * vz), 2 * (x * vy - y * vx)
    return (
        vx + w * tx + y * tz - z * ty,
        vy + w * ty + z * tx - x * tz,
        vz + w * tz + x * ty - y * tx,
    )


def cross(a: Iterable[float], b: Iterable[float]) -> Array:
    """Cross product of two vectors, shape (3,). `numpy.cross` has the same bits."""
    return np.array(cross_product((*map(float, a),), (*map(float, b),)))


def cross_product(a: Sequence[float], b: Sequence[float]) -> Vec3:
    """Cross product of two vectors without numpy, which takes ten times as long."""
    (ax, ay, az), (bx, by, bz) = a, b
    return (ay * bz - az * by, az * bx - ax * bz, ax * by - ay * bx)


def cross_rows(a: Array, b: Array) -> Array:
    """Cross products along the last axis, shape (…, 3); the shapes are broadcast.

    `numpy.cross` has the same bits, and takes several times as long for a few vectors.
    """
    ax, ay, az = a[..., 0], a[..., 1], a[..., 2]
    bx, by, bz = b[..., 0], b[..., 1], b[..., 2]
    x = ay * bz - az * by
    result = np.empty((*x.shape, 3), dtype=x.dtype)
    result[..., 0], result[..., 1], result[..., 2] = x, az * bx - ax * bz, ax * by - ay * bx
    return result


def quat_from_axis_angle(axis: Sequence[float], angle: float) -> Quat:
    """Rotation by `angle` radians about `axis`, which can have any nonzero length."""
    norm = math.sqrt(sum(c * c for c in axis))
    if norm < 1e-12:
        raise ValueError("an axis of length zero has no direction")
    s = math.sin(angle / 2) / norm
    return (axis[0] * s, axis[1] * s, axis[2] * s, math.cos(angle / 2))


def quat_from_matrix(matrix: Array) -> Quat:
    """Rotation of a 3x3 orthonormal matrix."""
    m = matrix
    trace = float(m[0, 0] + m[1, 1] + m[2, 2])
    if trace > 0:
        s = 2 * math.sqrt(trace + 1)
        q = ((m[2, 1] - m[1, 2]) / s, (m[0, 2] - m[2, 0]) / s, (m[1, 0] - m[0, 1]) / s, s / 4)
    else:
        i = int(np.argmax(np.diagonal(m)))
        j, k = (i + 1) % 3, (i + 2) % 3
        s = 2 * math.sqrt(max(0.0, 1 + m[i, i] - m[j, j] - m[k, k]))
        part = [0.0, 0.0, 0.0]
        part[i], part[j], part[k] = s / 4, (m[j, i] + m[i, j]) / s, (m[k, i] + m[i, k]) / s
        q = (part[0], part[1], part[2], (m[k, j] - m[j, k]) / s)
    return quat_normalize([float(c) for c in q])


def matrix_from_quat(q: Sequence[float]) -> Array:
    """3x3 rotation matrix."""
    x, y, z, w = q
    return np.array(
        [
            [1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
            [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
            [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)],
        ]
    )


def quat_between(source: Sequence[float], target: Sequence[float]) -> Quat:
    """The shortest rotation from direction `source` to direction `target`."""
    a = np.asarray(source, dtype=float)
    b = np.asarray(target, dtype=float)
    # Scale by the largest component first: squares of tiny or huge values under- or overflow.
    a, b = a / np.abs(a).max(), b / np.abs(b).max()
    a, b = a / np.linalg.norm(a), b / np.linalg.norm(b)
    w = 1 + float(a @ b)
    if w < 1e-9:
        helper = np.array([1.0, 0, 0]) if abs(a[0]) < 0.9 else np.array([0, 1.0, 0])
        return quat_from_axis_angle(cross(a, helper).tolist(), math.pi)
    x, y, z = cross(a, b)
    return quat_normalize((float(x), float(y), float(z), w))


_COUNTS = {3: "three", 4: "four"}


def _floats(values: Sequence[float], count: int, name: str) -> tuple[float, ...]:
    """The numbers of an argument.

    Raises:
        CartwheelError: There is another number of them, or one is not a number.
    """
    try:
        found = tuple(float(each) for each in values)
    except (TypeError, ValueError):
        found = ()
    if len(found) != count:
        shown = f"{values!r:.60}"
        raise CartwheelError(
            f"{name} must be {_COUNTS[count]} numbers (got {shown})",
            code=OPTION_INVALID,
            values={"name": name, "value": shown},
        )
    return found


def _as_unit(q: Quat) -> Quat:
    """A unit quaternion. One without a direction is refused where it is used, with its name."""
    x, y, z, w = _floats(q, 4, "orientation")
    try:
        return quat_normalize((x, y, z, w))
    except ValueError:
        return x, y, z, w


def _three(values: Sequence[float], name: str) -> Vec3:
    x, y, z = _floats(values, 3, name)
    return x, y, z


def immutable(instead: str) -> Callable[[type[T]], type[T]]:
    """A decorator for frozen dataclasses with slots, which states what to do instead.

    Without it, Python's own error is not understandable if the class has properties.

    Args:
        instead: What to do instead of setting an attribute, as a sentence.
    """

    def decorate(cls: type[T]) -> type[T]:
        def refuse(_: object, name: str, *_value: object) -> Never:
            raise FrozenInstanceError(
                f"{cls.__name__} is immutable: {name} cannot be set. {instead}"
            )

        cls.__setattr__ = refuse  # type: ignore[method-assign]
        cls.__delattr__ = refuse  # type: ignore[method-assign]
        return cls

    return decorate


@immutable("Assign a new pose: robot.pose = cartwheel.Pose((x, y, z)).")
@dataclass(frozen=True, slots=True)
class Pose:
    """The pose of a frame in another frame: position in metres, orientation ``(x, y, z, w)``.

    The orientation becomes a unit quaternion if it is none. One of length 0 is refused where the
    pose is used.

    Raises:
        CartwheelError: The position is not three numbers, or the orientation not four.
    """

    position: Vec3 = (0.0, 0.0, 0.0)
    orientation: Quat = IDENTITY

    def __post_init__(self) -> None:
        # Almost all poses are created by Cartwheel, and with tuples.
        if type(self.position) is not tuple or len(self.position) != 3:
            object.__setattr__(self, "position", _floats(self.position, 3, "position"))
        if type(self.orientation) is not tuple or len(self.orientation) != 4:
            object.__setattr__(self, "orientation", _floats(self.orientation, 4, "orientation"))
        x, y, z, w = self.orientation
        try:
            if _SHORTEST < x * x + y * y + z * z + w * w < _LONGEST:
                return
        except TypeError:
            pass
        object.__setattr__(self, "orientation", _as_unit(self.orientation))

    @classmethod
    def from_xyz_rpy(cls, xyz: Sequence[float], rpy: Sequence[float] = (0, 0, 0)) -> Pose:
        """A pose from the values of URDF's ``<origin xyz rpy>`` or SDF's ``<pose>``.

        Args:
            xyz: Position, m, shape (3,).
            rpy: Fixed-axis roll, pitch and yaw, rad, shape (3,).

        Raises:
            CartwheelError: One of them is not three numbers.
        """
        return cls(_three(xyz, "xyz"), quat_from_rpy(*_three(rpy, "rpy")))

    @property
    def x(self) -> float:
        """x coordinate, m."""
        return self.position[0]

    @property
    def y(self) -> float:
        """y coordinate, m."""
        return self.position[1]

    @property
    def z(self) -> float:
        """z coordinate, m."""
        return self.position[2]

    @property
    def rpy(self) -> Vec3:
        """Fixed-axis roll, pitch and yaw in radians."""
        return rpy_from_quat(self.orientation)

    @property
    def roll(self) -> float:
        """Rotation about the fixed x axis in radians, the first of `rpy`."""
        return self.rpy[0]

    @property
    def pitch(self) -> float:
        """Rotation about the fixed y axis in radians, within ±π/2."""
        return self.rpy[1]

    @property
    def yaw(self) -> float:
        """Heading in radians."""
        return yaw_of(self.orientation)

    def __matmul__(self, other: Pose) -> Pose:
        """Transforms `other` from this frame to the frame in which this pose is given."""
        dx, dy, dz = rotate(self.orientation, other.position)
        x, y, z = self.position
        return Pose((x + dx, y + dy, z + dz), quat_multiply(self.orientation, other.orientation))

    def inverse(self) -> Pose:
        """The pose of the outer frame in this frame."""
        q = quat_conjugate(self.orientation)
        x, y, z = rotate(q, self.position)
        return Pose((-x, -y, -z), q)

    @overload
    def apply(self, point: NDArray[Any]) -> Array: ...

    @overload
    def apply(self, point: Sequence[float]) -> Vec3: ...

    def apply(self, point: Sequence[float] | NDArray[Any]) -> Vec3 | Array:
        """Transforms a point, or an array of points, from this frame to the outer frame.

        Args:
            point: m, shape (3,), or an array of shape (…, 3), such as that of `cartwheel.cloud`.

        Raises:
            CartwheelError: It does not have this shape.
        """
        if isinstance(point, np.ndarray):
            if point.shape[-1:] != (3,):
                raise CartwheelError(
                    f"points must have the shape (…, 3) (got {point.shape})",
                    code=OPTION_INVALID,
                    values={"name": "point", "value": str(point.shape)},
                )
            placed: Array = point @ matrix_from_quat(self.orientation).T + np.array(self.position)
            return placed
        if type(point) is not tuple or len(point) != 3:
            point = _three(point, "point")
        dx, dy, dz = rotate(self.orientation, point)
        return (self.position[0] + dx, self.position[1] + dy, self.position[2] + dz)


def interpolated(start: Pose, end: Pose, share: float) -> Pose:
    """The pose between two poses: linear in position, spherical in orientation (slerp).

    Args:
        start: The pose at `share` 0.
        end: The pose at `share` 1.
        share: From 0 to 1.
    """
    x, y, z = (a + (b - a) * share for a, b in zip(start.position, end.position, strict=True))
    one, two = start.orientation, end.orientation
    cosine = sum(a * b for a, b in zip(one, two, strict=True))
    # Both signs of a quaternion are the same rotation; the shorter way is used.
    sign, cosine = (-1.0, -cosine) if cosine < 0 else (1.0, cosine)
    before, after = 1 - share, share
    if cosine < 1 - 1e-12:
        angle = math.acos(cosine)
        before, after = (math.sin(each * angle) / math.sin(angle) for each in (before, after))
    turned = [before * a + sign * after * b for a, b in zip(one, two, strict=True)]
    return Pose((x, y, z), quat_normalize(turned))
