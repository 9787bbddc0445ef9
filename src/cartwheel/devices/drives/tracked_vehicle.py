"""A vehicle on tracks, which commands their velocities and estimates its own motion."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np

from cartwheel.component import Scope
from cartwheel.devices.drives.drive import Drive, DriveConfig
from cartwheel.devices.drives.kinematics import axle_motion
from cartwheel.devices.drives.limiter import Limiter, Limits
from cartwheel.devices.drives.reckoning import DeadReckoning, Motion
from cartwheel.devices.drives.track import Track, TrackConfig
from cartwheel.devices.elementwise import clamp
from cartwheel.geometry import Vec3, rotate
from cartwheel.messages import message_class

_FLOAT = "std_msgs/msg/Float64"
_VECTOR = "geometry_msgs/msg/Vector3"
_LEAST_EFFICIENCY = 1e-3


class CommandTopics(NamedTuple):
    """Topics of a track that another plugin moves; see `TrackTopics`."""

    velocity: str
    centre: str


@dataclass(frozen=True, kw_only=True, slots=True)
class TrackedVehicleConfig:
    body: str
    """Link about whose origin the vehicle turns in place."""
    left: tuple[CommandTopics | TrackConfig, ...]
    right: tuple[CommandTopics | TrackConfig, ...]
    separation: float
    """Distance between the left and the right tracks, m."""
    efficiency: float
    """Initial steering efficiency; see `track_speeds`."""
    efficiency_topic: str | None
    """Topic of the steering efficiency (Float64); None: it is constant."""
    least: float = 1e-6
    """Velocity in m/s or rad/s below which there is none."""
    most: float = math.inf
    """Maximum speed of the tracks, m/s."""
    linear: Limits
    """Limits on the forward speed."""
    angular: Limits
    """Limits on the yaw rate."""
    drive: DriveConfig
    """Topics and rates."""


class TrackSpeeds(NamedTuple):
    """Velocities of the tracks of a vehicle, and the centre of its turn."""

    left: float
    """m/s."""
    right: float
    """m/s."""
    radius: float
    """Distance of the centre of the turn to the left of the vehicle, m; infinite straight ahead."""


def track_speeds(
    forward: float,
    turn: float,
    separation: float,
    efficiency: float,
    *,
    least: float = 1e-6,
    most: float = math.inf,
) -> TrackSpeeds:
    """Returns what the tracks do for a velocity and a yaw rate. Source: TrackedVehicle of gz-sim.

    Args:
        forward: Velocity, m/s.
        turn: Yaw rate, rad/s.
        separation: Distance between the left and the right tracks, m.
        efficiency: Yaw rate as a fraction of that of wheels that do not slip.
        least: Velocity in m/s or rad/s below which there is none.
        most: Maximum speed of the tracks, m/s.
    """
    half = turn * separation / (2 * efficiency)
    left, right = forward - half, forward + half
    if max(abs(left), abs(right)) > most:
        left, right = clamp(left, -most, most), clamp(right, -most, most)
        forward, turn = (left + right) / 2, (right - left) * efficiency / separation
    radius = math.inf
    if abs(turn) >= least:
        radius = 0.0 if abs(forward) < least else forward / turn
    return TrackSpeeds(left, right, radius)


class TrackedVehicle(Drive):
    """Commands the tracks of a vehicle from Twist commands, and publishes odometry.

    As in gz-sim, the tracks of other plugins are commanded only if the command changes, with the
    centre of the turn at that time. The odometry is that of a differential drive whose rims move
    like the tracks.

    Raises:
        UnknownNameError: A link does not exist.
    """

    def __init__(self, scope: Scope, config: TrackedVehicleConfig) -> None:
        super().__init__(scope)
        self._config = config
        self._body = self.part.link(config.body, origin=self.origin)
        self._linear, self._angular = Limiter(config.linear), Limiter(config.angular)
        self._reckoning = DeadReckoning()
        sides = (config.left, config.right)
        self._owns = any(isinstance(track, TrackConfig) for side in sides for track in side)
        self._tracks = [[self._mover(track) for track in side] for side in sides]
        if config.efficiency_topic is not None:
            self.subscribe(config.efficiency_topic, _FLOAT, self._on_efficiency)
        self.run(config.drive)

    def _mover(self, track: CommandTopics | TrackConfig) -> Callable[[float, Vec3], None]:
        """Returns the function that moves a track with a velocity about a centre."""
        if isinstance(track, TrackConfig):
            return self.add(Track(self.scope, track)).command
        Float64, Vector3 = message_class(_FLOAT), message_class(_VECTOR)
        velocities = self.advertise(track.velocity, _FLOAT)
        centres = self.advertise(track.centre, _VECTOR)

        def move(velocity: float, centre: Vec3) -> None:
            velocities.publish(Float64(data=velocity))
            centres.publish(Vector3(*centre))

        return move

    def reset(self) -> None:
        super().reset()
        self._command = (0.0, 0.0)
        self._is_new = False
        self._efficiency = self._config.efficiency
        self._linear.reset()
        self._angular.reset()
        self._speeds = TrackSpeeds(0.0, 0.0, math.inf)
        self._reckoning.restart()

    def command(self, forward: float, sideways: float, turn: float) -> None:  # noqa: ARG002
        self._command = (forward, turn)
        self._is_new = True

    def _on_efficiency(self, message: Any) -> None:
        if message.data >= _LEAST_EFFICIENCY:
            self._efficiency = float(message.data)
            self._is_new = True

    def update(self, seconds: float) -> None:
        config, before = self._config, (self._linear.value, self._angular.value)
        forward = float(self._linear.step(self._command[0], seconds))
        turn = float(self._angular.step(self._command[1], seconds))
        is_new = self._is_new or (forward, turn) != before
        if is_new:
            self._is_new = False
            self._speeds = track_speeds(
                forward,
                turn,
                config.separation,
                self._efficiency,
                least=config.least,
                most=config.most,
            )
        if is_new or self._owns:
            self._send()
        left, right, _ = self._speeds
        distance, angle = axle_motion(left * seconds, right * seconds, config.separation)
        self._reckoning.go(float(distance), float(angle), seconds)

    def _send(self) -> None:
        speeds = self._speeds
        centre = self._centre(speeds.radius)
        for moves, speed in zip(self._tracks, (speeds.left, speeds.right), strict=True):
            for move in moves:
                move(speed, centre)

    def _centre(self, radius: float) -> Vec3:
        """The centre of the turn in the world, m; infinite straight ahead."""
        if not math.isfinite(radius):
            return math.inf, math.inf, math.inf
        self.part.locate()
        place, turned = self._body.place()
        x, y, z = (np.array(place) + radius * np.array(rotate(turned, (0.0, 1.0, 0.0)))).tolist()
        return x, y, z

    @property
    def sides(self) -> tuple[float, float]:
        """Commanded speeds of the left and right tracks, m/s."""
        return self._speeds.left, self._speeds.right

    def motion(self) -> Motion:
        return self._reckoning.motion()
