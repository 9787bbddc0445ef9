"""Joints that are set to the positions of a trajectory, without simulated forces."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from cartwheel.codes import running
from cartwheel.component import Component, Scope
from cartwheel.devices.joints.trajectory import next_point
from cartwheel.messages import message_class, nanoseconds
from cartwheel.simulation.handles import JointHandle


@dataclass(frozen=True, kw_only=True, slots=True)
class PoseTrajectoryConfig:
    topic: str
    """Topic of the trajectories (JointTrajectory)."""
    service: str
    """Name of the service (SetJointTrajectory)."""
    rate: float = 0.0
    """Rate at which points are applied, Hz; 0: every step."""


class PoseTrajectory(Component):
    """Sets the positions of all movable joints to the points of a trajectory.

    The trajectory starts at its header stamp or on arrival, whichever is later. Each point is
    applied after its ``time_from_start``. The root link is not moved, so ``header.frame_id`` must
    be empty, the root link, ``world`` or ``map``.
    """

    def __init__(self, scope: Scope, config: PoseTrajectoryConfig) -> None:
        super().__init__(scope)
        self._handles: dict[str, JointHandle] = {
            joint.name: self.part.joint(joint.name)
            for joint in self.part.description.joints
            if joint.drivable
        }
        self.reset()
        self._Response = message_class("gazebo_msgs/srv/SetJointTrajectory_Response")
        self.subscribe(config.topic, "trajectory_msgs/msg/JointTrajectory", self._on_trajectory)
        self.serve(config.service, "gazebo_msgs/srv/SetJointTrajectory", self._on_request)
        self.part.schedule(config.rate, before=self._follow, active=lambda: bool(self._points))

    def reset(self) -> None:
        self._joints: list[JointHandle] = []
        self._points: list[list[float]] = []
        self._times: list[int] = []
        self._index = 0

    def _on_trajectory(self, trajectory: Any) -> None:
        problem = self._replace(trajectory)
        if problem:
            self.warn(running.TRAJECTORY_INVALID, f"a trajectory is ignored: {problem}")

    def _on_request(self, request: Any) -> Any:
        problem = self._replace(request.joint_trajectory)
        if not problem and request.model_name not in ("", self.part.name):
            problem = (
                f'the trajectory is for model "{request.model_name}", not for "{self.part.name}"'
            )
        if not problem and request.set_model_pose:
            problem = "set_model_pose is not supported: use /gazebo/set_model_state"
        if problem:
            self.reset()
        return self._Response(success=not problem, status_message=problem)

    def _replace(self, trajectory: Any) -> str:
        """Replaces the trajectory. Returns an error message, or "" if the trajectory is valid."""
        names = list(trajectory.joint_names)
        unknown = [name for name in names if name not in self._handles]
        if unknown:
            return f'there is no movable joint "{unknown[0]}"'
        root = self.part.description.canonical_link
        frame = trajectory.header.frame_id.rsplit("::", 1)[-1].lstrip("/")
        if frame not in ("", "world", "map", root):
            return f'header.frame_id must be "{root}", "world", "map" or empty (got "{frame}")'
        start = max(self.part.time_ns, nanoseconds(trajectory.header.stamp))
        points = []
        for point in trajectory.points:
            if len(point.positions) != len(names):
                return f"a point has {len(point.positions)} positions for {len(names)} joints"
            time = start + nanoseconds(point.time_from_start)
            points.append((time, [float(position) for position in point.positions]))
        points.sort(key=lambda point: point[0])
        self._joints = [self._handles[name] for name in names]
        self._times = [time for time, _ in points]
        self._points = [positions for _, positions in points]
        self._index = 0
        return ""

    def _follow(self) -> None:
        # A point is applied at its time, not after it.
        index = next_point(self._times, self._index, self.part.time_ns + 1)
        for positions in self._points[self._index : index]:
            for handle, position in zip(self._joints, positions, strict=True):
                handle.position = position
                handle.velocity = 0.0
        self._index = index
        if index == len(self._points):
            self.reset()
