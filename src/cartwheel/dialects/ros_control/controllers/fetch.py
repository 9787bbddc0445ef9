"""Controllers of the package ``robot_controllers``, which Fetch and Freight use."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

from cartwheel.devices.joints.gripper import Gripper, GripperConfig
from cartwheel.devices.joints.pid import DampedEffort
from cartwheel.dialects.ros_control.controller import Controller
from cartwheel.dialects.ros_control.controllers.joint_trajectory import (
    JointTrajectoryController,
    TrajectoryParameters,
)
from cartwheel.dialects.ros_control.hardware import JointHardware
from cartwheel.dialects.ros_control.parameters import ignored, parameter


@dataclass(frozen=True, kw_only=True, slots=True)
class FetchTrajectoryParameters(TrajectoryParameters):
    switching: None = ignored("autostart", "stop_with_action", "stop_on_path_violation")


class FetchTrajectoryController(JointTrajectoryController):
    """Follows trajectories, and starts itself for a goal.

    Other controllers that command one of its joints are then stopped. Otherwise it works like
    ``position_controllers/JointTrajectoryController``. Source: robot_controllers.
    """

    types: ClassVar[tuple[str, ...]] = ("robot_controllers/FollowJointTrajectoryController",)

    parameters = FetchTrajectoryParameters

    def accepts_goals(self) -> bool:
        """Starts the controller, so that each goal is accepted."""
        if not self.running:
            self.robot.take_over(self.name)
        return self.running


@dataclass(frozen=True, kw_only=True, slots=True)
class FetchGripperParameters:
    left: str = parameter(
        "l_gripper_joint",
        default="l_gripper_finger_joint",
        role="joint",
        interface="position",
        doc="Joint of the left finger.",
    )
    right: str = parameter(
        "r_gripper_joint",
        default="r_gripper_finger_joint",
        role="joint",
        interface="position",
        doc="Joint of the right finger.",
    )
    max_effort: float = parameter(
        "max_effort",
        default=60.0,
        unit="N",
        doc="Maximum effort of goals without an effort.",
    )
    centering: None = ignored(
        "centering", "max_position", "autostart", doc="No effect: both fingers move symmetrically."
    )


class FetchGripperController(Controller):
    """Moves two fingers symmetrically by the action ``GripperCommand``.

    The position in a goal is the distance between the fingers in m. The name of the action is
    ``gripper_action``. Source: robot_controllers.
    """

    types: ClassVar[tuple[str, ...]] = ("robot_controllers/ParallelGripperController",)

    parameters: ClassVar[type] = FetchGripperParameters

    def configure(self, given: FetchGripperParameters) -> None:
        fingers = [self.claim(name, "position") for name in (given.left, given.right)]
        self._gripper = self.add(
            Gripper(
                self.scope,
                GripperConfig(
                    action="GripperCommand",
                    action_name="gripper_action",
                    tolerance=0.002,
                    max_effort=given.max_effort,
                    stall_velocity=0.001,
                    stall_timeout=1.0,
                    # As in robot_controllers: a grasped object stalls the fingers.
                    allow_stalling=True,
                    monitor_rate=20.0,
                    preempted="cancel",
                ),
                joint=_Fingers(*fingers),
                name=given.left,
                running=lambda: self.running,
            )
        )

    def start(self, time_ns: int) -> None:
        self._gripper.start(time_ns)

    def interrupt(self) -> None:
        self._gripper.interrupt()

    def update(self, time_ns: int, seconds: float) -> None:
        self._gripper.update(time_ns, seconds)

    def idle(self, time_ns: int) -> None:
        self._gripper.tick(time_ns)

    def stop(self, time_ns: int) -> None:  # noqa: ARG002
        self._gripper.stop()


class _Fingers:
    """The distance between two fingers, each of which moves by half of it."""

    def __init__(self, left: JointHardware, right: JointHardware) -> None:
        self._fingers = (left, right)

    @property
    def lightness(self) -> float:
        """Acceleration of the distance per effort of each finger, 1/kg."""
        return sum(each.lightness for each in self._fingers)

    @property
    def joint(self) -> str:
        """Name of the left finger's joint."""
        return self._fingers[0].joint

    @property
    def position(self) -> float:
        """Distance, m."""
        return sum(each.position for each in self._fingers)

    @property
    def velocity(self) -> float:
        """Rate of change of the distance, m/s."""
        return sum(each.velocity for each in self._fingers)

    @property
    def effort(self) -> float:
        """Mean of the efforts, N."""
        return sum(each.effort for each in self._fingers) / 2

    @property
    def command(self) -> float:
        """Commanded distance, m."""
        return sum(each.command for each in self._fingers)

    @command.setter
    def command(self, distance: float) -> None:
        for each in self._fingers:
            each.command = distance / 2

    @property
    def strength(self) -> float:
        """Maximum effort of each finger, N."""
        return self._fingers[0].strength

    @strength.setter
    def strength(self, effort: float) -> None:
        for each in self._fingers:
            each.strength = effort

    def set_effort(self, effort: DampedEffort) -> None:
        """Commands an effort of each finger."""
        for each in self._fingers:
            each.set_effort(effort)
