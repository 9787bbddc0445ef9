"""``four_wheel_steering_controller``: ROS 1's controller of four driven and steered wheels."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, ClassVar

from cartwheel.devices.drives.four_steered import FourSteeredConfig, FourSteeredWheels
from cartwheel.devices.drives.limiter import Limits
from cartwheel.devices.periodic import Periodic
from cartwheel.dialects.ros_control.controller import Controller
from cartwheel.dialects.ros_control.controllers.limits import read_limits
from cartwheel.dialects.ros_control.controllers.odometry import (
    MOST_AVERAGED,
    OdometryParameters,
    wheel_odometry,
)
from cartwheel.dialects.ros_control.controllers.twist_command import TwistCommand
from cartwheel.dialects.ros_control.controllers.wheels import (
    LEFT,
    UP,
    check_axes,
    check_axis,
    faces_backward,
    joint_place,
    wheel_radius,
)
from cartwheel.dialects.ros_control.parameters import ignored, parameter
from cartwheel.messages import header, message_class

_STEERING = "four_wheel_steering_msgs/msg/FourWheelSteering"
_NEVER = -(1 << 62)


def _pair(name: str, interface: str, doc: str) -> Any:
    return parameter(name, role="joint", interface=interface, doc=doc)


@dataclass(frozen=True, kw_only=True, slots=True)
class FourWheelSteeringParameters(OdometryParameters):
    front_wheels: tuple[str, ...] = _pair(
        "front_wheel", "velocity", "Joints of the left and the right front wheel."
    )
    rear_wheels: tuple[str, ...] = _pair(
        "rear_wheel", "velocity", "Joints of the left and the right rear wheel."
    )
    front_steering: tuple[str, ...] = _pair(
        "front_steering", "position", "Steering joints of the left and the right front wheel."
    )
    rear_steering: tuple[str, ...] = _pair(
        "rear_steering", "position", "Steering joints of the left and the right rear wheel."
    )
    track: float | None = parameter(
        "track",
        default=None,
        unit="m",
        role="wheel_separation",
        wheels=("front_wheels", "front_wheels"),
        positive=True,
        doc="Distance between the left and the right wheels. Default: read from the description.",
    )
    base: float | None = parameter(
        "wheel_base",
        default=None,
        unit="m",
        role="wheel_base",
        wheels=("front_wheels", "rear_wheels"),
        positive=True,
        doc="Distance between the axles. Default: read from the description.",
    )
    radius: float | None = parameter(
        "wheel_radius",
        default=None,
        unit="m",
        role="wheel_radius",
        wheels=("front_wheels", "rear_wheels"),
        positive=True,
        doc="Radius of the wheels. Default: read from the description.",
    )
    linear: Limits = parameter("linear/x", read=read_limits, doc="Limits of the forward speed.")
    angular: Limits = parameter("angular/z", read=read_limits, doc="Limits of the turning rate.")
    timeout: float = parameter(
        "cmd_vel_timeout", default=0.5, unit="s", doc="Time after which a command expires."
    )
    unused: None = ignored("open_loop", "wheel_steering_y_offset")


class FourWheelSteeringController(Controller):
    """Drives and steers four wheels.

    Commands are Twist messages on ``cmd_vel``, or a speed and the steering angle of each axle on
    ``cmd_four_wheel_steering`` (FourWheelSteering); the last one counts. ``odom_steer`` contains
    the measured speed and angles. Source: four_wheel_steering_controller.
    """

    types: ClassVar[tuple[str, ...]] = (
        "four_wheel_steering_controller/FourWheelSteeringController",
    )

    parameters = FourWheelSteeringParameters

    def configure(self, given: FourWheelSteeringParameters) -> None:
        lists = {
            "front_wheel": given.front_wheels,
            "rear_wheel": given.rear_wheels,
            "front_steering": given.front_steering,
            "rear_steering": given.rear_steering,
        }
        for name, names in lists.items():
            if len(names) != 2:
                wanted = "the left and the right joint"
                raise self.settings.invalid(name, list(names), wanted)
        wheels = [
            self.claim(each, "velocity") for each in (*given.front_wheels, *given.rear_wheels)
        ]
        steering = [
            self.claim(each, "position") for each in (*given.front_steering, *given.rear_steering)
        ]
        driven = [wheel.joint for wheel in wheels]
        self.faces_backward = self._faces_backward(driven)
        if not self.faces_backward:
            check_axes(self, dict.fromkeys(driven, LEFT))
        for joint in steering:
            check_axis(self, joint.joint, UP)
        window = given.window
        if not 1 <= window <= MOST_AVERAGED:
            wanted = f"between 1 and {MOST_AVERAGED:,}"
            raise self.settings.invalid("velocity_rolling_window_size", window, wanted)
        front_left, front_right, rear_left, _ = driven
        offset = self._distance(steering[0].joint, front_left)
        track = given.track or self._distance(front_left, front_right)
        config = FourSteeredConfig(
            wheel_base=self._positive(
                "wheel_base", given.base or self._distance(front_left, rear_left)
            ),
            track=max(track - 2 * offset, 0.0),
            offset=offset,
            radius=self._positive(
                "wheel_radius", given.radius or wheel_radius(self.part.description, front_left)
            ),
            speed_limits=given.linear,
            turn_limits=given.angular,
            window=window,
        )
        self._twist = TwistCommand(self, "cmd_vel", timeout=given.timeout)
        self._timeout_ns = round(given.timeout * 1e9)
        self.subscribe("cmd_four_wheel_steering", _STEERING, self._on_steering)
        self._odometry = wheel_odometry(self, given, averaged=False)
        self._frame = given.odom_frame
        self._state = self.advertise("odom_steer", f"{_STEERING}Stamped", rate=given.publish_rate)
        self._periodic = Periodic(given.publish_rate)
        self._wheels = FourSteeredWheels(config, wheels, steering, self._odometry.reckoning)
        self._forget()

    def _faces_backward(self, driven: Sequence[str]) -> bool:
        """Whether the robot faces along negative x: there are the front wheels, and all wheels are
        on the other sides and roll there.
        """
        description = self.part.description
        front, _, rear, _ = (joint_place(description, name)[0] for name in driven)
        return front < rear and faces_backward(description, driven[0::2], driven[1::2])

    def _positive(self, name: str, value: float | None) -> float:
        if not value:
            raise self.settings.invalid(name, value or 0.0, "positive")
        return value

    def _distance(self, one: str, other: str) -> float:
        """Distance between two joints in the horizontal plane, m."""
        description = self.part.description
        (x1, y1, _), (x2, y2, _) = joint_place(description, one), joint_place(description, other)
        return math.hypot(x2 - x1, y2 - y1)

    def _forget(self) -> None:
        self._twist.stop()
        self._steering = (0.0, 0.0, 0.0)
        self._steered_ns = _NEVER

    def start(self, time_ns: int) -> None:
        self._forget()
        self._odometry.start(time_ns)
        self._periodic.start(time_ns)
        self._wheels.restart()

    def update(self, time_ns: int, seconds: float) -> None:
        wheels = self._wheels
        wheels.measure(seconds)
        self._odometry.publish(time_ns)
        if self._periodic.due(time_ns) and self._state.wanted:
            self._publish(time_ns)
        if self._steered_ns >= self._twist.time_ns:
            expired = time_ns - self._steered_ns > self._timeout_ns
            wheels.command_angles(*((0.0, 0.0, 0.0) if expired else self._steering), seconds)
        else:
            forward, _, turn = self._twist.at(time_ns)
            wheels.command(forward, turn, seconds)

    def stop(self, time_ns: int) -> None:  # noqa: ARG002
        self._wheels.stop()

    def _on_steering(self, message: Any) -> None:
        values = (
            float(message.speed),
            float(message.front_steering_angle),
            float(message.rear_steering_angle),
        )
        if all(math.isfinite(each) for each in values):
            self._steering = values
            self._steered_ns = self.part.time_ns

    def _publish(self, time_ns: int) -> None:
        wheels, motion = self._wheels, self._wheels.motion
        self._state.publish(
            message_class(f"{_STEERING}Stamped")(
                header=header(time_ns, self._frame),
                data=message_class(_STEERING)(
                    front_steering_angle=motion.front,
                    rear_steering_angle=motion.rear,
                    front_steering_angle_velocity=wheels.rate("front"),
                    rear_steering_angle_velocity=wheels.rate("rear"),
                    speed=wheels.speed,
                    acceleration=wheels.rate("acceleration"),
                    jerk=wheels.rate("jerk"),
                ),
            )
        )
