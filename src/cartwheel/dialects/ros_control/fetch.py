"""``libfetch_gazebo_plugin.so``: the controllers of Fetch and Freight."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from typing import Any, ClassVar

from cartwheel.codes import devices
from cartwheel.dialects.ros_control.control_plugin import ControlPlugin
from cartwheel.dialects.ros_control.files import ControllerEntry, ControllerFiles
from cartwheel.dialects.ros_control.hardware import Hardware
from cartwheel.dialects.ros_control.interfaces import JointInterfaces
from cartwheel.dialects.ros_control.launched.names import ros1_entries
from cartwheel.dialects.ros_control.robot import ControlledRobot
from cartwheel.dialects.ros_control.settings import Settings
from cartwheel.dialects.tags import SMALLEST
from cartwheel.errors import Origin
from cartwheel.messages import message_class

_TWIST = "geometry_msgs/msg/Twist"
_TYPES = "robot_controllers/"
_TRAJECTORY, _GRIPPER = (
    f"{_TYPES}FollowJointTrajectoryController",
    f"{_TYPES}ParallelGripperController",
)
_BASE, _MIMIC = f"{_TYPES}DiffDriveBaseController", f"{_TYPES}ScaledMimicController"
_NEEDLESS = (f"{_TYPES}GravityCompensation",)
"""Types without an effect: position commands hold the joints against gravity."""
TRANSLATED = frozenset({_BASE, _MIMIC, *_NEEDLESS})
"""Supported types that no controller has."""
_STATES = ControllerEntry(
    name="joint_state_controller",
    type="joint_state_controller/JointStateController",
    values={"publish_rate": 100.0},
    namespace="",
    source="",
)


@dataclass(frozen=True, kw_only=True, slots=True)
class FetchParameters:
    """The plugin has no tags."""


class Fetch(ControlPlugin):
    """Runs the controllers of Fetch and Freight, whose parameters are in a YAML file.

    A launch file loads the file, or it is passed with ``cartwheel run --controllers``. A
    ``DiffDriveBaseController`` drives the wheels: it subscribes to ``cmd_vel`` and
    ``base_controller/command`` (Twist) and publishes ``odom``. As in the original, the default of
    ``track_width`` is 0.37476 m and that of ``radians_per_meter`` 16.5289 rad/m. A
    ``FollowJointTrajectoryController`` follows trajectories by the action
    ``follow_joint_trajectory``. A goal starts it, and stops other controllers of the same joints.
    A ``ParallelGripperController`` moves the fingers by the action ``gripper_action``. A
    ``ScaledMimicController`` moves a joint in proportion to another joint. ``GravityCompensation``
    is not needed, because all joints hold their positions. ``PointHeadController`` is not
    supported.

    The plugin publishes ``joint_states`` at 100 Hz. Joints follow positions with their effort
    limits, so the PID gains below ``gazebo`` have no effect. Original plugin: ``plugin.cpp`` in the
    package ``fetch_gazebo``.
    """

    filenames: ClassVar[tuple[str, ...]] = ("libfetch_gazebo_plugin.so",)
    parameters: ClassVar[type] = FetchParameters

    def configure(self) -> None:
        self.namespace = self.namespace.strip("/")
        found = list(self._entries())
        if not found:
            self.warn(
                devices.CONTROLLERS_FILE_WITHOUT_CONTROLLERS,
                "no file specifies a controller, so nothing drives the joints",
                hint="Pass fetch_gazebo/config/default_controllers.yaml with --controllers.",
                severity="info",
            )
        limits = Settings({}, "joint_limits")
        hardware = Hardware(self, list(self._joints(found)), {}, limits)
        hardware.holds = True
        robot = ControlledRobot(self, hardware, namespace=self.namespace, ros2=False)
        manager = self._run(robot, 0.0)
        entries = [made for entry in found if (made := self._supported(entry)) is not None]
        self._start([_STATES, *(each for each in entries if each.type != _TRAJECTORY)])
        loaded = self.shared.get(ControllerFiles).loaded
        for entry in entries:
            if entry.type == _TRAJECTORY:
                loaded.append(manager.load_entry(entry))

    def _entries(self) -> Iterator[ControllerEntry]:
        """Yields the controllers in the files that start with the robot."""
        files = self.shared.get(ControllerFiles)
        for path in files.take():
            content = files.read(path, self.part.description)
            gazebo = content.get("gazebo")
            listed = gazebo.get("default_controllers") if isinstance(gazebo, Mapping) else None
            wanted = [str(each).strip("/") for each in listed] if isinstance(listed, list) else None
            for entry in ros1_entries(content, str(path)):
                full = f"{entry.namespace}/{entry.name}".strip("/")
                if wanted is None or full in wanted:
                    space, _, name = full.rpartition("/")
                    yield replace(entry, namespace=space, name=name)

    def _joints(self, entries: list[ControllerEntry]) -> Iterator[JointInterfaces]:
        """Yields the interfaces of all movable joints."""
        wheels: set[str] = set()
        mimics: dict[str, tuple[str, float]] = {}
        for entry in entries:
            settings = entry.settings()
            if entry.type == _BASE:
                wheels.update(_wheels(settings))
            elif entry.type == _MIMIC:
                follower = settings.text("controlled_joint")
                leader = settings.text("mimic_joint")
                mimics[follower] = (leader, settings.number("mimic_scale", 1.0))
        for joint in self.part.description.joints:
            if not joint.drivable:
                continue
            yield JointInterfaces(
                name=joint.name,
                commands=("velocity",) if joint.name in wheels else ("position",),
                mimic=mimics.get(joint.name),
                origin=joint.origin,
            )

    def _supported(self, entry: ControllerEntry) -> ControllerEntry | None:
        """Returns the controller that does the same; None: it has no effect, or is unsupported."""
        if entry.type in (_TRAJECTORY, _GRIPPER):
            # The name of the action is the last part of the controller's name.
            return replace(entry, name=entry.namespace or entry.name, namespace="")
        if entry.type == _BASE:
            return self._base(entry)
        if entry.type not in (_MIMIC, *_NEEDLESS):
            self.warn(
                devices.CONTROLLER_TYPE_UNKNOWN,
                f'controller "{entry.namespace or entry.name}" has no effect because its type '
                f'"{entry.type}" is not supported',
                at=Origin(file=entry.source),
                values={"kind": "controller type", "name": entry.type},
            )
        return None

    def _base(self, entry: ControllerEntry) -> ControllerEntry:
        """Returns the drive of the base. The defaults are those of robot_controllers."""
        settings = entry.settings()
        left, right = _wheels(settings)
        turns = settings.number("radians_per_meter", 16.5289)
        if turns < SMALLEST:
            raise settings.invalid("radians_per_meter", turns, "a positive number")
        command = f"{entry.name}/command"
        self.subscribe(command, _TWIST, self._on_base_command)
        self._Twist = message_class(_TWIST)
        return replace(
            entry,
            type="diff_drive_controller/DiffDriveController",
            values={
                "left_wheel": left,
                "right_wheel": right,
                "wheel_separation": settings.number("track_width", 0.37476),
                "wheel_radius": 1.0 / turns,
                "base_frame_id": "base_link",
                "publish_rate": 50.0,
                "enable_odom_tf": settings.boolean("publish_tf", True),
                "cmd_vel_timeout": settings.number("timeout", 0.25),
                "linear": {"x": _limits(settings, "x", 1.0, 0.75)},
                "angular": {"z": _limits(settings, "r", 4.5, 3.0)},
            },
            remappings={"~/cmd_vel": "cmd_vel", "~/odom": "odom"},
        )

    def _on_base_command(self, message: Any) -> None:
        self.graph.publish(
            self.resolve("cmd_vel"), _TWIST, self._Twist(message.linear, message.angular)
        )


def _wheels(settings: Settings) -> tuple[str, str]:
    """Returns the joints of the left and the right wheel."""
    return (
        settings.text("l_wheel_joint", "l_wheel_joint"),
        settings.text("r_wheel_joint", "r_wheel_joint"),
    )


def _limits(settings: Settings, axis: str, velocity: float, acceleration: float) -> dict[str, Any]:
    """Returns the limits of one direction, in the form of diff_drive_controller."""
    return {
        "has_velocity_limits": True,
        "max_velocity": settings.number(f"max_velocity_{axis}", velocity),
        "has_acceleration_limits": True,
        "max_acceleration": settings.number(f"max_acceleration_{axis}", acceleration),
    }
