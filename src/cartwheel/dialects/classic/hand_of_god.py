"""``libgazebo_ros_hand_of_god.so``: a link that is pulled to a tf frame."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from cartwheel.codes import running
from cartwheel.dialects.plugin import Plugin
from cartwheel.dialects.tags import tag
from cartwheel.errors import PluginError
from cartwheel.geometry import Array, Quat, quat_conjugate, quat_multiply, rotate
from cartwheel.graph.frames import Frames
from cartwheel.messages import header, message_class

_WORLD = "world"


@dataclass(frozen=True, kw_only=True, slots=True)
class HandOfGodParameters:
    link: str = tag("linkName", "link_name", doc="Link to pull. Gravity does not act on it.")
    frame: str = tag(
        "frameId",
        "frame_id",
        default="hog",
        doc="Prefix of the frames `<frameId>_desired` (target) and `<frameId>_actual` (current "
        "pose). If the plugin tag contains `<ros>`, the default is `world`.",
    )
    stiffness: float = tag("kl", default=200.0, unit="N/m", doc="Stiffness of the linear spring.")
    turning: float = tag(
        "ka",
        default=200.0,
        unit="N m/rad",
        doc="Rotational stiffness. As in Gazebo, the torque per rad is half this value.",
    )


class HandOfGod(Plugin[HandOfGodParameters]):
    """Pulls a link to a tf frame with a critically damped spring.

    The target is the pose of the frame ``<frameId>_desired`` relative to ``world``. Until tf
    provides this transform, the link is not pulled. No other body receives the reaction force. The
    link's pose is published as the frame ``<frameId>_actual``. Original plugin:
    ``gazebo_ros_hand_of_god`` in the package ``gazebo_plugins``.
    """

    filenames: ClassVar[tuple[str, ...]] = ("libgazebo_ros_hand_of_god.so",)
    parameters: ClassVar[type] = HandOfGodParameters
    _frames: Frames | None = None

    def configure(self) -> None:
        config, part, origin = self.config, self.part, self.tag.origin
        self.check_not_negative("stiffness", "turning")
        self._link = part.link(config.link, origin=origin)
        described = part.description.link(config.link)
        if described is None or described.inertial is None:
            raise PluginError(
                f'link "{config.link}" has no mass, so it cannot be pulled',
                code=running.MODEL_NOT_MOVABLE,
                origin=origin,
                values={"link": config.link},
            )
        self._push = part.wrench(config.link, origin=origin)
        name = config.frame
        if self.tag.element.find("ros") is not None and self.tag.element.find("frame_id") is None:
            name = _WORLD
        self._desired, self._actual = f"{name}_desired", f"{name}_actual"
        self._frames = Frames(self.graph, self.node)
        self._Vector3 = message_class("geometry_msgs/msg/Vector3")
        self._Quaternion = message_class("geometry_msgs/msg/Quaternion")
        self._Transform = message_class("geometry_msgs/msg/Transform")
        self._TransformStamped = message_class("geometry_msgs/msg/TransformStamped")
        self._TFMessage = message_class("tf2_msgs/msg/TFMessage")
        self._publisher = self.advertise("/tf", "tf2_msgs/msg/TFMessage")
        part.schedule(0, before=self._pull)
        part.schedule(0, after=self._publish, active=lambda: self._publisher.wanted)

    def reset(self) -> None:
        self._push.forget()
        if self._frames is not None:
            self._frames.forget()

    def close(self) -> None:
        if self._frames is not None:
            self._frames.close()
        super().close()

    def _pull(self) -> None:
        link, config = self._link, self.config
        weight = np.array(self.part.world.gravity) * link.mass
        wanted = self._frames.pose(self._desired, _WORLD) if self._frames is not None else None
        if wanted is None:
            self._push.apply((-weight).tolist(), (0.0, 0.0, 0.0))
            return
        # A stiff spring that uses the state of the previous step is unstable.
        self.part.locate()
        place, turned = link.place()
        linear, _ = link.motion(local=False)
        _, angular = link.motion(local=True)
        seconds = self.part.period_ns(0) * 1e-9
        force = _pull(
            np.subtract(wanted.position, place), linear, config.stiffness, link.mass, seconds
        )
        error = _logarithm(quat_multiply(quat_conjugate(turned), wanted.orientation))
        # Gazebo damps all axes equally, using the inertia about the first axis.
        torque = _pull(error, angular, config.turning, float(link.inertia[0]), seconds)
        self._push.apply((force - weight).tolist(), rotate(turned, torque.tolist()))

    def _publish(self) -> None:
        # This plugin also receives this transform, which has no effect because its parent is the
        # world.
        place, turned = self._link.place()
        moved = self._Transform(self._Vector3(*place), self._Quaternion(*turned))
        head = header(self.part.time_ns, _WORLD)
        self._publisher.publish(
            self._TFMessage([self._TransformStamped(head, self._actual, moved)])
        )


def _pull(
    error: Array, speed: Sequence[float], stiffness: float, inertia: float, seconds: float
) -> Array:
    """Returns the force of a critically damped spring, integrated implicitly for stability."""
    damping = 2.0 * math.sqrt(stiffness * inertia)
    now = np.asarray(speed, dtype=float)
    slowed = 1.0 + (damping + stiffness * seconds) * seconds / inertia
    force: Array = (stiffness * (error - now * seconds) - damping * now) / slowed
    return force


def _logarithm(turn: Quat) -> Array:
    """Returns half the rotation vector of the shorter rotation, rad, shape (3,)."""
    x, y, z, w = turn
    vector = np.array([x, y, z]) * (1.0 if w >= 0 else -1.0)
    length = float(np.linalg.norm(vector))
    if length < 1e-12:
        return vector
    angle: Array = math.atan2(length, abs(w)) / length * vector
    return angle
