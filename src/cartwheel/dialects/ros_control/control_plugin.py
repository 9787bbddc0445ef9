"""The base class of the ros_control and ros2_control plugins."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

from cartwheel.codes import running
from cartwheel.component import Component
from cartwheel.description.model import Sensor
from cartwheel.devices.contact.loads import JointLoad
from cartwheel.devices.drives.rollers import has_rollers
from cartwheel.devices.inertial.unit import InertialUnit
from cartwheel.dialects.plugin import Plugin
from cartwheel.dialects.ros_control.controllers.mecanum import MecanumDriveController
from cartwheel.dialects.ros_control.controllers.omni import OmniWheelDriveController
from cartwheel.dialects.ros_control.files import ControllerEntry, ControllerFiles
from cartwheel.dialects.ros_control.launched.ordering import compete, in_order
from cartwheel.dialects.ros_control.manager import ControllerManager
from cartwheel.dialects.ros_control.robot import ControlledRobot, RobotSensor
from cartwheel.dialects.ros_control.selection import launched
from cartwheel.dialects.sdf.force_torque import read_joint_load
from cartwheel.dialects.sdf.imu import read_inertial_unit
from cartwheel.errors import CartwheelError, PluginError
from cartwheel.simulation.dynamics.external_servos import BodyDriveHandle


class ControlPlugin(Plugin[Any]):
    """Runs a controller manager at a rate."""

    manager: ControllerManager | None = None

    def components(self) -> Iterable[Component]:
        manager = self.manager
        return (*super().components(), *(manager.controllers if manager is not None else ()))

    def structure(self) -> Any:
        return None if self.manager is None else self.manager.structure()

    def rebuild(self, structure: Any) -> None:
        if self.manager is not None:
            self.manager.rebuild(structure)

    def reset(self) -> None:
        if self.manager is not None:
            self.manager.reset()

    def close(self) -> None:
        if self.manager is not None:
            self.manager.close()
        super().close()

    def _run(self, robot: ControlledRobot, rate: float) -> ControllerManager:
        """Creates the controller manager and schedules it.

        Args:
            robot: The robot.
            rate: Control rate, Hz; 0: every step.
        """
        manager = self.manager = ControllerManager(robot)
        part = self.part
        robot.period_ns = part.period_ns(rate)
        part.schedule(rate, before=manager.update)
        step_ns = part.period_ns(0)
        robot.hardware.expect_commands(1.0 / rate if rate > 0 else 0.0)
        if robot.hardware.follows and robot.period_ns > step_ns:
            # As in Gazebo, controllers run at their rate, and PIDs of joints at every step.
            manager.writes = False
            robot.hardware.expect_commands(0.0)
            part.schedule(0, before=manager.write)
        part.schedule(
            rate,
            after=manager.sense,
            active=manager.senses,
            topics=manager.sensed,
        )
        return manager

    def _sensors(self) -> list[RobotSensor]:
        """Returns the robot's sensors that a broadcaster can publish.

        An invalid sensor is reported, and does not stop the controllers.
        """
        found = []
        links = self.part.description.links
        for each in (sensor for link in links for sensor in link.sensors):
            if each.type == "imu" or (each.type == "force_torque" and each.joint):
                try:
                    unit = self._unit(each)
                except PluginError as error:
                    self.part.report(error.diagnostic())
                else:
                    found.append(
                        RobotSensor(name=each.name, type=each.type, sensor=each, unit=unit)
                    )
        return found

    def _unit(self, sensor: Sensor) -> InertialUnit | JointLoad:
        if sensor.joint and sensor.type == "force_torque":
            return JointLoad(self.part, read_joint_load(self.part, sensor, sensor.joint))
        return InertialUnit(self.part, read_inertial_unit(self.part, sensor), origin=sensor.origin)

    def _push(self, types: Iterable[str]) -> BodyDriveHandle | None:
        """Returns a servo of the whole robot if one of the controller types needs it."""
        if has_rollers(self.part.description):
            return None
        pushed = (*MecanumDriveController.types, *OmniWheelDriveController.types)
        if any(name in pushed for name in types):
            return self.part.body_drive(origin=self.tag.origin)
        return None

    def _start(self, entries: Iterable[ControllerEntry]) -> None:
        """Loads and starts controllers. One that cannot be started is reported and skipped."""
        manager = self.manager
        assert manager is not None
        files = self.shared.get(ControllerFiles)
        listed = files.wanted(entries)
        description = self.part.description
        movable = {joint.name for joint in description.joints if joint.type != "fixed"}
        # Reading the launch files takes time, so they are only read if they have to decide.
        active = [entry for entry in listed if entry.name not in files.idle]
        chosen = launched(description) if compete(active, movable) else ()
        for entry in in_order(listed, chosen):
            try:
                files.loaded.append(manager.load_entry(entry))
                if entry.name in files.idle:
                    continue
                manager.switch([entry.name], [], sharing=chosen if manager.robot.ros2 else ())
            except CartwheelError as error:
                self.part.report(
                    running.CONTROLLER_NOT_STARTED.because(
                        f'controller "{entry.name}" is not started',
                        error,
                        origin=self.tag.origin,
                        values={"controller": entry.name},
                    )
                )
