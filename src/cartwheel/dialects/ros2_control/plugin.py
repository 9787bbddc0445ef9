"""``libgazebo_ros2_control.so`` and ``gz_ros2_control-system``: ROS 2 controllers."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Any, ClassVar

from cartwheel.codes import devices, running
from cartwheel.description.model import Element
from cartwheel.devices.joints.pid import PidGains
from cartwheel.dialects.catalogue import short_name
from cartwheel.dialects.ros2_control.components import HardwareComponents
from cartwheel.dialects.ros2_control.contents import without_controllers, without_namespace
from cartwheel.dialects.ros2_control.mistyped import mistyped, mistyped_manager
from cartwheel.dialects.ros2_control.refused_files import refused_file
from cartwheel.dialects.ros2_control.services import Ros2ManagerServices
from cartwheel.dialects.ros2_control.unloaded import unloaded_systems
from cartwheel.dialects.ros2_control.unstarted import without_hardware, without_parameters
from cartwheel.dialects.ros_control.control_plugin import ControlPlugin
from cartwheel.dialects.ros_control.files import (
    ControllerEntry,
    ControllerFiles,
    controller_entries,
    moved_file,
    ros2_file,
    stated_path,
    why_missing,
)
from cartwheel.dialects.ros_control.hardware import Hardware
from cartwheel.dialects.ros_control.interfaces import (
    SYSTEMS,
    JointInterfaces,
    hardware_of,
    no_joints,
    package_system,
    ros2_control,
    simulated_systems,
    unknown_joints,
)
from cartwheel.dialects.ros_control.robot import ControlledRobot
from cartwheel.dialects.ros_control.settings import Settings
from cartwheel.dialects.tags import tag

_GZ_PRIORITIES = ("velocity", "position", "effort")
"""The command that a joint with several commands follows in gz_ros2_control, the first one."""


@dataclass(frozen=True, kw_only=True, slots=True)
class Ros2ControlParameters:
    files: tuple[str, ...] = tag(
        "parameters",
        default=(),
        doc="YAML file with the parameters of the controller manager and its controllers. "
        "Repeat the tag for each file.",
    )
    manager: str = tag(
        "controller_manager_name",
        "controller_manager_node_name",
        default="controller_manager",
        doc="Name of the controller manager's node, and of its section in the YAML files.",
    )
    hold_joints: bool = tag(
        "hold_joints",
        default=True,
        doc="Whether to hold joints that no controller has commanded yet.",
    )
    gain: float = tag(
        "position_proportional_gain",
        default=0.1,
        doc="No effect: position commands are limited only by the joint's effort limit.",
    )
    description: str = tag(
        "robot_param",
        default="robot_description",
        doc="No effect: the description that contains the plugin is used.",
    )
    description_node: str = tag(
        "robot_param_node",
        default="",
        doc="No effect: the description that contains the plugin is used.",
    )


class Ros2Control(ControlPlugin):
    """Runs the ros2_control controllers that its YAML files define.

    The controllers are updated at the ``update_rate`` of the controller manager. The YAML files are
    specified by ``<parameters>`` and by the option ``--controllers`` of ``cartwheel run``. Original
    packages: ``gazebo_ros2_control`` and ``gz_ros2_control``.
    """

    filenames: ClassVar[tuple[str, ...]] = (
        "libgazebo_ros2_control.so",
        "gz_ros2_control-system",
        "ign_ros2_control-system",
    )
    parameters: ClassVar[type] = Ros2ControlParameters
    reads_robot_namespace: ClassVar[bool] = False

    def configure(self) -> None:
        config: Ros2ControlParameters = self.config
        part = self.part
        self.namespace = self.namespace.strip("/")
        if self.tag.element.find("robotNamespace") is not None:
            self.warn_ignored("robotNamespace", "the plugin reads only <ros><namespace>")
        inactive = without_hardware(part.description, self.tag)
        if inactive is not None:
            # Before what is wrong with the files.
            part.report(inactive)
        files = self.shared.get(ControllerFiles)
        own = files.take()
        stated = config.files if without_parameters(self.tag) is None else ()
        named = [self._path(text) for text in stated]
        paths = [*(path for path in named if path is not None), *own]
        contents = [files.read_ros2(path, part.description) for path in paths]
        merged = ros2_file(contents, self.namespace, config.manager)
        source = ", ".join(str(path) for path in paths)
        place = f"{self.namespace}/{config.manager}"
        files_read = [*zip(paths, contents, strict=True)]
        lost = without_controllers(merged, files_read, place, self.tag.origin)
        if lost is None:
            tagged = [content for path, content in files_read if path in named]
            lost = without_namespace(tagged, self.namespace, config.manager, self.tag.origin)
        if lost is not None:
            part.report(lost)
        else:
            for path in paths:
                refused = files.known(
                    part.description, ("refused", path), partial(refused_file, path)
                )
                if refused is not None:
                    part.report(refused)
        settings = Settings(merged.manager, config.manager, source)
        rate = settings.number("update_rate", 100.0)
        if rate <= 0:
            raise settings.invalid("update_rate", rate, "positive")
        joints, sensors, notes = ros2_control(part.description)
        for note in notes:
            part.report(note)
        skipped = {id(system) for system, _ in unloaded_systems(part.description)}
        for system in simulated_systems(part.description):
            self._check_system(system, skipped=id(system) in skipped)
        if not joints and inactive is None:
            self.warn(
                devices.CONTROL_WITHOUT_JOINTS,
                no_joints("<ros2_control>", unknown_joints(notes)),
                values={"joints": unknown_joints(notes)},
            )
        known = {sensor.name for link in part.description.links for sensor in link.sensors}
        for sensor in sensors:
            if sensor.name not in known:
                self.warn(
                    running.UNKNOWN_SENSOR,
                    f'the sensor "{sensor.name}" in <ros2_control> has no matching <sensor> in a '
                    "<gazebo> tag, so nothing is measured",
                    at=sensor.origin,
                    values={"name": sensor.name},
                )
        entries = controller_entries(merged, self.namespace, source)
        for finding in mistyped_manager(config.manager, merged.manager, paths):
            part.report(finding)
        for entry in files.wanted(entries):
            self._report_mistyped(entry, paths)
        # In Gazebo Classic, it sets the velocity of a joint without a motor.
        forced = short_name(self.tag.filename) == "gazebo_ros2_control"
        hardware = Hardware(self, joints, _gains(joints, merged.nodes), forced=forced)
        hardware.holds = config.hold_joints
        robot = ControlledRobot(
            self,
            hardware,
            namespace=self.namespace,
            ros2=True,
            sensors=self._sensors(),
            push=self._push(entry.type for entry in entries),
            priorities=("position", "velocity", "effort") if forced else _GZ_PRIORITIES,
        )
        manager = self._run(robot, rate)
        self._start(entries)
        Ros2ManagerServices(
            self,
            manager,
            name=config.manager,
            entries=entries,
            components=HardwareComponents(simulated_systems(part.description), joints, sensors),
            check=lambda entry, more: self._report_mistyped(entry, [*paths, *more]),
        )

    def _report_mistyped(self, entry: ControllerEntry, paths: Sequence[Path]) -> None:
        """Reports the parameters for which ROS 2 does not start a controller."""
        classic = short_name(self.tag.filename) == "gazebo_ros2_control"
        for finding in mistyped(entry, paths, classic=classic):
            self.part.report(finding)

    def _path(self, text: str) -> Path | None:
        """Returns the file in a ``<parameters>`` tag; None, with a report, if it does not exist."""
        text, origin = text.strip(), self.tag.origin
        path = stated_path(text, origin)
        files = self.shared.get(ControllerFiles)
        if not files.known(self.part.description, ("file", path), path.is_file):
            other, diagnostics = moved_file(text, origin)
            for diagnostic in diagnostics:
                self.part.report(diagnostic)
            if other is not None:
                return other
            written = self.tag.element.find_all("parameters")
            at = next((each.origin for each in written if each.text.strip() == text), origin)
            why, hint = why_missing(text, at)
            self.warn(
                devices.CONTROLLERS_FILE_UNREADABLE,
                f"<parameters>: {why}, so its controllers do not start",
                severity="error",
                at=at,
                hint=hint,
                values={"file": text},
            )
            return None
        return path

    def _check_system(self, system: Element, *, skipped: bool) -> None:
        name = hardware_of(system)
        own = package_system(name)
        if own and name not in SYSTEMS:
            self.warn(
                devices.HARDWARE_UNKNOWN,
                f'<hardware>: the package "{name.partition("/")[0]}" does not contain "{name}", so '
                f"{own} is used; Gazebo would start no controller",
                severity="error",
                at=system.origin,
                values={"hardware": name, "meant": own},
            )
        elif name and name not in SYSTEMS:
            why = "is not loaded in Gazebo, where its joints do not move; here, they"
            self.warn(
                devices.HARDWARE_NOT_SIMULATED,
                f'the hardware "{name}" of <ros2_control name="{system.attribute("name") or ""}"> '
                f"{why if skipped else 'is not simulated, so its joints'} are driven as with "
                f"{SYSTEMS[0]}",
                at=system.origin,
                values={"hardware": name},
            )


def _gains(
    joints: list[JointInterfaces], nodes: Mapping[str, Mapping[str, Any]]
) -> dict[str, tuple[str, PidGains]]:
    """Returns the PID of each joint whose commands a PID converts to efforts.

    The gains are in the joint's ``<param>`` tags, or in the files under ``pid_gains``. Source:
    gazebo_ros2_control.

    Raises:
        PluginError: A gain is not a number.
    """
    gains = {}
    for joint in joints:
        if not joint.by_pid:
            continue
        prefix = f"{joint.by_pid[:3]}_"
        written: Mapping[str, Any] = {
            key.removeprefix(prefix): value
            for key, value in joint.gains.items()
            if key.startswith(prefix)
        }
        for name, values in nodes.items():
            listed = Settings(values, name).section(f"pid_gains/{joint.by_pid}/{joint.name}")
            if not written and listed.names():
                written = {key: listed.raw(key) for key in listed.names()}
        settings = Settings(written, f"gains of {joint.name}")
        most = settings.number("max_integral_error", math.inf)
        gains[joint.name] = (
            joint.by_pid,
            PidGains(
                p=settings.number("kp", 0.0),
                i=settings.number("ki", 0.0),
                d=settings.number("kd", 0.0),
                i_min=settings.number("min_integral_error", -most),
                i_max=most,
            ),
        )
    return gains
