"""``libgazebo_ros_joint_state_publisher.so`` and its gz-sim counterpart."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, ClassVar

from cartwheel.codes import running
from cartwheel.devices.joints.states import JointStates, JointStatesConfig
from cartwheel.dialects.common_tags import publish_rate_tag
from cartwheel.dialects.gz.drive_tags import gz_name
from cartwheel.dialects.plugin import Plugin
from cartwheel.dialects.tags import tag


def _joints(plugin: Plugin[Any], names: list[str]) -> tuple[str, ...]:
    """Returns the joints in the tag, or all movable joints if the tag is empty."""
    description = plugin.part.description
    if not names:
        names = [joint.name for joint in description.joints if joint.has_first_axis]
    moving = []
    for name in names:
        joint = description.joint(name)
        if joint is not None and not joint.has_first_axis:
            fixed = joint.type == "fixed"
            kind = "is fixed" if fixed else f"has the type {joint.type}"
            plugin.warn(
                running.JOINT_WITHOUT_STATE,
                f'joint "{name}" {kind}, so it has no state to publish',
                severity="info" if fixed else "warning",
                values={"joint": name},
            )
        else:
            moving.append(name)
    return tuple(moving)


@dataclass(frozen=True, kw_only=True, slots=True)
class JointStatePublisherParameters:
    names: tuple[str, ...] = tag(
        "jointName",
        "joint_name",
        default=(),
        role="other_joint",
        doc="Joints to publish, separated by commas. Default: all movable joints.",
    )
    update_rate: float = publish_rate_tag("updateRate", "update_rate", default=100.0)


class JointStatePublisher(Plugin[JointStatePublisherParameters]):
    """Publishes the positions and velocities of joints on ``joint_states``.

    The topic is in the plugin's namespace. As in Gazebo Classic, the namespace is the model's name
    in two cases: if ``<robotNamespace>`` is empty, or if this tag is missing and the model is part
    of a world file. A ``<plugin>`` that contains ``<ros>``, ``<joint_name>`` or ``<update_rate>``
    is treated as written for ROS 2: the default topic is then ``/joint_states``. Original plugin:
    ``gazebo_ros_joint_state_publisher`` in the package ``gazebo_plugins``.
    """

    filenames: ClassVar[tuple[str, ...]] = ("libgazebo_ros_joint_state_publisher.so",)
    empty_is_model: ClassVar[bool] = True

    def configure(self) -> None:
        config, element = self.config, self.tag.element
        ros2 = any(element.find(name) for name in ("ros", "joint_name", "update_rate"))
        if not ros2:
            self.under_model()
        names = [name.strip() for text in config.names for name in text.split(",")]
        states = self.add(
            JointStates(
                self.scope,
                JointStatesConfig(
                    joints=_joints(self, [name for name in names if name]),
                    rate=config.update_rate,
                    velocities=True,
                ),
            )
        )
        states.schedule()


@dataclass(frozen=True, kw_only=True, slots=True)
class GzJointStatePublisherParameters:
    topic: str = tag(
        "topic",
        default="",
        doc="Topic of the JointState messages. "
        "Default: `/world/<world>/model/<model>/joint_state`.",
    )
    names: tuple[str, ...] = tag(
        "joint_name",
        default=(),
        role="other_joint",
        doc="Joint to publish. Repeat the tag for each joint. Default: all movable joints.",
    )
    update_rate: float = publish_rate_tag("update_rate")


class GzJointStatePublisher(Plugin[GzJointStatePublisherParameters]):
    """Publishes the positions, velocities and efforts of joints as JointState messages.

    Original plugin: ``JointStatePublisher`` in gz-sim.
    """

    filenames: ClassVar[tuple[str, ...]] = ("gz-sim-joint-state-publisher-system",)

    def configure(self) -> None:
        config, part = self.config, self.part
        topic = config.topic or f"/world/{part.world.name}/model/{part.name}/joint_state"
        states = self.add(
            JointStates(
                self.scope,
                JointStatesConfig(
                    joints=_joints(self, [name.strip() for name in config.names]),
                    topic=gz_name(self, topic, ""),
                    rate=config.update_rate,
                    velocities=True,
                    efforts=True,
                ),
            )
        )
        states.schedule()
