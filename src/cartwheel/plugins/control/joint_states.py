"""``joint_state_controller`` and ``joint_state_broadcaster``: where joints are."""

from __future__ import annotations

from typing import Any, ClassVar

import numpy as np

from cartwheel.messages import header, message_class
from cartwheel.plugins.control.controller import Controller, Rhythm
from cartwheel.plugins.control.settings import Settings


class JointStateController(Controller):
    """Publishes the state of all joints of the hardware.

    ROS 1: on ``joint_states`` of the namespace, at ``publish_rate``, with ``extra_joints``
    that are told as they are written. ROS 2: at the manager's rate; ``use_local_topics`` puts
    it below the controller. Source: joint_state_controller, joint_state_broadcaster.
    """

    types: ClassVar[tuple[str, ...]] = (
        "joint_state_controller/JointStateController",
        "joint_state_broadcaster/JointStateBroadcaster",
    )

    def configure(self, settings: Settings) -> None:
        rig = self.rig
        self._rate = 0.0 if rig.ros2 else settings.number("publish_rate")
        if self._rate < 0 or (not rig.ros2 and self._rate == 0):
            raise settings.error(f'"publish_rate" {self._rate:g} must be above 0')
        wanted = settings.texts("joints", []) if rig.ros2 else []
        names = sorted(rig.hardware.names) if not rig.ros2 else rig.hardware.names
        if wanted:
            settings.texts("interfaces", [])
            names = wanted
        self._joints = [rig.hardware.joint(name) for name in names]
        local = rig.ros2 and settings.boolean("use_local_topics", False)
        settings.ignore(
            "map_interface_to_joint_state", "use_urdf_to_filter", "interfaces", "frame_id"
        )
        self._extra: list[tuple[str, float, float, float]] = []
        if rig.ros2:
            extra = settings.texts("extra_joints", [])
            self._extra = [(name, 0.0, 0.0, 0.0) for name in extra if name not in names]
        else:
            self._extra = self._read_extra(settings.raw("extra_joints") or [], names)
        topic = "joint_states"
        if not local:
            topic = f"/{rig.namespace.strip('/')}/joint_states"
        self._publisher = self.advertise(
            topic, "sensor_msgs/msg/JointState", rate=self._rate or None
        )
        self._names = [*names, *(each[0] for each in self._extra)]
        self._rhythm = Rhythm(self._rate)
        self._JointState = message_class("sensor_msgs/msg/JointState")

    def _read_extra(self, entries: Any, known: list[str]) -> list[tuple[str, float, float, float]]:
        if not isinstance(entries, list):
            raise self.settings.error('"extra_joints" must be a list')
        found = []
        for index, entry in enumerate(entries):
            each = Settings(
                entry if isinstance(entry, dict) else {}, f"{self.name}/extra_joints/{index}"
            )
            name = each.text("name")
            if name not in known:
                found.append(
                    (
                        name,
                        each.number("position", 0.0),
                        each.number("velocity", 0.0),
                        each.number("effort", 0.0),
                    )
                )
        return found

    def state_interfaces(self) -> list[str]:
        return [
            f"{joint.name}/{kind}" for joint in self._joints for kind in joint.interfaces.states
        ]

    def start(self, time_ns: int) -> None:
        self._rhythm.start(time_ns)

    def update(self, time_ns: int, seconds: float) -> None:  # noqa: ARG002
        if not self._rhythm.due(time_ns) or not self._publisher.wanted:
            return
        joints, extra = self._joints, self._extra
        self._publisher.publish(
            self._JointState(
                header=header(time_ns, ""),
                name=self._names,
                position=np.array([*(j.position for j in joints), *(e[1] for e in extra)]),
                velocity=np.array([*(j.velocity for j in joints), *(e[2] for e in extra)]),
                effort=np.array([*(j.effort for j in joints), *(e[3] for e in extra)]),
            )
        )
