"""``libgazebo_ros_control.so``: ROS 1 controllers for the joints of transmissions."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any, ClassVar

from cartwheel.codes import devices
from cartwheel.devices.joints.pid import PidGains
from cartwheel.dialects.catalogue import ROS_CONTROL, short_name
from cartwheel.dialects.ros_control import steer_bot
from cartwheel.dialects.ros_control.control_plugin import ControlPlugin
from cartwheel.dialects.ros_control.files import ControllerEntry, ControllerFiles, is_ros2, of_ros2
from cartwheel.dialects.ros_control.gains import read_gains
from cartwheel.dialects.ros_control.hardware import Hardware
from cartwheel.dialects.ros_control.interfaces import (
    JointInterfaces,
    is_plain,
    is_unknown,
    no_joints,
    transmissions,
    unknown_hardware,
    unknown_joints,
)
from cartwheel.dialects.ros_control.launched.names import ros1_entries
from cartwheel.dialects.ros_control.robot import ControlledRobot
from cartwheel.dialects.ros_control.services import Ros1ManagerServices
from cartwheel.dialects.ros_control.settings import Settings
from cartwheel.dialects.tags import tag
from cartwheel.errors import Origin
from cartwheel.graph import is_name


@dataclass(frozen=True, kw_only=True, slots=True)
class RosControlParameters:
    sim_type: str = tag(
        "robotSimType",
        "robot_sim_type",
        default="",
        doc="Name of the hardware plugin. `DefaultRobotHWSim`, the default, and "
        "`SteerBotHardwareGazebo` are simulated. With any other name, joints are driven as with "
        "the default, with a warning.",
    )
    period: float = tag(
        "controlPeriod",
        default=0.0,
        unit="s",
        least=0.0,
        doc="Time between two updates of the controllers. If 0, they are updated at every "
        "simulation step.",
    )
    legacy: bool = tag(
        "legacyModeNS",
        default=True,
        doc="No effect: PID gains are read from the robot's namespace, or else from the "
        "global namespace.",
    )
    stop_topic: str = tag(
        "eStopTopic",
        default="",
        doc="Topic of the emergency stop (Bool). All joints are stopped while the last message "
        "is true.",
    )


class RosControl(ControlPlugin):
    """Runs the ros_control controllers that are loaded with the controller manager's services.

    Controllers in YAML files that you pass with ``cartwheel run --controllers`` start
    automatically. The controller manager is in the namespace that the ``<plugin>`` specifies, or
    else in that of the node that spawns the model. By default, it is in the global namespace.
    Original package: ``gazebo_ros_control``.
    """

    filenames: ClassVar[tuple[str, ...]] = ("libgazebo_ros_control.so",)
    parameters: ClassVar[type] = RosControlParameters

    def configure(self) -> None:
        config: RosControlParameters = self.config
        part = self.part
        plain = is_plain(config.sim_type)
        steered = config.sim_type == steer_bot.SIM_TYPE
        if is_unknown(config.sim_type):
            part.report(unknown_hardware(self.tag, config.sim_type))
        elif not plain and not steered:
            self.warn(
                devices.HARDWARE_NOT_SIMULATED,
                f'<robotSimType> "{config.sim_type}" is not simulated, so joints are driven as '
                "with DefaultRobotHWSim",
                values={"hardware": config.sim_type},
            )
        if short_name(self.tag.filename) != ROS_CONTROL:
            self.warn(
                devices.HARDWARE_NOT_SIMULATED,
                f'plugin "{self.tag.filename}" is simulated as lib{ROS_CONTROL}.so; '
                "its additional functions are not supported",
                values={"hardware": self.tag.filename},
            )
        self.namespace = self.namespace.strip("/")
        files = self.shared.get(ControllerFiles)
        contents = [(str(path), files.read(path, part.description)) for path in files.take()]
        entries = [entry for path, content in contents for entry in self._load(path, content)]
        rate = 0.0 if config.period == 0 else 1.0 / config.period
        hardware = self._steer_bot() if steered else None
        if hardware is None:
            hardware = self._default_hardware(several=not plain)
        self._hardware = hardware
        manager = self._run(
            ControlledRobot(
                self,
                hardware,
                namespace=self.namespace,
                ros2=False,
                sensors=self._sensors(),
                push=self._push(self._known_types()),
            ),
            rate,
        )
        if config.stop_topic:
            self.subscribe(config.stop_topic, "std_msgs/msg/Bool", self._on_stop)
        Ros1ManagerServices(self, manager)
        self._start([replace(entry, values=self._parameters_of(entry)) for entry in entries])

    def _settings(self, name: str) -> Settings | None:
        """Returns the parameters of a namespace in the robot's namespace; None if it is empty."""
        values = self.graph.parameters.get(f"/{self.namespace}/{name}")
        if not isinstance(values, Mapping):
            return None
        return Settings(values, name, f"/{self.namespace}")

    def _steer_bot(self) -> Hardware | None:
        """Returns the hardware SteerBotHardwareGazebo; None, with a report, without parameters."""
        name = steer_bot.PARAMETERS
        place = "/".join(["", *self.namespace.strip("/").split("/"), name]).replace("//", "/")
        settings = self._settings(name)
        if settings is not None:
            return steer_bot.SteerBotHardware(self, settings, self.tag.origin)
        self.warn(
            devices.HARDWARE_NOT_SIMULATED,
            f'<robotSimType> "{steer_bot.SIM_TYPE}" has no parameters in '
            f'"{place}", so joints are driven as with DefaultRobotHWSim',
            hint=f'Pass the YAML file that contains "{name}", with --controllers.',
            values={"hardware": steer_bot.SIM_TYPE, "parameters": name},
        )
        return None

    def _default_hardware(self, *, several: bool) -> Hardware:
        joints, notes = transmissions(self.part.description, several=several)
        for note in notes:
            self.part.report(note)
        if not joints:
            self.warn(
                devices.CONTROL_WITHOUT_JOINTS,
                no_joints("<transmission>", unknown_joints(notes)),
                values={"joints": unknown_joints(notes)},
            )
        limits = self._settings("joint_limits") or Settings({}, "joint_limits")
        return Hardware(self, joints, self._gains(joints), limits)

    def _parameters_of(self, entry: ControllerEntry) -> Mapping[str, Any]:
        name = f"/{self.namespace}/{entry.name}"
        if not is_name(name):
            return entry.values
        values: Mapping[str, Any] = self.graph.parameters.get(name, entry.values)
        return values

    def _known_types(self) -> list[str]:
        """Returns the types of controllers whose parameters exist already."""
        values = self.graph.parameters.get(f"/{self.namespace}" if self.namespace else "/")
        if not isinstance(values, Mapping):
            return []
        return [entry.type for entry in ros1_entries(values, "")]

    def _on_stop(self, message: Any) -> None:
        self._hardware.halted = bool(message.data)

    def _load(self, path: str, content: Mapping[str, Any]) -> list[ControllerEntry]:
        """Sets a file's parameters in the namespace, as rosparam does; returns its controllers."""
        if is_ros2(content):
            raise of_ros2(Path(path))
        entries = ros1_entries(content, path, self.namespace)
        if not entries and steer_bot.PARAMETERS not in content:
            self.warn(
                devices.CONTROLLERS_FILE_WITHOUT_CONTROLLERS,
                "no parameter specifies a controller type, so no controller starts",
                at=Origin(file=path),
            )
        inner: Any = content
        if entries and (space := entries[0].namespace):
            # A file for the whole parameter server contains the namespace itself.
            for name in space.split("/"):
                inner = next(
                    (value for key, value in inner.items() if str(key).strip("/") == name), inner
                )
        for key, value in _below_root(inner):
            name = f"/{self.namespace}/{key}"
            if not is_name(name):
                # Only the controller of this name fails in ROS, when it is loaded.
                continue
            self.graph.parameters.set(name, _merged(self.graph.parameters.get(name), value))
        return entries

    def _gains(self, joints: list[JointInterfaces]) -> dict[str, tuple[str, PidGains]]:
        """Returns the PID of each joint whose commands a PID converts to efforts."""
        path = "gazebo_ros_control/pid_gains"
        parameters = self.graph.parameters
        listed = parameters.get(f"/{self.namespace}/{path}") or parameters.get(f"/{path}")
        gains: dict[str, tuple[str, PidGains]] = {}
        if not isinstance(listed, Mapping):
            return gains
        for joint in joints:
            values = listed.get(joint.name)
            moves = [kind for kind in joint.commands if kind in ("position", "velocity")]
            if isinstance(values, Mapping) and moves:
                settings = Settings(values, f"{path}/{joint.name}", f"/{self.namespace}")
                gains[joint.name] = (moves[0], read_gains(settings))
        return gains


def _merged(before: Any, value: Any) -> Any:
    """A parameter after a file sets it: mappings are merged at all levels, as roslaunch does."""
    if not isinstance(before, Mapping) or not isinstance(value, Mapping):
        return value
    return {**before, **{key: _merged(before.get(key), each) for key, each in value.items()}}


def _below_root(content: Mapping[str, Any]) -> Iterator[tuple[str, Any]]:
    """Yields names and values of a mapping. The keys ``/`` and "" do not add a level."""
    for key, value in content.items():
        name = str(key).strip("/")
        if name:
            yield name, value
        elif isinstance(value, Mapping):
            yield from _below_root(value)
