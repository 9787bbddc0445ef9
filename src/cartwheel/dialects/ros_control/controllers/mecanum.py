"""``mecanum_drive_controller``: four wheels with rollers, for motion in all directions."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, ClassVar

from cartwheel.codes import devices, robot, running
from cartwheel.description.rolling import rolling
from cartwheel.devices.drives.limiter import Limits
from cartwheel.devices.drives.mecanum import MecanumWheels, MecanumWheelsConfig
from cartwheel.devices.drives.rollers import BACKWARD, has_grip, has_rollers
from cartwheel.dialects.ros_control.controllers.limits import read_limits
from cartwheel.dialects.ros_control.controllers.odometry import wheel_odometry
from cartwheel.dialects.ros_control.controllers.twist_command import TwistCommand
from cartwheel.dialects.ros_control.controllers.wheel_controller import WheelController
from cartwheel.dialects.ros_control.controllers.wheels import (
    LEFT,
    FramePrefixParameters,
    check_axes,
    faces_backward,
    frame_prefix,
    joint_place,
    wheel_radius,
)
from cartwheel.dialects.ros_control.parameters import parameter, ros2_parameter
from cartwheel.geometry import Vec3
from cartwheel.messages import header, zero
from cartwheel.messages.store import TWIN

_CORNERS = ("front_left", "front_right", "back_left", "back_right")
_STATE = f"control_msgs{TWIN}/msg/MecanumDriveControllerState"


def _wheel(corner: str, ros1: str) -> Any:
    """The parameter with the joint of a wheel; Husarion's name comes first."""
    return parameter(
        ros1=(f"{ros1}_wheel_joint",),
        ros2=(f"{corner}_wheel_name", f"{corner}_wheel_command_joint_name"),
        default=f"{ros1}_wheel_joint",
        role="joint",
        interface="velocity",
        doc=f"Joint of the {corner.replace('_', ' ')} wheel.",
    )


@dataclass(frozen=True, kw_only=True, slots=True)
class MecanumParameters(FramePrefixParameters):
    front_left: str = _wheel("front_left", "front_left")
    front_right: str = _wheel("front_right", "front_right")
    rear_left: str = _wheel("rear_left", "back_left")
    rear_right: str = _wheel("rear_right", "back_right")
    radius: float | None = parameter(
        "wheel_radius",
        ros2=("kinematics/wheels_radius", "wheel_radius"),
        default=None,
        unit="m",
        role="wheel_radius",
        wheels=("front_left", "front_right", "rear_left", "rear_right"),
        doc="Radius of the wheels. Default: read from the description.",
    )
    radius_factor: float = parameter(
        "wheel_radius_multiplier", default=1.0, doc="Factor on the radius."
    )
    reach: float | None = ros2_parameter(
        "kinematics/sum_of_robot_center_projection_on_X_Y_axis",
        default=None,
        unit="m",
        role="wheel_reach",
        wheels=("front_left", "rear_right"),
        doc="Half the sum of both wheel separations. Default: read from the description.",
    )
    reach_factor: float = parameter(
        "wheel_separation_multiplier", default=1.0, doc="Factor on both wheel separations."
    )
    along: float | None = parameter(
        "wheel_separation_x",
        default=None,
        unit="m",
        role="wheel_base",
        wheels=("front_left", "rear_left"),
        doc="Distance between the axles. Default: read from the description.",
    )
    along_factor: float = ros2_parameter(
        "wheel_separation_x_multiplier",
        default=1.0,
        doc="Factor on the distance of the axles.",
    )
    across: float | None = parameter(
        "wheel_separation_y",
        default=None,
        unit="m",
        role="wheel_separation",
        wheels=("front_left", "front_right"),
        doc="Distance between left and right wheels. Default: read from the description.",
    )
    across_factor: float = ros2_parameter(
        "wheel_separation_y_multiplier",
        default=1.0,
        doc="Factor on the distance between left and right wheels.",
    )
    offset_x: float = parameter(
        "kinematics/base_frame_offset/x",
        default=0.0,
        unit="m",
        doc="Position of the base frame relative to the centre of the wheels.",
    )
    offset_y: float = parameter(
        "kinematics/base_frame_offset/y", default=0.0, unit="m", doc="The same along y."
    )
    offset_yaw: float = parameter(
        "kinematics/base_frame_offset/theta", default=0.0, unit="rad", doc="The same as an angle."
    )
    linear_x: Limits = parameter("linear/x", read=read_limits, doc="Limits of the forward speed.")
    linear_y: Limits = parameter("linear/y", read=read_limits, doc="Limits of the sideways speed.")
    angular: Limits = parameter("angular/z", read=read_limits, doc="Limits of the turning rate.")
    stamped: bool = ros2_parameter(
        "use_stamped_vel",
        default=True,
        doc="Subscribe to TwistStamped instead of Twist on a topic that ends in `_unstamped`.",
    )
    timeout: float = parameter(
        "cmd_vel_timeout",
        default=0.5,
        unit="s",
        doc="Time after which a command expires. In ROS 2, only Husarion's controller reads it.",
    )
    reference_timeout: float = ros2_parameter(
        "reference_timeout",
        default=0.0,
        unit="s",
        doc="Time after which a reference expires; 0 is never.",
    )
    open_loop: bool = ros2_parameter("open_loop", default=False, doc="Not supported.")
    publish_limited: bool = ros2_parameter(
        "publish_limited_velocity", default=False, doc="Not supported."
    )
    unused: None = ros2_parameter(
        "position_feedback",
        "front_left_wheel_state_joint_name",
        "front_right_wheel_state_joint_name",
        "rear_left_wheel_state_joint_name",
        "rear_right_wheel_state_joint_name",
        default=None,
        doc="No effect.",
    )


class MecanumDriveController(WheelController):
    """Turns four mecanum wheels as Twist commands require, and publishes odometry.

    If the wheels model rollers, friction moves the robot; see `has_rollers`. Otherwise a servo
    pushes it, as for gz-sim-mecanum-drive-system, provided that the controller's parameters are
    known when the robot is spawned. ROS 1 uses the topic ``cmd_vel``, ROS 2 ``reference``.
    Husarion's controller with the same name has different parameters and uses ``cmd_vel``. Source:
    mecanum_drive_controller; husarion_controllers.
    """

    types: ClassVar[tuple[str, ...]] = ("mecanum_drive_controller/MecanumDriveController",)
    sideways: ClassVar[bool] = True
    _wheels: MecanumWheels

    parameters = MecanumParameters

    def configure(self, given: MecanumParameters) -> None:
        ros2, settings = self.robot.ros2, self.settings
        husarion = ros2 and settings.has("front_left_wheel_name")
        nested = ros2 and not husarion
        self._joints = [
            self.claim(name, "velocity")
            for name in (given.front_left, given.front_right, given.rear_left, given.rear_right)
        ]
        names = [wheel.joint for wheel in self._joints]
        description = self.part.description
        if not faces_backward(description, names[0::2], names[1::2]):
            check_axes(self, dict.fromkeys(names, LEFT))
        radius = given.radius or wheel_radius(description, names[0]) or 0.0
        reach = given.reach
        if not reach:
            along = [joint_place(description, name)[0] for name in names]
            across = [joint_place(description, name)[1] for name in names]
            x = max(along) - min(along) if given.along is None else given.along
            y = max(across) - min(across) if given.across is None else given.across
            reach = (x * given.along_factor + y * given.across_factor) / 2
        reach *= given.reach_factor
        radius *= given.radius_factor
        if radius <= 0 or reach <= 0:
            raise settings.error(
                devices.CONTROLLER_PARAMETER_INVALID,
                f"the wheel radius and separations must be positive (got {radius:g} and {reach:g})",
                values={"radius": radius, "reach": reach},
            )
        config = MecanumWheelsConfig(
            radius=radius,
            reach=reach,
            offset=(given.offset_x, given.offset_y, given.offset_yaw),
            rolling=rolling(description, names[0::2], names[1::2]),
            limits=(given.linear_x, given.linear_y, given.angular),
        )
        stamped = ros2 and given.stamped
        topic = "reference" if nested else "cmd_vel"
        if ros2 and not stamped:
            topic += "_unstamped"
        # In ROS 2, commands do not expire by default.
        timeout = given.reference_timeout if nested else given.timeout
        self._command = TwistCommand(self, topic, timeout=timeout, stamped=stamped)
        prefix = frame_prefix(self, given)
        self._odometry = wheel_odometry(
            self,
            given,
            topic="odometry" if nested else "odom",
            tf_topic="tf_odometry" if nested else "/tf",
            prefix=prefix,
        )
        self._frame = prefix + given.odom_frame
        self._state = self.advertise("controller_state", _STATE) if nested else None
        if husarion and given.open_loop:
            self.warn_ignored("open_loop")
        if husarion and given.publish_limited:
            self.warn_ignored("publish_limited_velocity")
        wheels = [(joint,) for joint in self._joints]
        grips = has_grip(description, [each.joint for each in self._joints])
        push = self.robot.push if grips else None
        self._wheels = MecanumWheels(config, wheels, push, self._odometry.reckoning)
        if config.rolling.backward and config.rolling.heading:
            # `check_axes` reports the wheels of a robot that faces along x.
            values = {"joint": names[0], "attribute": "backwards"}
            self.warn(robot.WHEEL_AXIS_MISALIGNED, BACKWARD, values=values)
        if not grips:
            self.warn(
                robot.WHEEL_FRICTIONLESS,
                "the wheels have no friction, so the controller does not move the robot",
            )
        elif push is None and not has_rollers(description):
            self.warn(
                running.WHEELS_WITHOUT_ROLLERS,
                "the wheels do not model rollers, so the robot does not move sideways",
                hint="Load the controller's parameters before the robot is spawned: Cartwheel then "
                "moves the whole robot at the commanded velocity.",
            )

    def start(self, time_ns: int) -> None:
        super().start(time_ns)
        self._wheels.measure(0.0)

    def _drive(self, command: Vec3, time_ns: int, seconds: float) -> None:
        command = self._wheels.command(command, seconds)
        if self._state is not None and self._state.wanted:
            self._state.publish(self._state_message(time_ns, command))

    def _state_message(self, time_ns: int, command: Vec3) -> Any:
        message = zero(_STATE)
        message.header = header(time_ns, self._frame)
        for corner, wheel in zip(_CORNERS, self._joints, strict=True):
            setattr(message, f"{corner}_wheel_velocity", wheel.velocity)
        reference = message.reference_velocity
        reference.linear.x, reference.linear.y, reference.angular.z = command
        return message
