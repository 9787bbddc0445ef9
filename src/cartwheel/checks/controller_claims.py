"""The joints that a controller commands, and through which interfaces."""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass

from cartwheel.checks import nodes
from cartwheel.checks.controller_files import ControlFile, Controller, Value
from cartwheel.checks.robot import Robot
from cartwheel.checks.subject import Subject
from cartwheel.description.model import Element
from cartwheel.errors import Severity

DIFF_DRIVE = "diff_drive_controller/DiffDriveController"
MECANUM = "mecanum_drive_controller/MecanumDriveController"
TRICYCLE = "tricycle_controller/TricycleController"
STEERED_BY_ONE = (
    "ackermann_steering_controller/AckermannSteeringController",
    "steer_drive_controller/SteerDriveController",
)
"""ROS 1 controllers."""
STEERED = (
    "ackermann_steering_controller/AckermannSteeringController",
    "bicycle_steering_controller/BicycleSteeringController",
    "tricycle_steering_controller/TricycleSteeringController",
)
"""ROS 2 controllers."""
TRAJECTORY = "joint_trajectory_controller/JointTrajectoryController"
CORNERS = ("front_left", "front_right", "back_left", "back_right")
ROS2_CORNERS = ("front_left", "front_right", "rear_left", "rear_right")
_BY_NAME = ("position", "velocity", "effort")
"""Packages such as ``effort_controllers``, which are named after the interface."""
_INTERFACES = {
    "PositionJointInterface": ("position",),
    "VelocityJointInterface": ("velocity",),
    "EffortJointInterface": ("effort",),
    "PosVelJointInterface": ("position", "velocity"),
    "PosVelAccJointInterface": ("position", "velocity"),
}
_SIMULATED = re.compile(
    r"(?i:gazebo|gz_ros2|ign_ros2|ignition|mock|fake|generic|simul)|Sim(System)?$"
)
"""Simulated ros2_control hardware: a real robot's tags may describe different interfaces."""
_STANDARD_HARDWARE = ("gazebo_ros_control/DefaultRobotHWSim", "DefaultRobotHWSim", "")


@dataclass(frozen=True, kw_only=True, slots=True)
class Claim:
    """A joint that a controller commands."""

    joint: str
    interface: str
    """``position``, ``velocity`` or ``effort``."""
    value: Value
    """The value that contains the joint's name."""
    controller: Controller


def claims(controller: Controller) -> list[Claim]:
    """The joints that a controller commands; joints set by a launch file are omitted."""
    return [
        Claim(joint=value.text.strip(), interface=interface, value=value, controller=controller)
        for value, interface in _claims(controller)
        if value.text.strip() and "$" not in value.text
    ]


def _claims(controller: Controller) -> Iterator[tuple[Value, str]]:
    kind, ros2 = controller.kind, controller.file.is_ros2
    package = kind.partition("/")[0]
    if kind == DIFF_DRIVE:
        for side in ("left", "right"):
            for value in wheels_of(controller, side):
                yield value, "velocity"
    elif kind == MECANUM:
        for corner in ROS2_CORNERS if ros2 else CORNERS:
            wheel = wheel_at(controller, corner)
            if wheel is not None:
                yield wheel, "velocity"
    elif kind == TRICYCLE or (ros2 and kind in STEERED) or (not ros2 and kind in STEERED_BY_ONE):
        for value in traction(controller):
            yield value, "velocity"
        for value in steering(controller):
            yield value, "position"
    elif package.removesuffix("_controllers") in _BY_NAME:
        for value in controller.values("joints", "joint"):
            yield value, package.removesuffix("_controllers")
    elif kind == TRAJECTORY:
        for value in controller.values("command_joints", "joints"):
            for interface in controller.values("command_interfaces"):
                yield value, interface.text.strip()
    elif package == "forward_command_controller":
        for value in controller.values("joints", "joint"):
            for interface in controller.values("interface_name", "interface_names"):
                yield value, interface.text.strip()


def wheels_of(controller: Controller, side: str) -> list[Value]:
    """The wheel joints on one side of a differential drive."""
    return controller.values(f"{side}_wheel_names", f"{side}_wheel")


def wheel_at(controller: Controller, corner: str) -> Value | None:
    """The joint of one wheel of a mecanum drive."""
    return controller.value(
        f"{corner}_wheel_command_joint_name", f"{corner}_wheel_name", f"{corner}_wheel_joint"
    )


def traction(controller: Controller) -> list[Value]:
    """The joints of the driven wheels of a steered drive."""
    driven = "rear" if front_steers(controller) else "front"
    return controller.values(
        "traction_joint_name", "traction_joints_names", f"{driven}_wheels_names", "rear_wheel"
    )


def steering(controller: Controller) -> list[Value]:
    """The steered joints of a steered drive."""
    steered = "front" if front_steers(controller) else "rear"
    return controller.values(
        "steering_joint_name", "steering_joints_names", f"{steered}_wheels_names", "front_steer"
    )


def front_steers(controller: Controller) -> bool:
    """Whether the front axle is steered."""
    value = controller.value("front_steering")
    return value is None or value.text.strip().lower() != "false"


def offers(robot: Robot, *, ros2: bool) -> dict[str, list[tuple[str, Element]]]:
    """The interfaces that the robot offers to controllers, by joint, each with its element."""
    found: dict[str, list[tuple[str, Element]]] = {}
    described = robot.description
    for held in described.ros2_control if ros2 else described.transmissions:
        for joint in held.find_all("joint"):
            offered = found.setdefault((joint.attribute("name") or "").strip(), [])
            if ros2:
                offered += [
                    ((each.attribute("name") or "").strip().removesuffix("_pid"), each)
                    for each in joint.find_all("command_interface")
                ]
                offered.append(("", joint))
                continue
            written = [*joint.find_all("hardwareInterface")] or [
                each
                for actuator in held.find_all("actuator")
                for each in actuator.find_all("hardwareInterface")
            ]
            for each in written:
                short = each.text.strip().rpartition("/")[2]
                offered += [(name, each) for name in _INTERFACES.get(short, ())]
            offered.append(("", joint))
    return found


def has_standard_hardware(robot: Robot, *, ros2: bool) -> bool:
    """Whether the hardware provides the interfaces listed in the tags, as in simulation."""
    if ros2:
        plugins = [each.find("hardware/plugin") for each in robot.description.ros2_control]
        return any(each is None or _SIMULATED.search(each.text) for each in plugins)
    for tag, _ in robot.plugins():
        if "ros_control" in tag.filename and "ros2" not in tag.filename:
            kind = next(tag.element.find_all("robotSimType"), None)
            if kind is not None and kind.text.strip() not in _STANDARD_HARDWARE:
                return False
    return True


def gains_missing(controller: Controller) -> list[tuple[str, Value]]:
    """Joints without a PID gain ``p``, each with its value; "" if the controller has a single
    joint.
    """
    kind = controller.kind
    package, _, name = kind.partition("/")
    if controller.file.is_ros2:
        if kind != TRAJECTORY:
            return []
        commands = [value.text.strip() for value in controller.values("command_interfaces")]
        if commands not in (["effort"], ["velocity"]):
            return []
        joints = controller.values("command_joints", "joints")
        ahead = ("p", "i", "ff_velocity_scale")
        return [
            (each.text.strip(), each)
            for each in joints
            if not any(_positive(controller, f"gains/{each.text.strip()}/{key}") for key in ahead)
        ]
    pid = {
        "effort_controllers": ("JointPositionController", "JointVelocityController"),
        "velocity_controllers": ("JointPositionController",),
    }
    if name in pid.get(package, ()):
        joint = controller.value("joint")
        return [] if joint is None or controller.has("pid/p") else [("", joint)]
    held = ""
    if name == "JointTrajectoryController" and package in pid:
        held = "gains/{}"
    elif kind == "effort_controllers/JointGroupPositionController":
        held = "{}/pid"
    return [
        (each.text.strip(), each)
        for each in (controller.values("joints", "joint") if held else ())
        if not controller.has(held.format(each.text.strip()) + "/p")
    ]


def _positive(controller: Controller, path: str) -> bool:
    value = controller.value(path)
    # A value set by a launch file is unknown here.
    return value is not None and ("$" in value.text or bool(nodes.number(value.text)))


def severity_in(file: ControlFile, severity: Severity = "error") -> Severity:
    """The severity for a file: a file that was only found nearby may be for a different robot."""
    return severity if file.named else "warning"


def used_controllers(subject: Subject) -> Iterator[Controller]:
    """The controllers of all robots, except those in nearby files for other robots."""
    for robot, file in subject.control:
        for controller in file.controllers:
            held = claims(controller)
            # Nearby files are used only if they refer to a joint of this robot.
            if file.named or not held or any(claim.joint in robot.joints for claim in held):
                yield controller
