"""``libgazebo_ros_joint_pose_trajectory.so``: joints that are set to trajectory positions."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, ClassVar

from cartwheel.codes import running
from cartwheel.dialects.plugin import Plugin
from cartwheel.dialects.tags import tag
from cartwheel.messages import message_class, nanoseconds
from cartwheel.simulation.handles import JointHandle


@dataclass(frozen=True, kw_only=True, slots=True)
class JointPoseTrajectoryParameters:
    topic: str = tag(
        "topicName",
        "topic_name",
        default="set_joint_trajectory",
        doc="Topic of the JointTrajectory commands.",
    )
    service: str = tag(
        "serviceName",
        default="set_joint_trajectory",
        doc="Service of type SetJointTrajectory, an alternative to the topic.",
    )
    update_rate: float = tag(
        "updateRate",
        "update_rate",
        default=0.0,
        unit="Hz",
        doc="Rate at which trajectory points are applied. 0: every step.",
    )


class JointPoseTrajectory(Plugin[JointPoseTrajectoryParameters]):
    """Sets joint positions to the points of a trajectory, without simulating forces.

    The trajectory starts at its header stamp or on arrival, whichever is later. Each point is
    applied after its ``time_from_start``. In Gazebo, each time is measured from the previous point
    instead.

    The root link is not moved, so ``header.frame_id`` must be empty, the root link, ``world`` or
    ``map``. Trajectories with a different frame, and service requests with ``set_model_pose``, are
    rejected. Original plugin: ``gazebo_ros_joint_pose_trajectory`` in the package
    ``gazebo_plugins``.
    """

    filenames: ClassVar[tuple[str, ...]] = (
        "libgazebo_ros_joint_pose_trajectory.so",
        "libgazebo_ros_joint_trajectory.so",
    )
    parameters: ClassVar[type] = JointPoseTrajectoryParameters

    def configure(self) -> None:
        self.check_not_negative("update_rate")
        self._handles: dict[str, JointHandle] = {
            joint.name: self.part.joint(joint.name)
            for joint in self.part.description.joints
            if joint.drivable
        }
        self._points: list[tuple[int, list[tuple[JointHandle, float]]]] = []
        self._Response = message_class("gazebo_msgs/srv/SetJointTrajectory_Response")
        self.subscribe(
            self.config.topic, "trajectory_msgs/msg/JointTrajectory", self._on_trajectory
        )
        self.serve(self.config.service, "gazebo_msgs/srv/SetJointTrajectory", self._on_request)
        self.part.schedule(
            self.config.update_rate, before=self._follow, active=lambda: bool(self._points)
        )

    def reset(self) -> None:
        self._points = []

    def _on_trajectory(self, trajectory: Any) -> None:
        problem = self._take(trajectory)
        if problem:
            self.warn(running.TRAJECTORY_INVALID, f"a trajectory is ignored: {problem}")

    def _on_request(self, request: Any) -> Any:
        problem = self._take(request.joint_trajectory)
        if not problem and request.model_name not in ("", self.part.name):
            problem = (
                f'the trajectory is for model "{request.model_name}", not for "{self.part.name}"'
            )
        if not problem and request.set_model_pose:
            problem = "set_model_pose is not supported: use /gazebo/set_model_state"
        if problem:
            self._points = []
        return self._Response(success=not problem, status_message=problem)

    def _take(self, trajectory: Any) -> str:
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
            due = start + nanoseconds(point.time_from_start)
            handles = [self._handles[name] for name in names]
            positions = [float(position) for position in point.positions]
            points.append((due, list(zip(handles, positions, strict=True))))
        self._points = sorted(points, key=lambda point: point[0])
        return ""

    def _follow(self) -> None:
        while self._points and self._points[0][0] <= self.part.time_ns:
            for handle, position in self._points.pop(0)[1]:
                handle.position = position
                handle.velocity = 0.0
