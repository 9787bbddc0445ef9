"""``gz-sim-pose-publisher-system``: poses of a model and its parts."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

from cartwheel.devices.position.poses import ModelPoses, ModelPosesConfig
from cartwheel.dialects.gz.drive_tags import gz_name
from cartwheel.dialects.plugin import Plugin
from cartwheel.dialects.tags import tag


@dataclass(frozen=True, kw_only=True, slots=True)
class PosePublisherParameters:
    links: bool = tag(
        "publish_link_pose",
        default=True,
        doc="Whether to publish the poses of links, relative to the model.",
    )
    visuals: bool = tag(
        "publish_visual_pose",
        default=False,
        doc="Whether to publish the poses of visuals, relative to their links.",
    )
    collisions: bool = tag(
        "publish_collision_pose",
        default=False,
        doc="Whether to publish the poses of collisions, relative to their links.",
    )
    sensors: bool = tag(
        "publish_sensor_pose",
        default=False,
        doc="Whether to publish the poses of sensors, relative to their links.",
    )
    model: bool | None = tag(
        "publish_model_pose",
        default=None,
        doc="Whether to publish the pose of the model in the world. Default: "
        "`<publish_nested_model_pose>`.",
    )
    nested: bool = tag(
        "publish_nested_model_pose",
        default=False,
        doc="Sets the default of `<publish_model_pose>`. It has no other effect, because nested "
        "models have no frames of their own.",
    )
    vector: bool = tag(
        "use_pose_vector_msg",
        default=False,
        doc="Whether to publish all poses in one TFMessage, instead of one TransformStamped for "
        "each pose.",
    )
    rate: float = tag(
        "update_frequency",
        default=-1.0,
        unit="Hz",
        doc="Publish rate. If 0 or negative, messages are published at every simulation step.",
    )
    static: bool = tag(
        "static_publisher",
        default=False,
        doc="Whether to publish constant poses on `<topic>_static` instead of `<topic>`. A pose "
        "is constant if no joint can change it.",
    )
    static_rate: float | None = tag(
        "static_update_frequency",
        default=None,
        unit="Hz",
        doc="Publish rate of the static poses. Default: `<update_frequency>`.",
    )
    topic: str = tag("topic", default="", doc="Topic of the poses. Default: `/model/<model>/pose`.")


class PosePublisher(Plugin[PosePublisherParameters]):
    """Publishes the poses of a model and of its links, visuals, collisions and sensors.

    Each pose is relative to its parent: the pose of a link is relative to the model, and the poses
    of visuals, collisions and sensors are relative to their links. The frames are named
    ``<model>``, ``<model>/<link>`` and ``<model>/<link>/<name>``, where ``<name>`` is the name of
    the visual, collision or sensor. Original plugin: ``PosePublisher`` in gz-sim. The message types
    are the same as in ros_gz_bridge.
    """

    filenames: ClassVar[tuple[str, ...]] = ("gz-sim-pose-publisher-system",)

    def configure(self) -> None:
        config = self.config
        topic = gz_name(self, config.topic, "pose")
        static_rate = config.rate if config.static_rate is None else config.static_rate
        device = ModelPosesConfig(
            model=config.nested if config.model is None else config.model,
            links=config.links,
            visuals=config.visuals,
            collisions=config.collisions,
            sensors=config.sensors,
            one_message=config.vector,
            topic=topic,
            rate=max(config.rate, 0.0),
            static_topic=f"{topic}_static" if config.static else None,
            static_rate=max(static_rate, 0.0),
        )
        self.add(ModelPoses(self.scope, device))
