"""``joint_state_controller`` and ``joint_state_broadcaster``: publishers of joint states."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, ClassVar

from cartwheel.codes import devices
from cartwheel.devices.joints.actuator_states import ActuatorStates, ActuatorStatesConfig
from cartwheel.dialects.ros_control.controller import Controller
from cartwheel.dialects.ros_control.hardware import JointHardware
from cartwheel.dialects.ros_control.interfaces import COMMANDS
from cartwheel.dialects.ros_control.parameters import ignored, parameter, ros2_parameter
from cartwheel.dialects.ros_control.settings import Settings


@dataclass(frozen=True, kw_only=True, slots=True)
class JointStateParameters:
    publish_rate: float | None = parameter(
        "publish_rate",
        ros2=(),
        default=None,
        unit="Hz",
        positive=True,
        doc="Publish rate; required.",
    )
    extra: None = ignored(
        "extra_joints",
        doc="Further joints. In ROS 1, a list of mappings with `name`, `position`, `velocity` and "
        "`effort`; in ROS 2, a list of names.",
    )
    joints: tuple[str, ...] = ros2_parameter(
        "joints",
        default=(),
        itself=True,
        doc="Published joints. Only has an effect together with `interfaces`.",
    )
    interfaces: tuple[str, ...] = ros2_parameter(
        "interfaces",
        default=(),
        itself=True,
        doc="Published interfaces.",
    )
    local: bool = ros2_parameter(
        "use_local_topics",
        default=False,
        doc="Publish below the controller's name.",
    )
    dynamic: bool = ros2_parameter(
        "publish_dynamic_joint_states",
        default=True,
        doc="Publish `dynamic_joint_states`.",
    )
    frame: str = ros2_parameter("frame_id", default="base_link", doc="Frame of the messages.")
    unused: None = ros2_parameter(
        "use_urdf_to_filter",
        default=None,
        doc="No effect, because all joints are in the URDF.",
    )
    mapped: None = ros2_parameter(
        *(f"map_interface_to_joint_state/{kind}" for kind in COMMANDS),
        default=None,
        doc="Interface that is published as the position, velocity or effort.",
    )


class JointStateController(Controller):
    """Publishes the states of all joints with interfaces.

    In ROS 1, ``joint_states`` in the controllers' namespace is published at ``publish_rate``, with
    the ``extra_joints`` as they are written. In ROS 2 it is published at the manager's rate, and
    ``dynamic_joint_states`` contains all state interfaces of each joint. With ``use_local_topics``,
    both are below the controller's name. ``joints`` and ``interfaces`` select a subset. Source:
    joint_state_controller, joint_state_broadcaster.
    """

    types: ClassVar[tuple[str, ...]] = (
        "joint_state_controller/JointStateController",
        "joint_state_broadcaster/JointStateBroadcaster",
    )

    parameters = JointStateParameters

    def configure(self, given: JointStateParameters) -> None:
        robot, settings = self.robot, self.settings
        if given.publish_rate is None and not robot.ros2:
            raise settings.missing("publish_rate")
        names = sorted(robot.hardware.names) if not robot.ros2 else robot.hardware.names
        self._sources = {kind: kind for kind in COMMANDS}
        self._chosen: list[str] = []
        self._frame = ""
        if robot.ros2:
            names = self._choose(given, names)
        self._joints = [robot.hardware.joint(name) for name in names]
        if robot.ros2:
            extra = settings.texts("extra_joints", [])
            others = {name: (0.0, 0.0, 0.0) for name in extra if name not in names}
        else:
            others = self._read_extra(settings.raw("extra_joints") or [], names)
        space = "" if given.local else f"/{robot.namespace.strip('/')}/"
        self._states = self.add(
            ActuatorStates(
                self.scope,
                ActuatorStatesConfig(
                    topic=f"{space}joint_states",
                    dynamic_topic=f"{space}dynamic_joint_states"
                    if robot.ros2 and given.dynamic
                    else "",
                    rate=given.publish_rate or 0.0,
                    frame=self._frame,
                    names=tuple(names),
                    sources=tuple(self._sources[kind] for kind in COMMANDS),
                    kinds=tuple(tuple(self._kinds(joint)) for joint in self._joints),
                    others=others,
                ),
                self._joints,
            )
        )

    def _choose(self, given: JointStateParameters, names: list[str]) -> list[str]:
        """Reads ROS 2's parameters for the published joints and interfaces; returns the joints."""
        settings = self.settings
        # Only both together select anything. One alone is reported as a parameter without effect.
        if {"joints", "interfaces"} <= set(settings.names()):
            joints, interfaces = settings.texts("joints"), settings.texts("interfaces")
            if joints and interfaces:
                names, self._chosen = joints, interfaces
        for kind in COMMANDS:
            source = settings.text(f"map_interface_to_joint_state/{kind}", kind)
            if kind in self._chosen:
                source = kind
            if source not in COMMANDS:
                self.warn(
                    devices.INTERFACE_UNKNOWN,
                    f'no joint has an interface "{source}", so the {kind} of all joints is NaN',
                    values={"interface": source},
                )
            self._sources[kind] = source
            if self._chosen and source not in self._chosen:
                self._sources[kind] = ""
        self._frame = given.frame
        return names

    def _read_extra(self, entries: Any, known: list[str]) -> dict[str, tuple[float, float, float]]:
        if not isinstance(entries, list):
            raise self.settings.invalid("extra_joints", entries, "a list")
        extra = {}
        for index, entry in enumerate(entries):
            each = Settings(
                entry if isinstance(entry, dict) else {}, f"{self.name}/extra_joints/{index}"
            )
            name = each.text("name")
            position, velocity, effort = (each.number(kind, 0.0) for kind in COMMANDS)
            if name not in known:
                extra[name] = (position, velocity, effort)
        return extra

    def state_interfaces(self) -> list[str]:
        return [f"{joint.name}/{kind}" for joint in self._joints for kind in self._kinds(joint)]

    def _kinds(self, joint: JointHardware) -> list[str]:
        """Returns the published interfaces of a joint."""
        return self._chosen or list(joint.interfaces.states)

    def start(self, time_ns: int) -> None:
        self._states.start(time_ns)
        self.next_ns = self._states.periodic.next_ns

    def update(self, time_ns: int, seconds: float) -> None:  # noqa: ARG002
        self._states.update(time_ns)
        self.next_ns = self._states.periodic.next_ns
