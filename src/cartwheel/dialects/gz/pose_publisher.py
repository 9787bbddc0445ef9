"""``gz-sim-pose-publisher-system``: poses of a model and its parts."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import partial
from typing import Any, ClassVar

from cartwheel.dialects.gz.drive_tags import gz_name
from cartwheel.dialects.plugin import Plugin
from cartwheel.dialects.tags import tag
from cartwheel.geometry import Pose
from cartwheel.graph import Publisher
from cartwheel.messages import header, message_class
from cartwheel.simulation.handles import LinkHandle

_Place = tuple[str, str, Callable[[], Pose]]
"""Frame, child frame, and a function that returns the pose of the child in the frame."""


@dataclass(frozen=True, kw_only=True, slots=True)
class PosePublisherParameters:
    links: bool = tag(
        "publish_link_pose", default=True, doc="Publish the poses of links, relative to the model."
    )
    visuals: bool = tag(
        "publish_visual_pose",
        default=False,
        doc="Publish the poses of visuals, relative to their links.",
    )
    collisions: bool = tag(
        "publish_collision_pose",
        default=False,
        doc="Publish the poses of collisions, relative to their links.",
    )
    sensors: bool = tag(
        "publish_sensor_pose",
        default=False,
        doc="Publish the poses of sensors, relative to their links.",
    )
    model: bool | None = tag(
        "publish_model_pose",
        default=None,
        doc="Publish the pose of the model in the world. Default: `<publish_nested_model_pose>`.",
    )
    nested: bool = tag(
        "publish_nested_model_pose",
        default=False,
        doc="Default of `<publish_model_pose>`. Nested models have no separate frames.",
    )
    vector: bool = tag(
        "use_pose_vector_msg",
        default=False,
        doc="Publish one TFMessage with all poses instead of one TransformStamped per pose.",
    )
    rate: float = tag(
        "update_frequency",
        default=-1.0,
        unit="Hz",
        doc="Publish rate. 0 or less: every step.",
    )
    static: bool = tag(
        "static_publisher",
        default=False,
        doc="Publish constant poses on `<topic>_static` instead of `<topic>`. A pose is "
        "constant if no joint can change it.",
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

    Each pose is relative to the parent frame. Frames are named ``<model>``, ``<model>/<link>`` and
    ``<model>/<link>/<part>``. Original plugin: ``PosePublisher`` in gz-sim. The message types are
    the same as in ros_gz_bridge.
    """

    filenames: ClassVar[tuple[str, ...]] = ("gz-sim-pose-publisher-system",)
    parameters: ClassVar[type] = PosePublisherParameters

    def configure(self) -> None:
        config, part = self.config, self.part
        self._links = {link.name: part.link(link.name) for link in part.description.links}
        self._root = self._links[part.description.canonical_link]
        self._to_model = part.description.canonical_pose.inverse()
        self._Vector3 = message_class("geometry_msgs/msg/Vector3")
        self._Quaternion = message_class("geometry_msgs/msg/Quaternion")
        self._Transform = message_class("geometry_msgs/msg/Transform")
        self._TransformStamped = message_class("geometry_msgs/msg/TransformStamped")
        self._TFMessage = message_class("tf2_msgs/msg/TFMessage")
        moved = self._moved() if config.static else set()
        places = list(self._places())
        topic = gz_name(self, config.topic, "pose")
        if config.static:
            still = [place for place in places if place[1] not in moved]
            places = [place for place in places if place[1] in moved]
            rate = config.rate if config.static_rate is None else config.static_rate
            self._offer(f"{topic}_static", still, rate)
        self._offer(topic, places, config.rate)

    def _offer(self, topic: str, places: list[_Place], rate: float) -> None:
        rate = max(rate, 0.0)
        one = "geometry_msgs/msg/TransformStamped"
        kind = "tf2_msgs/msg/TFMessage" if self.config.vector else one
        publisher = self.advertise(topic, kind, rate=rate or None)
        self.part.schedule(
            rate, after=lambda: self._publish(publisher, places), active=lambda: publisher.wanted
        )

    def _publish(self, publisher: Publisher, places: list[_Place]) -> None:
        sent = [self._transform(*place) for place in places]
        if self.config.vector:
            publisher.publish(self._TFMessage(sent))
            return
        for transform in sent:
            publisher.publish(transform)

    def _transform(self, frame: str, child: str, where: Callable[[], Pose]) -> Any:
        pose = where()
        moved = self._Transform(self._Vector3(*pose.position), self._Quaternion(*pose.orientation))
        return self._TransformStamped(header(self.part.time_ns, frame), child, moved)

    def _model(self) -> Pose:
        return self._root.pose @ self._to_model

    def _in_model(self, link: LinkHandle) -> Pose:
        return self._model().inverse() @ link.pose

    def _places(self) -> Iterator[_Place]:
        config, name = self.config, self.part.name
        if config.nested if config.model is None else config.model:
            yield self.part.world.name, name, self._model
        for link in self.part.description.links:
            own = f"{name}/{_slashed(link.name)}"
            if config.links:
                handle = self._links[link.name]
                yield name, own, partial(self._in_model, handle)
            for wanted, parts in (
                (config.visuals, link.visuals),
                (config.collisions, link.collisions),
                (config.sensors, link.sensors),
            ):
                for part in parts if wanted else ():
                    yield own, f"{own}/{_slashed(part.name)}", partial(_fixed, part.pose)

    def _moved(self) -> set[str]:
        """Returns the frames of links at movable joints. The canonical link is the reference."""
        description = self.part.description
        links = {
            link
            for joint in description.joints
            if joint.type != "fixed"
            for link in (joint.parent, joint.child)
        }
        moved = links - {description.canonical_link}
        return {f"{self.part.name}/{_slashed(link)}" for link in moved}


def _fixed(pose: Pose) -> Pose:
    return pose


def _slashed(name: str) -> str:
    return name.replace("::", "/")
