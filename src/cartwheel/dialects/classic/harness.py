"""``libgazebo_ros_harness.so``: a robot suspended from a winch."""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from typing import Any, ClassVar

import numpy as np

from cartwheel.codes import devices, running
from cartwheel.description.model import Element
from cartwheel.dialects.plugin import Plugin
from cartwheel.dialects.tags import invalid, number, tag, vector
from cartwheel.errors import PluginError, UnknownNameError
from cartwheel.geometry import Array, Vec3, rotate
from cartwheel.simulation.attaching import AttachmentHandle
from cartwheel.simulation.handles import LinkHandle
from cartwheel.simulation.limits import FARTHEST

_SHORTEST = 1e-9


@dataclass(frozen=True, kw_only=True, slots=True)
class HarnessParameters:
    joints: tuple[str, ...] = tag(
        "joint",
        default=(),
        nested=True,
        doc="Prismatic joint with the parent `world` and a `<child>` in this model, written "
        "as an SDF `<joint>`.",
    )
    winch: str = tag(
        "winch",
        default="",
        nested=True,
        doc="The winch, which moves the joint named in `<joint>`. `<pid>` has no effect.",
    )
    detach: str = tag(
        "detach", default="", doc="Joint that is detached by a message on the topic `detach`."
    )
    velocity: float = tag(
        "init_vel",
        default=0.0,
        unit="m/s",
        most=FARTHEST,
        doc="Initial velocity of the winch (ROS 2).",
    )


@dataclass(kw_only=True, slots=True)
class _Rope:
    link: LinkHandle
    joint: AttachmentHandle
    own_axis: Vec3
    """In the link frame."""
    limits: tuple[float, float]
    """m."""
    attached: bool = False
    axis: Array = field(default_factory=lambda: np.zeros(3))
    """In the world, at the time of attachment."""
    start: float = 0.0
    end: float = 0.0
    """Positions along the axis, m: the link's at attachment, and the rope's end."""

    @property
    def place(self) -> float:
        """Position of the link along the axis, m."""
        return float(np.dot(self.link.place()[0], self.axis))


class Harness(Plugin[HarnessParameters]):
    """Suspends links of the model from the world, and raises and lowers one of them with a winch.

    The winch follows ``/<model>/harness/velocity`` (Float32) in m/s. A message on
    ``/<model>/harness/detach`` detaches the joint in ``<detach>``. The message is a Bool with the
    value true. If the plugin tag contains ``<ros>``, the message is an Empty, and the topics are in
    the plugin's namespace.

    Each joint acts as a rope, which pulls but does not push. While the robot stands on the ground,
    the rope is slack and exerts no force. A taut rope holds the link rigidly, as a prismatic joint
    would. Original plugins: ``gazebo_ros_harness`` in the package ``gazebo_plugins``, and
    ``HarnessPlugin`` in Gazebo Classic.
    """

    filenames: ClassVar[tuple[str, ...]] = ("libgazebo_ros_harness.so", "libHarnessPlugin.so")
    parameters: ClassVar[type] = HarnessParameters

    def configure(self) -> None:
        config, element = self.config, self.tag.element
        self._ropes = dict(self._rope(each) for each in element.find_all("joint"))
        if not self._ropes:
            self.warn(devices.PLUGIN_IDLE, "the harness has no <joint>, so nothing is suspended")
        wound = element.find("winch/joint")
        self._winch = self._named(wound.text.strip()) if wound is not None else None
        self._detached = self._named(config.detach) if config.detach else None
        ros2 = element.find("ros") is not None
        base = f"{'' if ros2 else '/'}{self.part.name}/harness"
        self.subscribe(f"{base}/velocity", "std_msgs/msg/Float32", self._on_velocity)
        kind = "std_msgs/msg/Empty" if ros2 else "std_msgs/msg/Bool"
        self.subscribe(f"{base}/detach", kind, self._on_detach)
        self._hung = False
        self._velocity = config.velocity
        self._before_ns = self.part.time_ns
        self.part.schedule(0, before=self._hold)

    def reset(self) -> None:
        for rope in self._ropes.values():
            rope.joint.release()
        self._hung = False
        self._velocity = self.config.velocity
        self._before_ns = self.part.time_ns

    def _rope(self, element: Element) -> tuple[str, _Rope]:
        name = element.attribute("name") or ""
        texts = {}
        for what in ("parent", "child", "axis/xyz"):
            child = element.find(what)
            texts[what] = child.text.strip() if child is not None else ""
        kind = element.attribute("type")
        if kind != "prismatic" or texts["parent"] != "world":
            raise PluginError(
                f'joint "{name}" of a harness must be prismatic and have the parent "world"',
                code=devices.PLUGIN_PARAMETER_INVALID,
                origin=element.origin,
                values={"parameter": "joint", "joint": name},
            )
        link = texts["child"].removeprefix(f"{self.part.description.name}::")
        handle = self.part.link(link, origin=element.origin)
        axis = element.find("axis/xyz")
        x, y, z = vector(axis, 3) if axis is not None and texts["axis/xyz"] else (0.0, 0.0, 1.0)
        length = math.hypot(x, y, z)
        if length < _SHORTEST:
            axis_place = axis.origin if axis is not None else element.origin
            raise invalid("xyz", texts["axis/xyz"], "a vector with a positive length", axis_place)
        limits = [
            self._limit(element, f"axis/limit/{what}", default)
            for what, default in (("lower", -math.inf), ("upper", math.inf))
        ]
        return name, _Rope(
            link=handle,
            joint=self.part.attachment(),
            own_axis=(x / length, y / length, z / length),
            limits=(min(limits[0], 0.0), max(limits[1], 0.0)),
        )

    def _limit(self, element: Element, path: str, default: float) -> float:
        child = element.find(path)
        return number(child, endless=True) if child is not None else default

    def _named(self, name: str) -> _Rope:
        if name not in self._ropes:
            raise UnknownNameError(
                "joint",
                name,
                self._ropes,
                code=devices.PLUGIN_JOINT_UNKNOWN,
                origin=self.tag.origin,
            )
        return self._ropes[name]

    def _on_velocity(self, message: Any) -> None:
        if self._winch is None:
            self.warn(running.COMMAND_IGNORED, "a command is ignored: the harness has no <winch>")
        else:
            self._velocity = float(message.data)

    def _on_detach(self, message: Any) -> None:
        # A Bool that is false is ignored; an Empty always detaches.
        if not getattr(message, "data", True):
            return
        rope = self._detached
        if rope is None or not rope.attached:
            self.warn(
                running.ATTACHMENT_FAILED,
                "a command is ignored: the harness has no attached joint to detach",
            )
        else:
            rope.attached = False
            rope.joint.release()

    def _hold(self) -> None:
        seconds = (self.part.time_ns - self._before_ns) * 1e-9
        self._before_ns = self.part.time_ns
        self.part.locate()
        if not self._hung:
            self._hung = True
            for rope in self._ropes.values():
                self._hang(rope)
        for rope in self._ropes.values():
            if rope.attached:
                wound = self._velocity * seconds if rope is self._winch else 0.0
                low, high = (rope.start + limit for limit in rope.limits)
                end = min(max(rope.end + wound, low), high)
                self._pull(rope, end - rope.end)

    def _hang(self, rope: _Rope) -> None:
        rope.joint.hold(None, (self.part.name, rope.link.name))
        _, turned = rope.link.place()
        rope.axis = np.array(rotate(turned, rope.own_axis))
        rope.start = rope.end = rope.place
        rope.attached = True

    def _pull(self, rope: _Rope, way: float) -> None:
        """Moves the rope's end, and updates whether the rope is slack or taut."""
        rope.end += way
        joint = rope.joint
        if joint.held is None:
            if rope.place > rope.end:
                return
            joint.hold(None, (self.part.name, rope.link.name))
            way = rope.end - rope.place
        elif float(np.dot(joint.force(), rope.axis)) < 0:
            joint.release()
            return
        if way:
            x, y, z = (way * rope.axis).tolist()
            joint.shift((x, y, z))
