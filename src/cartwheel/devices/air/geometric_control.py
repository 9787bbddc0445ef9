"""Velocity control of a multicopter by its propellers, on the rotation group."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from cartwheel.codes.robot import UNBALANCED
from cartwheel.component import Component, Scope
from cartwheel.description.kinematics import center_of_mass, link_poses
from cartwheel.devices.air.propeller import GZ_ACTUATORS
from cartwheel.geometry import Array, Vec3, cross, matrix_from_quat
from cartwheel.messages import zero
from cartwheel.world.build import DEFAULT_STEP

_PARALLEL = 1e-3
"""Square of the sine of the angle between two axes below which they are parallel."""
_SMALLEST_RANK = 1e-9
"""Smallest singular value relative to the largest with which motions can be controlled."""

_MOST_CHANGE = 0.5
"""Largest part of an error of the angular velocity that one step may correct."""
_FAST_STEP = 0.001
"""Gazebo's default time step, s."""
_DRIFTS = 0.05
"""Smallest error of the velocity that is reported, m/s."""
_SIDES = (
    (("in front of", "forward"), ("behind", "backward")),
    (("to the left of", "to the left"), ("to the right of", "to the right")),
)
"""Where the centre of mass is, and to where the vehicle drifts: along x and -x, y and -y."""


@dataclass(frozen=True, kw_only=True, slots=True)
class RotorConfig:
    """A propeller of a `GeometricControl`."""

    place: tuple[float, float]
    """Place in the xy plane of the controlled link, m."""
    thrust: float
    """Force along the link's z axis per square of the speed, N s²/rad²."""
    moment: float
    """Torque divided by the force, m."""
    counterclockwise: bool
    """Direction of rotation, seen from above."""


@dataclass(frozen=True, kw_only=True, slots=True)
class GeometricControlConfig:
    """Configuration of a `GeometricControl`. All three components of the gains are positive."""

    link: str
    """Link whose velocity is controlled."""
    rotors: tuple[RotorConfig, ...]
    """The propellers, in the order of the commanded speeds."""
    velocity_gain: Vec3
    """Force per velocity error along the axes of the world, N s/m."""
    attitude_gain: Vec3
    """Torque per error of the orientation about the axes of the link, N m."""
    rate_gain: Vec3
    """Torque per error of the angular velocity, N m s."""
    max_acceleration: Vec3
    """Largest acceleration that a velocity error demands along the axes of the world, m/s²."""
    max_velocity: Vec3
    """Largest commanded velocity along the axes of the link, m/s."""
    max_rate: Vec3
    """Largest commanded angular velocity, rad/s."""
    velocity_noise: tuple[Vec3, Vec3]
    """Mean and standard deviation of the noise of the measured velocity, m/s."""
    rate_noise: tuple[Vec3, Vec3]
    """The same of the angular velocity, rad/s."""
    command_topic: str
    """Topic of the velocities in the axes of the link (Twist)."""
    enable_topic: str
    """Topic that switches the control on and off (Bool)."""
    motor_topics: tuple[str, ...]
    """Topics of the speeds of all propellers in rad/s (Actuators)."""


class GeometricControl(Component):
    """Commands the speeds of propellers so that a link moves and yaws as commanded.

    The controller waits for the first command. Source: T. Lee, M. Leok and N. McClamroch, Control
    of complex maneuvers for a quadrotor UAV using geometric methods on SE(3), 2010, and
    MulticopterVelocityControl of gz-sim.

    Raises:
        UnknownNameError: The link does not exist.
    """

    def __init__(self, scope: Scope, config: GeometricControlConfig) -> None:
        super().__init__(scope)
        part = self.part
        self._config = config
        self._link = part.link(config.link, origin=self.origin)
        self._allocation = np.linalg.pinv(allocation(config.rotors))
        self._mass = part.description.mass
        self._limit_step()
        self._examined = False
        self.reset()
        self.subscribe(config.command_topic, "geometry_msgs/msg/Twist", self._on_command)
        self.subscribe(config.enable_topic, "std_msgs/msg/Bool", self._on_enable)
        self._motors = [self.advertise(topic, GZ_ACTUATORS) for topic in config.motor_topics]
        part.schedule(0, before=self._control)

    def _limit_step(self) -> None:
        """Requests the step of Gazebo if the loop of the angular velocity is fast.

        With a gain k and a moment of inertia I, the torque of one step T changes the velocity by
        k T / I of its error. The delays of the motors and of the step leave room for a half of it.
        """
        link = self.part.description.link(self._config.link)
        moments = link.inertial.diagonal if link is not None and link.inertial is not None else ()
        fastest = max(
            (
                k / moment
                for k, moment in zip(self._config.rate_gain, moments, strict=False)
                if moment > 0
            ),
            default=0.0,
        )
        if fastest * DEFAULT_STEP > _MOST_CHANGE:
            self.part.limit_step(_FAST_STEP, "the gain of the angular velocity", origin=self.origin)

    def _report_drift(self) -> None:
        """Reports a centre of mass beside the link about which the propellers turn the vehicle."""
        part, name = self.part, self._config.link
        poses = link_poses(part.description, {})
        place = center_of_mass(part.description, poses)
        if place is None:
            return
        x, y, _ = poses[name].inverse().apply(place).tolist()
        centre = (x, y)
        size = float(np.linalg.norm(self._link.gravity))
        drift = drift_of(self._config, weight=self._mass * size, centre=centre)
        axis = 0 if abs(drift[0]) >= abs(drift[1]) else 1
        speed = abs(drift[axis])
        if speed < _DRIFTS:
            return
        near, far = _SIDES[axis][drift[axis] < 0]
        self.warn(
            UNBALANCED,
            f"the centre of mass is {1000 * abs(centre[axis]):.2g} mm {near} the origin of "
            f'link "{name}", so the multicopter drifts {far} at {speed:.2g} m/s, '
            "because the controller has no integral part",
            values={"link": name, "centre": centre, "drift": drift},
            hint="Move the masses so that the centre of mass is above the origin of the link.",
        )

    def reset(self) -> None:
        super().reset()
        self._enabled = True
        self._command: tuple[Array, Array] | None = None
        self._turning = False

    def _on_command(self, message: Any) -> None:
        config = self._config
        linear, angular = (
            np.clip([each.x, each.y, each.z], -np.array(most), most)
            for each, most in (
                (message.linear, config.max_velocity),
                (message.angular, config.max_rate),
            )
        )
        self._command = linear, angular

    def _on_enable(self, message: Any) -> None:
        self._enabled = bool(message.data)

    def _control(self) -> None:
        if not self._examined:
            # Gravity is known when the simulation runs.
            self._examined = True
            self._report_drift()
        if not self._enabled:
            if self._turning:
                self._turn(np.zeros(len(self._config.rotors)))
            self._turning, self._command = False, None
            return
        if self._command is None:
            return
        config, link = self._config, self._link
        self.part.locate()
        _, orientation = link.place()
        linear, _ = link.motion(local=False)
        _, angular = link.motion(local=True)
        velocity = self._with_noise("velocity", linear, *config.velocity_noise)
        rate = self._with_noise("rate", angular, *config.rate_noise)
        torque, thrust = demanded_wrench(
            config,
            mass=self._mass,
            gravity=np.array(link.gravity),
            axes=matrix_from_quat(orientation),
            velocity=velocity,
            rate=rate,
            command=self._command,
        )
        squares = self._allocation @ np.array([*torque, thrust])
        self._turning = True
        self._turn(np.sqrt(np.maximum(squares, 0.0)))

    def _with_noise(self, name: str, value: Vec3, mean: Vec3, deviation: Vec3) -> Array:
        spread = np.array(deviation)
        if not spread.any():
            return np.array(value)
        drawn = self.part.random(f"{self.node} {name}").normal(mean, spread)
        noisy: Array = np.array(value) + np.where(spread > 0, drawn, 0.0)
        return noisy

    def _turn(self, speeds: Array) -> None:
        message = zero(GZ_ACTUATORS)
        message.velocity = speeds
        for publisher in self._motors:
            publisher.publish(message)


def drift_of(
    config: GeometricControlConfig, *, weight: float, centre: tuple[float, float]
) -> tuple[float, float]:
    """Velocity error along x and y of the link at which the multicopter is in balance, m/s.

    The weight G at the distance x from the origin of the link needs the torque G x, for which the
    controller needs an error of the orientation of G x / a, with the attitude gain a. It tilts by
    this angle at a velocity error of G (G x / a) / k, with the velocity gain k. Without gains, the
    velocity is not controlled, and the error is 0.
    """
    (x, y), attitude, velocity = centre, config.attitude_gain, config.velocity_gain
    ahead, aside = attitude[1] * velocity[0], attitude[0] * velocity[1]
    return (
        weight**2 * x / ahead if ahead > 0 else 0.0,
        weight**2 * y / aside if aside > 0 else 0.0,
    )


def allocation(rotors: Sequence[RotorConfig]) -> Array:
    """Torques about the axes of the link and force along z, per square of each propeller's speed.

    Returns:
        Shape (4, n), N m s²/rad² and N s²/rad².
    """
    columns = []
    for each in rotors:
        x, y = each.place
        sense = 1.0 if each.counterclockwise else -1.0
        columns.append([y * each.thrust, -x * each.thrust, -sense * each.thrust * each.moment,
                        each.thrust])  # fmt: skip
    return np.array(columns).reshape(-1, 4).T


def controls_all(rotors: Sequence[RotorConfig]) -> bool:
    """Whether the propellers can apply any torque and force along z."""
    sizes = np.linalg.svd(allocation(rotors), compute_uv=False)
    return len(sizes) == 4 and bool(sizes[3] > _SMALLEST_RANK * sizes[0])


def demanded_wrench(
    config: GeometricControlConfig,
    *,
    mass: float,
    gravity: Array,
    axes: Array,
    velocity: Array,
    rate: Array,
    command: tuple[Array, Array],
) -> tuple[Array, float]:
    """Returns the torque about the axes of the link in N m, shape (3,), and the force along z in N.

    The gains of gz-sim are divided by the inertia, and the angular acceleration is multiplied by
    it, so the torque does not depend on the inertia.

    Args:
        config: The gains and limits.
        mass: Mass of the vehicle, kg.
        gravity: Acceleration in the world, m/s², shape (3,).
        axes: Orientation of the link, shape (3, 3).
        velocity: Velocity in the world, m/s, shape (3,).
        rate: Angular velocity in the axes of the link, rad/s, shape (3,).
        command: Velocity and angular velocity in the axes of the link.
    """
    linear, angular = command
    error = velocity - axes @ linear
    wanted = error * config.velocity_gain / mass
    wanted = np.clip(wanted, -np.array(config.max_acceleration), config.max_acceleration) + gravity
    size = float(np.linalg.norm(wanted))
    target = axes if size == 0.0 else _axes_along(-wanted / size, axes)
    skew = (target.T @ axes - axes.T @ target) / 2
    tilt = np.array([skew[2, 1], skew[0, 2], skew[1, 0]])
    rate_error = rate - axes.T @ target @ np.array([0.0, 0.0, angular[2]])
    torque: Array = -(tilt * config.attitude_gain + rate_error * config.rate_gain)
    return torque, -mass * float(wanted @ axes[:, 2])


def _axes_along(up: Array, axes: Array) -> Array:
    """Orientation with this z axis whose x axis is as near as possible to that of `axes`."""
    for ahead in axes.T:
        left = cross(up, ahead)
        if left @ left >= _PARALLEL:
            break
    left = left / np.linalg.norm(left)
    return np.column_stack([cross(left, up), left, up])
