"""``joint_trajectory_controller``: moves joints along trajectories from a topic or an action."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, ClassVar, Literal

import numpy as np

from cartwheel.codes import devices, running
from cartwheel.devices.joints.pid import PidGains
from cartwheel.devices.joints.trajectory_follower import (
    FollowerConfig,
    Tracking,
    TrajectoryFollower,
)
from cartwheel.devices.joints.trajectory_goals import (
    TrajectoryGoals,
    TrajectoryGoalsConfig,
    tracking_points,
    trajectory_point,
)
from cartwheel.devices.joints.trajectory_reading import (
    InvalidTrajectoryError,
    TrajectoryReader,
    TrajectoryRules,
)
from cartwheel.devices.joints.trajectory_tolerances import Tolerance, Tolerances
from cartwheel.devices.periodic import Periodic
from cartwheel.dialects.ros_control.controller import Controller
from cartwheel.dialects.ros_control.gains import GAINS, read_gains, read_ros2_gains
from cartwheel.dialects.ros_control.hardware import JointHardware
from cartwheel.dialects.ros_control.parameters import OWN, ignored, parameter
from cartwheel.dialects.ros_control.settings import Settings
from cartwheel.messages import header, message_class, nanoseconds, zero
from cartwheel.messages.store import TWIN
from cartwheel.simulation.clock import NANOSECONDS

Interface = Literal["position", "velocity", "effort"]
_TRAJECTORY = "trajectory_msgs/msg/JointTrajectory"
_INTERFACES: tuple[Interface, ...] = ("position", "velocity", "effort")


@dataclass(frozen=True, kw_only=True, slots=True)
class TrajectoryParameters:
    joints: tuple[str, ...] = parameter("joints", doc="Joints of the trajectories.")
    commanded: tuple[str, ...] = parameter(
        "command_joints",
        "joints",
        default=(),
        role="joint",
        interface=OWN,
        doc="Joints that are commanded. Default: `joints`.",
    )
    interfaces: tuple[str, ...] = parameter(
        "command_interfaces",
        default=("position",),
        role="interface",
        doc="Interface of the commands, for types whose name contains none.",
    )
    gains: None = ignored("gains/{joint}", role="gains", doc=GAINS)
    feedforward: None = ignored(
        "velocity_ff/{joint}",
        doc="Output per desired velocity. In ROS 2 also `ff_velocity_scale` among the gains.",
    )
    goal_time: None = ignored(
        "constraints/goal_time",
        doc="Time by which a goal may be late, s. Default: 0.",
    )
    stopped: None = ignored(
        "constraints/stopped_velocity_tolerance",
        doc="Maximum velocity at the goal, rad/s or m/s. Default: 0.01.",
    )
    tolerances: None = ignored(
        "constraints/{joint}/trajectory",
        "constraints/{joint}/goal",
        doc="Position tolerance on the path and at the goal, rad or m; 0 is not checked.",
    )
    state_rate: float = parameter(
        "state_publish_rate", default=50.0, unit="Hz", doc="Publish rate of the state."
    )
    monitor_rate: float = parameter(
        "action_monitor_rate", default=20.0, unit="Hz", doc="Rate of the feedback."
    )
    allow_partial: bool = parameter(
        "allow_partial_joints_goal", default=False, doc="Trajectories may omit joints."
    )
    allow_integration: bool = parameter(
        "allow_integration_in_goal_trajectories",
        default=False,
        doc="Trajectories may contain velocities without positions.",
    )
    allow_moving_end: bool = parameter(
        "allow_nonzero_velocity_at_trajectory_end",
        default=False,
        doc="Trajectories may end with a velocity; only checked in ROS 2.",
    )
    unused: None = ignored(
        "state_interfaces", "stop_trajectory_duration", "hold_trajectory_duration", "verbose",
        "open_loop_control", "interpolate_from_desired_state",
        "set_last_command_interface_value_as_state_on_activation",
    )  # fmt: skip


class JointTrajectoryController(Controller):
    """Follows trajectories, and holds the last position.

    ROS 1 uses the topic ``command``, ROS 2 ``joint_trajectory``. Both offer the action
    ``follow_joint_trajectory``. A goal succeeds when the time of the last point has passed and all
    joints are within their goal tolerances. It is aborted, and the joints are held, if they are not
    within these tolerances after another ``goal_time``, or if one leaves its path tolerance. The
    scaled controllers of UR and Pilz always run at full speed. Source: joint_trajectory_controller.
    """

    types: ClassVar[tuple[str, ...]] = (
        "position_controllers/JointTrajectoryController",
        "velocity_controllers/JointTrajectoryController",
        "effort_controllers/JointTrajectoryController",
        "pos_vel_controllers/JointTrajectoryController",
        "pos_vel_acc_controllers/JointTrajectoryController",
        "joint_trajectory_controller/JointTrajectoryController",
        "position_controllers/ScaledJointTrajectoryController",
        "velocity_controllers/ScaledJointTrajectoryController",
        "ur_controllers/ScaledJointTrajectoryController",
        "position_controllers/PilzJointTrajectoryController",
    )

    parameters = TrajectoryParameters

    def configure(self, given: TrajectoryParameters) -> None:
        ros2, settings = self.robot.ros2, self.settings
        self._names = list(given.joints)
        if not self._names:
            raise settings.invalid("joints", self._names, "a list of at least one joint")
        self._interface = self._read_interface(given)
        listed = given.interfaces if self.type.startswith("joint_") else ()
        self._listed = frozenset(listed)
        self._joints: list[JointHardware] = [
            self.claim(name, self._interface) for name in given.commanded
        ]
        for name in given.commanded:
            for each in listed:
                # It commands all of them, also those that do not change how the joints move here.
                self.robot.hardware.joint(name, each)
        gains: list[PidGains] = []
        feedforward: list[float] = []
        if self._interface != "position":
            gains, feedforward = self._read_gains(settings)
        else:
            settings.ignore("gains", "velocity_ff")
        settings.ignore("constraints")
        tolerances = _tolerances(settings.section("constraints"), self._names)
        self._reader = TrajectoryReader(self._names, self._joints, _rules(given, ros2=ros2))
        self._periodic = Periodic(given.state_rate)
        self._follower = TrajectoryFollower(
            self._joints,
            FollowerConfig(
                interface=self._interface, gains=tuple(gains), feedforward=tuple(feedforward)
            ),
        )
        topic = "joint_trajectory" if ros2 else "command"
        self.subscribe(topic, _TRAJECTORY, self._on_trajectory)
        self.accept_positions(
            lambda wanted, seconds: self.publish_command(
                topic, _TRAJECTORY, **self._trajectory_to(wanted, seconds)
            )
        )
        self._goals = self.add(
            TrajectoryGoals(
                self.scope,
                TrajectoryGoalsConfig(
                    tolerances=tolerances,
                    monitor_rate=given.monitor_rate,
                    # In ROS 2, only clients cancel goals.
                    preempted="abort" if ros2 else "cancel",
                    waits_without_goal_time=ros2,
                ),
                follower=self._follower,
                reader=self._reader,
                joints=self._joints,
                running=self.accepts_goals,
                started=lambda: self.started,
            )
        )
        self._state = self.advertise(
            "controller_state" if ros2 else "state",
            f"control_msgs{TWIN if ros2 else ''}/msg/JointTrajectoryControllerState",
            rate=given.state_rate or None,
        )
        if not ros2:
            self.serve("query_state", "control_msgs/srv/QueryTrajectoryState", self._on_query)

    def accepts_goals(self) -> bool:
        """Called for a new goal: whether it is accepted."""
        return self.running

    def start(self, time_ns: int) -> None:
        self._follower.start(time_ns)
        self._periodic.start(time_ns)
        self._goals.start(time_ns)

    def interrupt(self) -> None:
        self._goals.interrupt()

    def update(self, time_ns: int, seconds: float) -> None:
        tracking = self._follower.update(time_ns, seconds)
        self._goals.watch(time_ns, tracking)
        self._goals.tick(time_ns)
        due = self._periodic.due(time_ns)
        if due and self._state.wanted:
            self._publish_state(time_ns, tracking)

    def idle(self, time_ns: int) -> None:
        self._goals.tick(time_ns)

    def stop(self, time_ns: int) -> None:
        self._follower.hold(time_ns)
        self._goals.stop()

    # -- parameters

    def required(self, joint: str) -> frozenset[str]:
        return super().required(joint) | self._listed

    def _read_interface(self, given: TrajectoryParameters) -> Interface:
        prefix = self.type.partition("_")[0]
        if prefix == "pos":
            return "position"
        wanted = [prefix] if prefix in _INTERFACES else list(given.interfaces)
        for interface in _INTERFACES:
            if interface in wanted:
                return interface
        raise self.settings.invalid(
            "command_interfaces", wanted, "a list of position, velocity or effort"
        )

    def _read_gains(self, settings: Settings) -> tuple[list[PidGains], list[float]]:
        """Returns the gains and the feedforward factor of each joint."""
        gains, feedforward = [], []
        for name in self._names:
            section = settings.section(f"gains/{name}")
            forward = 0.0
            if self.robot.ros2:
                forward = section.number("ff_velocity_scale", 0.0)
                gains.append(read_ros2_gains(section))
            elif section.has("p"):
                gains.append(read_gains(section))
            elif self._interface == "effort":
                raise settings.error(
                    devices.CONTROLLER_GAINS_MISSING,
                    f'the parameter "gains/{name}/p" is missing',
                    values={"parameter": f"gains/{name}/p", "joint": name},
                )
            else:
                gains.append(PidGains(p=0.0))
            feedforward.append(settings.number(f"velocity_ff/{name}", forward))
        return gains, feedforward

    # -- topics and services

    def _on_trajectory(self, message: Any) -> None:
        time_ns = self.part.time_ns
        if not message.points:
            self._goals.preempt("stopped by an empty trajectory")
            self._follower.hold(time_ns)
            return
        try:
            trajectory = self._reader.read(message, time_ns, self._follower.current)
        except InvalidTrajectoryError as error:
            self.warn(
                running.TRAJECTORY_INVALID,
                f"a trajectory is ignored: {error.message}",
                values=error.values,
            )
            return
        self._goals.preempt("replaced by a new trajectory")
        self._follower.follow(trajectory, time_ns)

    def _trajectory_to(self, wanted: Mapping[str, float], seconds: float) -> dict[str, object]:
        """Returns the fields of a trajectory that ends at the wanted positions, at rest."""
        values = np.array([wanted[joint.joint] for joint in self._joints])
        whole, rest = divmod(round(seconds * NANOSECONDS), NANOSECONDS)
        point = zero("trajectory_msgs/msg/JointTrajectoryPoint")
        point.positions, point.velocities = values, np.zeros(len(values))
        point.time_from_start.sec, point.time_from_start.nanosec = whole, rest
        return {"header": header(0, ""), "joint_names": list(self._names), "points": [point]}

    def _publish_state(self, time_ns: int, tracking: Tracking) -> None:
        desired, actual, error = tracking_points(self._joints, tracking)
        fields = {"header": header(time_ns, ""), "joint_names": self._names, "error": error}
        if not self.robot.ros2:
            kind = message_class("control_msgs/msg/JointTrajectoryControllerState")
            self._state.publish(kind(desired=desired, actual=actual, **fields))
            return
        message = zero("control_msgs_ros2/msg/JointTrajectoryControllerState")
        for name, value in {
            **fields,
            "reference": desired,
            "feedback": actual,
            "output": self._output(),
            "speed_scaling_factor": 1.0,
        }.items():
            setattr(message, name, value)
        self._state.publish(message)

    def _output(self) -> Any:
        """Returns the commands of the joints."""
        if self._interface == "effort":
            return trajectory_point(effort=[joint.effort for joint in self._joints])
        commands = [joint.command for joint in self._joints]
        if self._interface == "velocity":
            return trajectory_point(velocities=commands)
        return trajectory_point(commands)

    def _on_query(self, request: Any) -> Any:
        state = self._follower.at(nanoseconds(request.time))
        return message_class("control_msgs/srv/QueryTrajectoryState_Response")(
            name=self._names,
            position=np.array(state.position),
            velocity=np.array(state.velocity),
            acceleration=np.array(state.acceleration),
        )


def _rules(given: TrajectoryParameters, *, ros2: bool) -> TrajectoryRules:
    return TrajectoryRules(
        partial=given.allow_partial,
        integrates=given.allow_integration,
        must_stop=ros2 and not given.allow_moving_end,
    )


def _tolerances(constraints: Settings, names: list[str]) -> Tolerances:
    """Reads the parameters ``constraints``. Source: joint_trajectory_controller."""
    stopped = constraints.number("stopped_velocity_tolerance", 0.01)
    return Tolerances(
        names=tuple(names),
        goal_time=constraints.number("goal_time", 0.0),
        path=tuple(
            Tolerance(position=constraints.number(f"{name}/trajectory", 0.0)) for name in names
        ),
        goal=tuple(
            Tolerance(position=constraints.number(f"{name}/goal", 0.0), velocity=stopped)
            for name in names
        ),
    )
