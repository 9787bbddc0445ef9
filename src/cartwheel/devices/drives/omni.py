"""Omnidirectional drives with three or more omni wheels on a circle around the robot's centre."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

from cartwheel.devices.drives.commanded_joint import CommandedJoint
from cartwheel.devices.drives.reckoning import DeadReckoning
from cartwheel.devices.elementwise import Number
from cartwheel.geometry import Vec3
from cartwheel.simulation.dynamics.external_servos import BodyDriveHandle


def wheel_places(count: int, offset: float) -> tuple[float, ...]:
    """Returns the direction of each wheel from the centre, as an angle to the x axis in rad.

    Args:
        count: Number of wheels, at equal angles from each other, counter-clockwise.
        offset: Direction of the first wheel, rad.
    """
    return tuple(2 * math.pi * index / count + offset for index in range(count))


def omni_rim_speeds(
    places: Sequence[float], forward: Number, sideways: Number, turn: Number, reach: float
) -> tuple[Number, ...]:
    """Returns the rim speed of each wheel, m/s.

    The axis of each wheel points outwards, so equal positive speeds turn the robot clockwise.
    Source: omni_wheel_drive_controller of ros2_controllers.

    Args:
        places: Direction of each wheel, rad; see `wheel_places`.
        forward: Velocity along x, m/s.
        sideways: Velocity along y, m/s.
        turn: Yaw rate, rad/s.
        reach: Distance of the wheels from the centre, m.
    """
    return tuple(
        math.sin(place) * forward - math.cos(place) * sideways - reach * turn for place in places
    )


def omni_motion(places: Sequence[float], rolled: Sequence[Number], reach: float) -> Vec3:
    """Returns the motion of the centre along x and y, m, and its rotation, rad.

    It is the least-squares solution, because more than three wheels can contradict each other. As
    the wheels are at equal angles, its three parts are independent of each other.

    Args:
        places: Direction of each wheel, rad; at least three.
        rolled: Distance that each wheel rolled, m; or rim speeds, m/s.
        reach: Distance of the wheels from the centre, m.
    """
    pairs = list(zip(places, rolled, strict=True))
    return (
        2 * sum(math.sin(place) * each for place, each in pairs) / len(pairs),
        -2 * sum(math.cos(place) * each for place, each in pairs) / len(pairs),
        -sum(each for _, each in pairs) / len(pairs) / reach,
    )


@dataclass(frozen=True, kw_only=True, slots=True)
class OmniWheelsConfig:
    radius: float
    """Radius of the wheels, m."""
    reach: float
    """Distance of the wheels from the centre, m."""
    offset: float
    """Direction of the first wheel from the centre, as an angle to the x axis, rad."""
    measures: Literal["positions", "velocities", "nothing"]
    """What the estimated motion is computed from: the positions or the velocities of the wheels, or
    nothing but the commands."""


class OmniWheels:
    """Turns omni wheels and estimates the robot's pose from their rotation.

    Args:
        config: Dimensions.
        wheels: The wheels, counter-clockwise.
        servo: Pushes a robot whose wheels do not model rollers; None if friction moves it.
        reckoning: The estimate.
    """

    def __init__(
        self,
        config: OmniWheelsConfig,
        wheels: Sequence[CommandedJoint],
        servo: BodyDriveHandle | None,
        reckoning: DeadReckoning,
    ) -> None:
        self._config = config
        self._wheels = wheels
        self._servo = servo
        self._reckoning = reckoning
        self._places = wheel_places(len(wheels), config.offset)

    def restart(self) -> None:
        """Restarts the estimate at the origin, at rest."""
        self._reckoning.restart()
        self._positions = [wheel.position for wheel in self._wheels]
        self._commanded: Vec3 = (0.0, 0.0, 0.0)

    def measure(self, seconds: float) -> None:
        """Updates the estimate by the motion in the last `seconds`."""
        config = self._config
        if config.measures == "nothing":
            forward, sideways, turn = (each * seconds for each in self._commanded)
        else:
            positions = [wheel.position for wheel in self._wheels]
            if config.measures == "positions":
                turned = [
                    now - before for now, before in zip(positions, self._positions, strict=True)
                ]
            else:
                turned = [wheel.velocity * seconds for wheel in self._wheels]
            self._positions = positions
            rolled = [each * config.radius for each in turned]
            forward, sideways, turn = omni_motion(self._places, rolled, config.reach)
        self._reckoning.go(forward, turn, seconds, sideways=sideways)

    def command(self, wanted: Vec3) -> None:
        """Commands x and y velocities in m/s and a yaw rate in rad/s."""
        self._commanded = wanted
        forward, sideways, turn = wanted
        self._push(forward, sideways, turn)
        config = self._config
        speeds = omni_rim_speeds(self._places, forward, sideways, turn, config.reach)
        for wheel, speed in zip(self._wheels, speeds, strict=True):
            wheel.command = speed / config.radius

    def stop(self) -> None:
        """Stops the wheels and the robot immediately."""
        self._commanded = (0.0, 0.0, 0.0)
        for wheel in self._wheels:
            wheel.command = 0.0
        self._push(0.0, 0.0, 0.0)

    def _push(self, forward: float, sideways: float, turn: float) -> None:
        if self._servo is not None:
            self._servo.command((forward, sideways, None), (None, None, turn))
