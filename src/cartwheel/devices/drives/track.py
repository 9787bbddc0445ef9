"""A track or a conveyor belt, whose surface moves at a commanded velocity."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from cartwheel.component import Component, Scope
from cartwheel.devices.drives.limiter import NO_LIMITS, Limiter, Limits
from cartwheel.devices.periodic import Elapsed
from cartwheel.geometry import Array, Quat, Vec3, cross, cross_rows, matrix_from_quat
from cartwheel.messages import header, zero
from cartwheel.simulation.dynamics.moving_surface import SurfaceContacts

_SIDEWAYS = 1e-6
"""Length below which a projected direction does not exist."""
_PARALLEL = 0.99
"""Cosine of the angle between two axes from which on they count as parallel."""
_ONE_SIDE = 0.25
"""Square of the length of a mean normal above which contacts are on one side of a collision."""
_STILL = [0.0] * 6
"""The motion of a surface that does not move; see `SurfaceHandle.move`."""
Field = tuple[Array, Array]
"""Velocity of a surface at the origin of its collision, m/s, and angular velocity, rad/s, in the
world; each shape (3,)."""
_ODOMETRY = "nav_msgs/msg/Odometry"


@dataclass(frozen=True, kw_only=True, slots=True)
class TrackTopics:
    velocity: str
    """Topic of the velocity (Float64), m/s."""
    centre: str
    """Topic of the point about which the vehicle turns (Vector3), in the world, m. A point that is
    not finite means straight ahead."""
    odometry: str
    """Topic of the distance and the velocity of the track (Odometry)."""
    odometry_rate: float
    """Publish rate, Hz; 0: every step."""


@dataclass(frozen=True, kw_only=True, slots=True)
class TrackConfig:
    link: str
    """Link whose collisions are the track."""
    orientation: Quat
    """Axes of the track in the link: the track turns about y, and a vehicle moves along x."""
    topics: TrackTopics | None
    """Topics of the commands and of the odometry; None: the owner calls `Track.command`."""
    limits: Limits = NO_LIMITS
    """Limits on the velocity of the track."""
    projected: bool = False
    """Whether the velocity of a point in a turn is only the component of the track's velocity in
    the direction of the point's motion, as in Gazebo Classic."""
    timeout: float | None = None
    """Time after which a command expires, s; None: never."""


class Track(Component):
    """Moves the surface of a link's collisions, and publishes the distance that it moved.

    Where it touches another body, friction pulls both so that their surfaces move alike. Source:
    M. Pecka et al., Fast simulation of vehicles with non-deformable tracks, IROS 2017.

    Raises:
        UnknownNameError: The link does not exist.
    """

    def __init__(self, scope: Scope, config: TrackConfig) -> None:
        super().__init__(scope)
        part, origin = self.part, self.origin
        self._config = config
        self._link = part.link(config.link, origin=origin)
        self._surface = part.surface(config.link, origin=origin)
        self._axes = matrix_from_quat(config.orientation)
        self._limiter = Limiter(config.limits)
        self._clear()
        # The forward pass in between is that of the step, so it costs nothing. Its contacts result
        # in the motion during the next step: a pass must only depend on what was set before.
        part.schedule(0, before=self._apply, after=self._move)
        if config.topics is not None:
            self._listen(config.topics)

    def _listen(self, topics: TrackTopics) -> None:
        self.subscribe(topics.velocity, "std_msgs/msg/Float64", self._on_velocity)
        self.subscribe(topics.centre, "geometry_msgs/msg/Vector3", self._on_centre, unset=True)
        rate = topics.odometry_rate
        self._odometry = self.advertise(topics.odometry, _ODOMETRY, rate=rate or None)
        self.part.schedule(rate, after=self._publish, topics=self.publishers)

    def reset(self) -> None:
        super().reset()
        self._surface.stop()
        self._clear()

    def _clear(self) -> None:
        self._velocity = 0.0
        self._centre: Array | None = None
        self._received_ns = 0
        self._elapsed = Elapsed()
        self._limiter.reset()
        self._motions: list[list[float]] = []
        """The next motion of each collision's surface; see `SurfaceHandle.move`."""
        self._sides: dict[int, Array] = {}
        """For each collision that has touched a body while the track moved, the side of the last
        touch: the mean normal into the collision, in the axes of the track."""
        self.distance = 0.0
        """Distance that the track moved, m."""

    def command(self, velocity: float, centre: Vec3) -> None:
        """Moves the track.

        Args:
            velocity: Velocity, m/s.
            centre: Centre of the vehicle's turn in the world, m; infinite: straight ahead.
        """
        self._velocity = velocity
        self._turn_about(centre)

    def _turn_about(self, centre: Vec3) -> None:
        point = np.array(centre)
        self._centre = point if np.isfinite(point).all() else None
        self._received_ns = self.part.time_ns

    def _on_velocity(self, message: Any) -> None:
        self._velocity = float(message.data)
        self._received_ns = self.part.time_ns

    def _on_centre(self, message: Any) -> None:
        self._turn_about((float(message.x), float(message.y), float(message.z)))

    def _apply(self) -> None:
        if self._motions:
            self._surface.move(self._motions)

    def _move(self) -> None:
        seconds = self._elapsed.seconds(self.part.time_ns)
        if seconds <= 0:
            return
        wanted, timeout = self._velocity, self._config.timeout
        age = (self.part.time_ns - self._received_ns) * 1e-9
        if timeout is not None and age > timeout:
            wanted = 0.0
        velocity = float(self._limiter.step(wanted, seconds))
        if velocity == 0:
            self._motions = [_STILL] * self._surface.count
            return
        self.distance += velocity * seconds
        _, turned = self._link.place()
        axes = matrix_from_quat(turned) @ self._axes
        contacts = self._surface.contacts()
        moves = travel(
            velocity, contacts, axes[:, 1], self._centre, projected=self._config.projected
        )
        self._motions = []
        for number, (each, move) in enumerate(zip(contacts, moves, strict=True)):
            if len(each.normals):
                normal = each.normals.mean(axis=0)
                if normal @ normal > _ONE_SIDE:
                    self._sides[number] = axes.T @ normal
            likely = likely_field(velocity, each, axes, axes @ self._side(number))
            field = surface_field(each, -move, likely)
            self._motions.append(self._surface.local(number, *field))

    def _side(self, number: int) -> Array:
        """Normal into a collision where it probably touches a body next, in the track's axes.

        It is where it did last: a body that slides loses the contact for single steps. At first, it
        is the upper side of a belt that is fixed to the world, and the lower side of a vehicle.
        """
        known = self._sides.get(number)
        if known is not None:
            return known
        return np.array([0.0, 0.0, -1.0 if self._surface.fixed else 1.0])

    def _publish(self) -> None:
        message = zero(_ODOMETRY)
        message.header = header(self.part.time_ns, "")
        message.pose.pose.position.x = self.distance
        message.twist.twist.linear.x = float(self._limiter.value)
        self._odometry.publish(message)


def travel(
    velocity: float,
    contacts: Sequence[SurfaceContacts],
    axle: Array,
    centre: Array | None,
    *,
    projected: bool = False,
) -> list[Array]:
    """Returns how the vehicle should move at each contact of a track, in the world, m/s.

    Straight ahead, each point has the velocity of the track. In a turn, the points move on circles
    about the centre, with the yaw rate that results in the velocity of the track at its contacts in
    the mean. In gz-sim, each point has this velocity, so that the contacts of one track would
    resist each other.

    Args:
        velocity: Velocity of the track, m/s.
        contacts: The contacts of each collision.
        axle: Axis about which the track turns, a unit vector in the world, shape (3,).
        centre: Centre of the turn in the world, m; None: straight ahead.
        projected: See `TrackConfig.projected`.

    Returns:
        For each collision, shape (n, 3).
    """
    normals = np.concatenate([each.normals for each in contacts])
    positions = np.concatenate([each.positions for each in contacts])
    along = _unit(cross_rows(axle, normals))
    if centre is None:
        moves = velocity * along
    else:
        # Velocity per yaw rate.
        around = cross_rows(normals, positions - centre)
        squares = float((around * around).sum())
        components = (around * along).sum(axis=1, keepdims=True)
        same = np.sign(components)
        reach = abs(components).sum() if projected else np.linalg.norm(around, axis=1).sum()
        rate = abs(velocity) * reach / squares if squares > 0 else 0.0
        moves = rate * np.sign(velocity) * same * around
    ends = np.cumsum([len(each.positions) for each in contacts])
    return np.split(moves, ends[:-1])


def likely_field(velocity: float, contacts: SurfaceContacts, axes: Array, normal: Array) -> Field:
    """Returns the motion of the surface of a track's collision, wherever it will touch a body.

    Args:
        velocity: Velocity of the track, m/s.
        contacts: The collision.
        axes: Axes of the track in the world, shape (3, 3).
        normal: Normal into the collision on the side that probably touches a body, in the world,
            shape (3,).

    Returns:
        A rotation if the collision is round about the track's axle; otherwise, the motion of this
        side.
    """
    axle, axis = axes[:, 1], contacts.axis
    if contacts.radius > 0 and (not axis.any() or abs(float(axis @ axle)) > _PARALLEL):
        return np.zeros(3), velocity / contacts.radius * axle
    return -velocity * _unit(cross(axle, normal)[None])[0], np.zeros(3)


def surface_field(contacts: SurfaceContacts, wanted: Array, likely: Field) -> Field:
    """Returns the rigid motion of a surface that fits velocities at its contacts best.

    The components along the surfaces have the least squares. Of several solutions, the one nearest
    to a `likely` one is used.

    Args:
        contacts: The contacts.
        wanted: Velocity of the surface at each contact, m/s, shape (n, 3).
        likely: The motion without contacts.
    """
    if not len(wanted):
        return likely
    size = max(contacts.size, _SIDEWAYS)
    arms = (contacts.positions - contacts.centre) / size
    # Velocity per linear and per angular velocity, without the part along the normal.
    tangential = np.eye(3) - contacts.normals[:, :, None] * contacts.normals[:, None, :]
    crossed = np.zeros((len(arms), 3, 3))
    x, y, z = arms.T
    crossed[:, 0, 1], crossed[:, 0, 2] = z, -y
    crossed[:, 1, 0], crossed[:, 1, 2] = -z, x
    crossed[:, 2, 0], crossed[:, 2, 1] = y, -x
    matrix = np.concatenate([tangential, tangential @ crossed], axis=2).reshape(-1, 6)
    values = (tangential @ wanted[:, :, None]).ravel()
    start = np.concatenate([likely[0], likely[1] * size])
    solution = start + np.linalg.lstsq(matrix, values - matrix @ start, rcond=1e-6)[0]
    return solution[:3], solution[3:] / size


def _unit(vectors: Array) -> Array:
    """Normalized vectors, or zeros for those without a direction; shape (n, 3)."""
    lengths = np.linalg.norm(vectors, axis=1, keepdims=True)
    result: Array = np.where(lengths > _SIDEWAYS, vectors / np.maximum(lengths, _SIDEWAYS), 0.0)
    return result
