"""``joint_trajectory_controller``: moves joints along trajectories from a topic or an action."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import Any, ClassVar

import numpy as np

from cartwheel.codes import devices, running
from cartwheel.devices.joints.pid import DampedEffort, Pid, PidGains
from cartwheel.devices.joints.trajectory import State, Trajectory
from cartwheel.devices.periodic import Periodic
from cartwheel.dialects.ros_control.controller import Controller
from cartwheel.dialects.ros_control.controllers.action import ActionServer
from cartwheel.dialects.ros_control.controllers.trajectory_reading import (
    GOAL,
    INVALID_GOAL,
    PATH,
    SUCCESSFUL,
    InvalidTrajectoryError,
    TrajectoryReader,
)
from cartwheel.dialects.ros_control.controllers.trajectory_tolerances import Tolerances
from cartwheel.dialects.ros_control.gains import read_gains, read_ros2_gains
from cartwheel.dialects.ros_control.hardware import JointHardware
from cartwheel.dialects.ros_control.settings import Settings
from cartwheel.graph import Goal
from cartwheel.messages import header, message_class, zero
from cartwheel.messages.store import TWIN
from cartwheel.simulation.clock import NANOSECONDS

_TRAJECTORY = "trajectory_msgs/msg/JointTrajectory"
_SETTLING_NS = 300_000_000
"""Time that joints have to come to rest after the last point before a goal counts as missed, ns."""


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

    def configure(self, settings: Settings) -> None:
        ros2 = self.robot.ros2
        self._names = settings.texts("joints")
        if not self._names:
            raise settings.invalid("joints", self._names, "a list of at least one joint")
        self._interface = self._take_interface(settings)
        commanded = settings.texts("command_joints", []) or self._names
        self._joints: list[JointHardware] = [
            self.claim(name, self._interface) for name in commanded
        ]
        self._pids: list[Pid] = []
        self._forward = [0.0] * len(self._joints)
        if self._interface != "position":
            self._read_gains(settings)
        else:
            settings.ignore("gains", "velocity_ff")
        settings.ignore("constraints", "state_interfaces", "command_interfaces")
        self._tolerances = Tolerances(settings.section("constraints"), self._names)
        self._goal_time = self._tolerances.goal_time
        self._reader = TrajectoryReader(self._names, self._joints, settings, ros2=ros2)
        rate = settings.number("state_publish_rate", 50.0)
        self._periodic = Periodic(rate)
        self._monitor = Periodic(settings.number("action_monitor_rate", 20.0))
        settings.ignore(
            "stop_trajectory_duration", "hold_trajectory_duration", "verbose",
            "open_loop_control", "interpolate_from_desired_state",
            "set_last_command_interface_value_as_state_on_activation",
        )  # fmt: skip
        topic = "joint_trajectory" if ros2 else "command"
        self.subscribe(topic, _TRAJECTORY, self._on_trajectory)
        self.accept_positions(
            lambda wanted, seconds: self.publish_command(
                topic, _TRAJECTORY, **self._way(wanted, seconds)
            )
        )
        self._action = ActionServer(
            self,
            "follow_joint_trajectory",
            "FollowJointTrajectory",
            on_goal=self._on_goal,
            on_cancel=self._on_cancel,
        )
        self._state = self.advertise(
            "controller_state" if ros2 else "state",
            f"control_msgs{TWIN if ros2 else ''}/msg/JointTrajectoryControllerState",
            rate=rate or None,
        )
        if not ros2:
            self.serve("query_state", "control_msgs/srv/QueryTrajectoryState", self._on_query)
        self._following = Trajectory.hold(0, [0.0] * len(self._joints))
        self._next: Trajectory | None = None
        self._active: Goal | None = None
        self._goal_path, self._goal_end = self._tolerances.path, self._tolerances.goal
        self._goal_patience = self._goal_time

    def start(self, time_ns: int) -> None:
        self._hold(time_ns)
        for pid in self._pids:
            pid.reset()
        self._periodic.start(time_ns)
        self._monitor.start(time_ns)
        self._action.start(time_ns)
        self._finish("abort", INVALID_GOAL, "the controller was restarted")

    def update(self, time_ns: int, seconds: float) -> None:
        if self._next is not None and time_ns >= self._next.start_ns:
            self._following, self._next = self._next, None
        wanted = self._following.at(time_ns)
        errors = [self._error(index, wanted) for index in range(len(self._joints))]
        self._command(wanted, errors, seconds)
        if self._active is not None:
            self._watch(time_ns, wanted, errors)
        self._action.tick(time_ns)
        due = self._periodic.due(time_ns)
        if due and self._state.wanted:
            self._publish_state(time_ns, wanted, errors)

    def idle(self, time_ns: int) -> None:
        self._action.tick(time_ns)

    def stop(self, time_ns: int) -> None:
        self._hold(time_ns)
        how = "abort" if self.robot.ros2 else "cancel"
        self._finish(how, INVALID_GOAL, "the controller was stopped")

    # -- joint commands

    def _take_interface(self, settings: Settings) -> str:
        kind = self.type.partition("_")[0]
        if kind in ("position", "velocity", "effort"):
            return kind
        if kind == "pos":
            return "position"
        wanted = settings.texts("command_interfaces", ["position"])
        for interface in ("position", "velocity", "effort"):
            if interface in wanted:
                return interface
        raise settings.invalid(
            "command_interfaces", wanted, "a list of position, velocity or effort"
        )

    def _read_gains(self, settings: Settings) -> None:
        for index, name in enumerate(self._names):
            section = settings.section(f"gains/{name}")
            forward = 0.0
            if self.robot.ros2:
                forward = section.number("ff_velocity_scale", 0.0)
                gains = read_ros2_gains(section)
            elif section.has("p"):
                gains = read_gains(section)
            elif self._interface == "effort":
                raise settings.error(
                    devices.CONTROLLER_GAINS_MISSING,
                    f'the parameter "gains/{name}/p" is missing',
                    values={"parameter": f"gains/{name}/p", "joint": name},
                )
            else:
                gains = PidGains(p=0.0)
            self._forward[index] = settings.number(f"velocity_ff/{name}", forward)
            self._pids.append(Pid(gains))

    def _error(self, index: int, wanted: State) -> tuple[float, float]:
        joint = self._joints[index]
        return joint.error(wanted.position[index]), wanted.velocity[index] - joint.velocity

    def _command(self, wanted: State, errors: list[tuple[float, float]], seconds: float) -> None:
        for index, joint in enumerate(self._joints):
            position, velocity = wanted.position[index], wanted.velocity[index]
            if self._interface == "position":
                joint.command, joint.rate = position, velocity
                continue
            law = self._pids[index].position(
                errors[index][0],
                seconds,
                target=position,
                rate=velocity,
                lightness=joint.lightness if self._interface == "effort" else 0.0,
            )
            law = self._pids[index].limited(law, joint.velocity)
            forward = self._forward[index] * velocity
            if self._interface == "effort":
                joint.set_effort(DampedEffort(law.effort + forward, law.damping))
            else:
                joint.command = law.at(joint.velocity) + forward

    def _hold(self, time_ns: int) -> None:
        """Holds the current position."""
        self._next = None
        self._following = Trajectory.hold(time_ns, [joint.position for joint in self._joints])

    def _way(self, wanted: Mapping[str, float], seconds: float) -> dict[str, object]:
        """Returns the fields of a trajectory that ends at the wanted positions, at rest."""
        values = np.array([wanted[joint.joint] for joint in self._joints])
        whole, rest = divmod(round(seconds * NANOSECONDS), NANOSECONDS)
        point = zero("trajectory_msgs/msg/JointTrajectoryPoint")
        point.positions, point.velocities = values, np.zeros(len(values))
        point.time_from_start.sec, point.time_from_start.nanosec = whole, rest
        return {"header": header(0, ""), "joint_names": list(self._names), "points": [point]}

    # -- the command topic

    def _on_trajectory(self, message: Any) -> None:
        time_ns = self.part.time_ns
        if not message.points:
            self._preempt("stopped by an empty trajectory")
            self._hold(time_ns)
            return
        try:
            trajectory = self._reader.read(message, time_ns, self._following)
        except InvalidTrajectoryError as error:
            self.warn(
                running.TRAJECTORY_INVALID,
                f"a trajectory is ignored: {error.message}",
                values=error.values,
            )
            return
        self._preempt("replaced by a new trajectory")
        self._follow(trajectory, time_ns)

    def _follow(self, trajectory: Trajectory, time_ns: int) -> None:
        if trajectory.start_ns > time_ns:
            self._next = trajectory
        else:
            self._following, self._next = trajectory, None

    # -- the action

    def _on_goal(self, goal: Goal) -> None:
        time_ns = self.part.time_ns
        if not self.running:
            goal.reject(
                self._result(INVALID_GOAL, "the controller is not running"),
                "the controller is not running",
            )
            return
        try:
            if goal.goal.multi_dof_trajectory.points:
                raise InvalidTrajectoryError(
                    INVALID_GOAL, "joints with several degrees of freedom are not supported"
                )
            if not goal.goal.trajectory.points:
                raise InvalidTrajectoryError(INVALID_GOAL, "the trajectory has no points")
            trajectory = self._reader.read(goal.goal.trajectory, time_ns, self._following)
            paths, ends = self._tolerances.of(goal.goal)
        except InvalidTrajectoryError as error:
            goal.reject(self._result(error.result, error.message), error.message)
            return
        self._preempt("replaced by a new goal")
        self._goal_path, self._goal_end = paths, ends
        span = goal.goal.goal_time_tolerance
        patience = span.sec + span.nanosec / 1e9
        self._goal_patience = patience if patience > 0 else self._goal_time
        if patience < 0:
            self._goal_patience = math.inf
        self._active = goal
        goal.accept()
        self._follow(trajectory, time_ns)

    def _on_cancel(self, goal: Goal) -> None:
        if goal is self._active:
            self._finish("cancel", SUCCESSFUL, "cancelled")
            self._hold(self.part.time_ns)
        else:
            goal.cancel(self._result(SUCCESSFUL, ""), "cancelled")

    def _watch(self, time_ns: int, wanted: State, errors: list[tuple[float, float]]) -> None:
        """Finishes the goal when it is reached or missed, and sends feedback."""
        goal = self._active
        assert goal is not None
        if self._monitor.due(time_ns) and self._action.wants_feedback:
            self._send_feedback(goal, time_ns, wanted, errors)
        followed = self._next or self._following
        if time_ns < followed.end_ns:
            if self._next is not None:
                return
            for name, tolerance, error in zip(self._names, self._goal_path, errors, strict=True):
                if tolerance.violated(*error):
                    text = f'joint "{name}" has {tolerance.excess(*error)} on the path'
                    self._finish("abort", PATH, text)
                    self._hold(time_ns)
                    return
            return
        off = [
            f'joint "{name}" has {tolerance.excess(*error)} at the goal'
            for name, tolerance, error in zip(self._names, self._goal_end, errors, strict=True)
            if tolerance.violated(*error)
        ]
        if not off:
            self._finish("succeed", SUCCESSFUL, "")
            return
        endless = self.robot.ros2 and self._goal_patience == 0
        late_ns = followed.end_ns + _SETTLING_NS + round(min(self._goal_patience, 1e9) * 1e9)
        if not endless and time_ns > late_ns:
            self._finish("abort", GOAL, off[0])
            self._hold(time_ns)

    def _preempt(self, text: str) -> None:
        """Cancels a replaced goal, or aborts it in ROS 2, where only clients cancel goals."""
        if self.robot.ros2:
            self._finish("abort", INVALID_GOAL, text)
        else:
            self._finish("cancel", SUCCESSFUL, text)

    def _finish(self, how: str, code: int, text: str) -> None:
        goal, self._active = self._active, None
        if goal is not None:
            getattr(goal, how)(self._result(code, text), text)

    def _result(self, code: int, text: str) -> Any:
        return self._action.message("Result", error_code=code, error_string=text)

    # -- published state and feedback

    def _publish_state(
        self, time_ns: int, wanted: State, errors: list[tuple[float, float]]
    ) -> None:
        desired, actual, error = self._points(wanted, errors)
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
            return _point(effort=[joint.effort for joint in self._joints])
        commands = [joint.command for joint in self._joints]
        if self._interface == "velocity":
            return _point(velocities=commands)
        return _point(commands)

    def _send_feedback(
        self, goal: Goal, time_ns: int, wanted: State, errors: list[tuple[float, float]]
    ) -> None:
        message = zero("control_msgs_ros2/action/FollowJointTrajectory_Feedback")
        message.header, message.joint_names = header(time_ns, ""), self._names
        message.desired, message.actual, message.error = self._points(wanted, errors)
        goal.feedback(message)

    def _points(self, wanted: State, errors: list[tuple[float, float]]) -> tuple[Any, Any, Any]:
        """Returns the desired state, the actual state, and the error."""
        joints = self._joints
        return (
            _point(wanted.position, wanted.velocity, wanted.acceleration),
            _point([j.position for j in joints], [j.velocity for j in joints]),
            _point([error[0] for error in errors], [error[1] for error in errors]),
        )

    def _on_query(self, request: Any) -> Any:
        moment = request.time
        time_ns = moment.sec * 1_000_000_000 + moment.nanosec
        followed = self._following
        if self._next is not None and time_ns >= self._next.start_ns:
            followed = self._next
        state = followed.at(time_ns)
        return message_class("control_msgs/srv/QueryTrajectoryState_Response")(
            name=self._names,
            position=np.array(state.position),
            velocity=np.array(state.velocity),
            acceleration=np.array(state.acceleration),
        )


def _point(
    positions: Sequence[float] = (),
    velocities: Sequence[float] = (),
    accelerations: Sequence[float] = (),
    effort: Sequence[float] = (),
) -> Any:
    return message_class("trajectory_msgs/msg/JointTrajectoryPoint")(
        positions=np.array(positions, dtype=float),
        velocities=np.array(velocities, dtype=float),
        accelerations=np.array(accelerations, dtype=float),
        effort=np.array(effort, dtype=float),
        time_from_start=message_class("builtin_interfaces/msg/Duration")(0, 0),
    )
