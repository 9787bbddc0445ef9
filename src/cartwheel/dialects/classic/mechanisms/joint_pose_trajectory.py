"""``libgazebo_ros_joint_pose_trajectory.so``: joints that are set to trajectory positions."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

from cartwheel.devices.joints.pose_trajectory import PoseTrajectory, PoseTrajectoryConfig
from cartwheel.dialects.plugin import Plugin
from cartwheel.dialects.tags import tag


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
        doc="Name of a service of type SetJointTrajectory, which accepts the same trajectories "
        "as the topic.",
    )
    update_rate: float = tag(
        "updateRate",
        "update_rate",
        default=0.0,
        unit="Hz",
        least=0.0,
        doc="Rate at which joint positions are set. If 0, they are set at every simulation step.",
    )


class JointPoseTrajectory(Plugin[JointPoseTrajectoryParameters]):
    """Sets joints directly to the positions of a trajectory, without simulating forces.

    The trajectory starts at its header stamp or on arrival, whichever is later. Each point is
    applied when its ``time_from_start`` has passed since the start of the trajectory. In Gazebo,
    this time is measured from the previous point instead.

    The plugin does not move the root link. The ``header.frame_id`` must therefore be empty, the
    root link, ``world`` or ``map``. Trajectories with any other frame are rejected, and so are
    service requests with ``set_model_pose``. Original plugin: ``gazebo_ros_joint_pose_trajectory``
    in the package ``gazebo_plugins``.
    """

    filenames: ClassVar[tuple[str, ...]] = (
        "libgazebo_ros_joint_pose_trajectory.so",
        "libgazebo_ros_joint_trajectory.so",
    )

    def configure(self) -> None:
        config = self.config
        self.add(
            PoseTrajectory(
                self.scope,
                PoseTrajectoryConfig(
                    topic=config.topic, service=config.service, rate=config.update_rate
                ),
            )
        )
