"""``libgazebo_ros_harness.so``: a robot suspended from a winch."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import ClassVar

from cartwheel.codes import devices
from cartwheel.description.model import Element
from cartwheel.devices.mechanisms.winch import RopeConfig, Winch, WinchConfig
from cartwheel.dialects.plugin import Plugin
from cartwheel.dialects.tags import invalid, number_at, tag, vector
from cartwheel.errors import PluginError, UnknownNameError
from cartwheel.simulation.limits import FARTHEST

_SHORTEST = 1e-9


@dataclass(frozen=True, kw_only=True, slots=True)
class HarnessParameters:
    joints: tuple[str, ...] = tag(
        "joint",
        default=(),
        nested=True,
        doc="SDF `<joint>` that suspends a link. Its type is `prismatic`, its parent is "
        "`world`, and its `<child>` is a link of this model. Repeat the tag for each "
        "suspended link.",
    )
    winch: str = tag(
        "winch",
        default="",
        nested=True,
        doc="The winch. Inside this tag, `<joint>` names the joint that the winch moves, and "
        "`<pid>` has no effect.",
    )
    detach: str = tag(
        "detach",
        default="",
        doc="Name of the joint that is detached by a message on the topic `detach`.",
    )
    velocity: float = tag(
        "init_vel",
        default=0.0,
        unit="m/s",
        most=FARTHEST,
        doc="Initial velocity of the winch. This tag comes from the ROS 2 plugin.",
    )


class Harness(Plugin[HarnessParameters]):
    """Suspends links of the model from the world, and raises and lowers one of them with a winch.

    The winch moves at the velocity that it receives on ``/<model>/harness/velocity`` (Float32, in
    m/s). A message with the value true on ``/<model>/harness/detach`` (Bool) detaches the joint
    that ``<detach>`` names. If the ``<plugin>`` contains ``<ros>``, the type of this topic is
    Empty, and both topics are in the plugin's namespace.

    Each joint acts as a rope, which pulls but does not push. While the robot stands on the ground,
    the rope is slack and exerts no force. A taut rope holds the link rigidly, as a prismatic joint
    would. Original plugins: ``gazebo_ros_harness`` in the package ``gazebo_plugins``, and
    ``HarnessPlugin`` in Gazebo Classic.
    """

    filenames: ClassVar[tuple[str, ...]] = ("libgazebo_ros_harness.so", "libHarnessPlugin.so")

    def configure(self) -> None:
        config, element = self.config, self.tag.element
        ropes = dict(self._rope(each) for each in element.find_all("joint"))
        if not ropes:
            self.warn(devices.PLUGIN_IDLE, "the harness has no <joint>, so nothing is suspended")
        names = list(ropes)
        wound = element.find("winch/joint")
        ros2 = element.find("ros") is not None
        base = f"{'' if ros2 else '/'}{self.part.name}/harness"
        device = WinchConfig(
            ropes=tuple(ropes.values()),
            wound=self._index(wound.text.strip(), names) if wound is not None else None,
            detachable=self._index(config.detach, names) if config.detach else None,
            velocity=config.velocity,
            velocity_topic=f"{base}/velocity",
            detach_topic=f"{base}/detach",
            detach_type="std_msgs/msg/Empty" if ros2 else "std_msgs/msg/Bool",
        )
        self.device = self.add(Winch(self.scope, device))

    def _rope(self, element: Element) -> tuple[str, RopeConfig]:
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
        axis = element.find("axis/xyz")
        x, y, z = vector(axis, 3) if axis is not None and texts["axis/xyz"] else (0.0, 0.0, 1.0)
        length = math.hypot(x, y, z)
        if length < _SHORTEST:
            axis_place = axis.origin if axis is not None else element.origin
            raise invalid("xyz", texts["axis/xyz"], "a vector with a positive length", axis_place)
        limits = [
            number_at(element, f"axis/limit/{what}", default, endless=True)
            for what, default in (("lower", -math.inf), ("upper", math.inf))
        ]
        return name, RopeConfig(
            link=link,
            axis=(x / length, y / length, z / length),
            limits=(min(limits[0], 0.0), max(limits[1], 0.0)),
            origin=element.origin,
        )

    def _index(self, name: str, names: list[str]) -> int:
        if name not in names:
            raise UnknownNameError(
                "joint",
                name,
                names,
                code=devices.PLUGIN_JOINT_UNKNOWN,
                origin=self.tag.origin,
            )
        return names.index(name)
