"""Joint and sensor interfaces in ``<transmission>`` and ``<ros2_control>`` tags."""

from __future__ import annotations

import math
import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Literal

from cartwheel.codes import devices
from cartwheel.description.elements.numbers import LARGEST, MOST_RATIO
from cartwheel.description.model import Element, PluginTag, RobotDescription
from cartwheel.dialects.stopping import CONSEQUENCE, refused_interface, stops
from cartwheel.dialects.tags import invalid
from cartwheel.errors import Code, Diagnostic, Origin, Severity, Value
from cartwheel.simulation.limits import FARTHEST

COMMANDS = ("position", "velocity", "effort")
"""Supported command interfaces of a joint."""
CLASSIC_SYSTEM = "gazebo_ros2_control/GazeboSystem"
"""The hardware plugin of ros2_control in Gazebo Classic."""
MANAGERS = {
    CLASSIC_SYSTEM: "libgazebo_ros2_control.so",
    "gz_ros2_control/GazeboSimSystem": "gz_ros2_control-system",
    "ign_ros2_control/IgnitionSystem": "ign_ros2_control-system",
}
"""Hardware plugins of ros2_control that are simulated, and the Gazebo plugins that run them."""
SYSTEMS = tuple(MANAGERS)
PLAIN = ("gazebo_ros_control/DefaultRobotHWSim", "DefaultRobotHWSim", "")
"""Names of the only hardware in gazebo_ros_control."""
_PACKAGE = "gazebo_ros_control/"
_LOADS = {
    "gazebo_ros2_control": (CLASSIC_SYSTEM,),
    "gz_ros2_control": ("gz_ros2_control/GazeboSimSystem", "ign_ros2_control/IgnitionSystem"),
    "ign_ros2_control": ("ign_ros2_control/IgnitionSystem",),
}
"""By the name of a Gazebo plugin: the hardware plugins that it loads. Only gz_ros2_control, from
ROS 2 Iron on, also knows the older name."""
_HARDWARE = {
    "PositionJointInterface": "position",
    "VelocityJointInterface": "velocity",
    "EffortJointInterface": "effort",
    "PosVelJointInterface": "position",
    "PosVelAccJointInterface": "position",
}
_STATES_ONLY = ("JointStateInterface", "ImuSensorInterface", "ForceTorqueSensorInterface")


@dataclass(frozen=True, kw_only=True, slots=True)
class JointInterfaces:
    """Interfaces of a joint."""

    name: str
    commands: tuple[str, ...] = ()
    """Command interfaces, each one of `COMMANDS`."""
    passive: tuple[str, ...] = ()
    """Those that hardware of other programs than Gazebo offers, but that are not simulated."""
    states: tuple[str, ...] = ("position", "velocity", "effort")
    initial_position: float | None = None
    mimic: tuple[str, float] | None = None
    """The joint that this joint follows, and the multiplier."""
    by_pid: str = ""
    """The interface whose commands a PID converts to efforts: ``position`` or ``velocity``."""
    gains: Mapping[str, float] = field(default_factory=dict)
    """``pos_kp``, ``vel_ki`` and so on, from the joint's ``<param>`` tags."""
    origin: Origin


@dataclass(frozen=True, kw_only=True, slots=True)
class SensorInterfaces:
    """A sensor in a ``<ros2_control>`` tag."""

    name: str
    states: tuple[str, ...]
    parameters: Mapping[str, str]
    origin: Origin


def transmissions(
    description: RobotDescription, *, several: bool = False
) -> tuple[list[JointInterfaces], list[Diagnostic]]:
    """Reads the joints of all transmissions, as ros_control's robot simulation does.

    Reductions have no effect: they are between motor and joint, and motors are not simulated.
    Source: transmission_interface, gazebo_ros_control.

    Args:
        description: The robot.
        several: Accept transmissions with several joints, such as a wrist's differential. The
            default simulation ignores them.
    """
    by_name: dict[str, JointInterfaces] = {}
    notes: list[Diagnostic] = []

    def warn(
        code: Code,
        element: Element,
        message: str,
        severity: Severity | None = None,
        **values: Value,
    ) -> None:
        notes.append(
            code.diagnostic(message, severity=severity, origin=element.origin, values=values)
        )

    for element in description.transmissions:
        label = f'transmission "{element.attribute("name") or ""}"'
        joints = list(element.find_all("joint"))
        kind = element.find("type")
        if kind is None and element.attribute("type"):
            # A format older than ros_control, which its parser also ignores.
            notes.append(
                devices.TRANSMISSION_IGNORED.diagnostic(
                    f"{label} uses the PR2 format, so it drives no joint",
                    severity="info",
                    origin=element.origin,
                    values={"transmission": element.attribute("name")},
                )
            )
            continue
        if not joints or (len(joints) > 1 and not several):
            text = f"{label} has no effect: it must have exactly one joint (got {len(joints)})"
            warn(devices.TRANSMISSION_IGNORED, element, text, joints=len(joints))
            continue
        for joint in joints:
            name = joint.attribute("name") or ""
            written = list(joint.find_all("hardwareInterface"))
            if not written:
                written = [
                    interface
                    for actuator in element.find_all("actuator")
                    for interface in actuator.find_all("hardwareInterface")
                ]
            commands: list[str] = []
            refused = None if several else refused_interface(element, joint)
            if refused is not None:
                offered = refused.text.strip()
                text = f'{label}: DefaultRobotHWSim does not offer "{offered}", {CONSEQUENCE}'
                unknown = devices.INTERFACE_UNKNOWN
                warn(unknown, refused, text, "error", interface=offered, stops=True)
            for interface in written:
                short = interface.text.strip().rpartition("/")[2]
                if short in _HARDWARE:
                    commands.append(_HARDWARE[short])
                elif short not in _STATES_ONLY and interface is not refused:
                    text = f'{label}: the hardware interface "{interface.text}" does not exist'
                    warn(devices.INTERFACE_UNKNOWN, interface, text, interface=interface.text)
            if not written:
                text = f"{label} has no <hardwareInterface>, so nothing drives its joint"
                warn(devices.TRANSMISSION_IGNORED, element, text, joint=name)
            if not _movable(description, name):
                text = f'{label}: "{name}" is not a movable joint'
                stopped = not several and stops(description, element, joint)
                text += f", {CONSEQUENCE}" if stopped else ""
                code = devices.TRANSMISSION_JOINT_UNKNOWN
                warn(code, element, text, joint=name, stops=stopped)
                continue
            before = by_name[name].commands if name in by_name else ()
            by_name[name] = JointInterfaces(
                name=name,
                commands=tuple(dict.fromkeys((*before, *commands))),
                origin=element.origin,
            )
    return list(by_name.values()), notes


def hardware_of(system: Element) -> str:
    """Returns the hardware plugin of a ``<ros2_control>`` tag."""
    plugin = system.find("hardware/plugin")
    return plugin.text.strip() if plugin is not None else ""


def is_plain(kind: str) -> bool:
    """Whether a ``<robotSimType>`` is the hardware of gazebo_ros_control."""
    return kind.rpartition("::")[2] in PLAIN


def is_unknown(kind: str) -> bool:
    """Whether gazebo_ros_control does not contain the ``<robotSimType>`` that names it."""
    return kind.strip().startswith(_PACKAGE) and not is_plain(kind)


def unknown_hardware(tag: PluginTag, kind: str) -> Diagnostic:
    """The diagnostic for a plugin with unknown hardware."""
    return devices.HARDWARE_UNKNOWN.diagnostic(
        f'<robotSimType>: the package "gazebo_ros_control" does not contain "{kind.strip()}", so '
        "DefaultRobotHWSim is used; Gazebo would start no controller",
        severity="error",
        origin=tag.origin,
        values={"hardware": kind.strip(), "meant": PLAIN[0], "plugin": tag.filename},
    )


def package_system(hardware: str) -> str:
    """Returns the simulated hardware in the package of a hardware plugin; empty if it has none."""
    own = {each.partition("/")[0]: each for each in SYSTEMS}
    return own.get(hardware.replace("::", "/").partition("/")[0], "")


def simulated_systems(description: RobotDescription) -> list[Element]:
    """Returns the ``<ros2_control>`` tags with simulated hardware; all tags if there are none."""
    simulated = [each for each in description.ros2_control if hardware_of(each) in SYSTEMS]
    return simulated or list(description.ros2_control)


def loaded_by(description: RobotDescription) -> frozenset[str]:
    """Returns the simulated hardware that the description's plugin of ros2_control loads."""
    names = " ".join(each.filename for each in description.plugins)
    found = (systems for name, systems in _LOADS.items() if re.search(rf"\b(lib)?{name}", names))
    return frozenset(each for systems in found for each in systems)


def ros2_control(
    description: RobotDescription,
) -> tuple[list[JointInterfaces], list[SensorInterfaces], list[Diagnostic]]:
    """Reads the joints and sensors of all ``<ros2_control>`` tags. Source: ros2_control.

    Raises:
        PluginError: A value is not a number.
    """
    joints: dict[str, JointInterfaces] = {}
    loaded: dict[str, bool] = {}
    sensors: list[SensorInterfaces] = []
    notes: list[Diagnostic] = []
    # Hardware that the plugin of this Gazebo cannot load is skipped there, so the other's joints
    # count if both list them.
    loads = loaded_by(description)
    systems = sorted(simulated_systems(description), key=lambda each: hardware_of(each) in loads)
    for system in systems:
        for element in system.find_all("joint"):
            name = element.attribute("name") or ""
            if not _movable(description, name):
                notes.append(
                    devices.ROS2_CONTROL_JOINT_UNKNOWN.diagnostic(
                        f'<ros2_control>: "{name}" is not a movable joint',
                        origin=element.origin,
                        values={"joint": name},
                    )
                )
                continue
            found = _joint(element, name, notes, in_gazebo=hardware_of(system) in SYSTEMS)
            before = joints.get(name)
            same = before is not None and (hardware_of(system) in loads) is loaded[name]
            joints[name] = _together(before, found) if before is not None and same else found
            loaded[name] = hardware_of(system) in loads
        sensors += [_sensor(element) for element in system.find_all("sensor")]
        notes += [
            devices.HARDWARE_NOT_SIMULATED.diagnostic(
                f'<gpio name="{element.attribute("name") or ""}"> has no effect: '
                "general-purpose pins are not simulated",
                origin=element.origin,
                values={"gpio": element.attribute("name")},
            )
            for element in system.find_all("gpio")
        ]
    return list(joints.values()), sensors, notes


def unknown_joints(notes: Sequence[Diagnostic]) -> tuple[str, ...]:
    """The listed joints that do not exist or do not move, from the notes about the elements."""
    codes = (devices.ROS2_CONTROL_JOINT_UNKNOWN, devices.TRANSMISSION_JOINT_UNKNOWN)
    return tuple(str(each.values["joint"]) for each in notes if each.code in codes)


def no_joints(
    listed_in: Literal["<transmission>", "<ros2_control>"], unknown: Sequence[str]
) -> str:
    """Why controllers have no joint to command.

    Args:
        listed_in: The element that lists joints.
        unknown: See `unknown_joints`.
    """
    if not unknown:
        verb = "drives" if listed_in == "<transmission>" else "element lists"
        return f"no {listed_in} {verb} a joint, so controllers have no joint to command"
    shown = 2 if len(unknown) > 3 else 3
    more = f" and {len(unknown) - shown} more" if len(unknown) > 3 else ""
    names = ", ".join(f'"{name}"' for name in unknown[:shown])
    return (
        f"none of the joints in {listed_in} is a movable joint of the robot, so controllers have "
        f"no joint to command: {names}{more}"
    )


def _together(one: JointInterfaces, other: JointInterfaces) -> JointInterfaces:
    """A joint that is listed twice. ros2_control exports the interfaces of both entries."""
    start = one.initial_position if other.initial_position is None else other.initial_position
    return JointInterfaces(
        name=one.name,
        commands=tuple(dict.fromkeys((*one.commands, *other.commands))),
        passive=tuple(dict.fromkeys((*one.passive, *other.passive))),
        states=tuple(dict.fromkeys((*one.states, *other.states))),
        initial_position=start,
        mimic=one.mimic if other.mimic is None else other.mimic,
        by_pid=other.by_pid or one.by_pid,
        gains={**one.gains, **other.gains},
        origin=one.origin,
    )


def _sensor(element: Element) -> SensorInterfaces:
    return SensorInterfaces(
        name=element.attribute("name") or "",
        states=tuple(
            state.attribute("name") or "" for state in element.find_all("state_interface")
        ),
        parameters=_parameters(element),
        origin=element.origin,
    )


def _joint(
    element: Element, name: str, notes: list[Diagnostic], *, in_gazebo: bool
) -> JointInterfaces:
    commands: list[str] = []
    passive: list[str] = []
    initial: float | None = None
    by_pid = ""
    for interface in element.find_all("command_interface"):
        written = interface.attribute("name") or ""
        kind = written.removesuffix("_pid")
        if kind not in COMMANDS:
            if not in_gazebo:
                passive.append(kind)
            notes.append(
                devices.INTERFACE_UNKNOWN.diagnostic(
                    f'the command interface "{kind}" of joint "{name}" is not simulated',
                    origin=interface.origin,
                    hint=f"Supported interfaces: {', '.join(COMMANDS)}.",
                    values={"joint": name, "interface": kind},
                )
            )
            continue
        # The tag's min and max have no effect, as in gazebo_ros2_control and gz_ros2_control.
        commands.append(kind)
        if written != kind:
            by_pid = kind
    states = []
    for interface in element.find_all("state_interface"):
        kind = interface.attribute("name") or ""
        states.append(kind)
        start = _number(_parameters(interface), "initial_value", interface, FARTHEST)
        if kind == "position" and start is not None:
            initial = start
    values = _parameters(element)
    mimic = None
    if values.get("mimic"):
        multiplier = _number(values, "multiplier", element, MOST_RATIO)
        mimic = (values["mimic"], 1.0 if multiplier is None else multiplier)
    return JointInterfaces(
        name=name,
        commands=tuple(dict.fromkeys(commands)),
        passive=tuple(dict.fromkeys(passive)),
        states=tuple(states),
        initial_position=initial,
        mimic=mimic,
        by_pid=by_pid,
        gains={
            key: number
            for key in values
            if key[:4] in ("pos_", "vel_") and (number := _number(values, key, element)) is not None
        },
        origin=element.origin,
    )


def _parameters(element: Element) -> dict[str, str]:
    return {
        param.attribute("name") or "": param.text.strip() for param in element.find_all("param")
    }


def _number(
    values: Mapping[str, str], name: str, element: Element, most: float = math.inf
) -> float | None:
    """Returns a parameter's number; None if missing or NaN, which ROS 2 uses for "not set"."""
    text = values.get(name, "")
    if not text or re.fullmatch(r"[{$].*", text):
        return None
    try:
        number = float(text)
    except ValueError:
        raise invalid(f'param name="{name}"', text, "a number", element.origin) from None
    if math.isnan(number):
        return None
    if abs(number) > most or LARGEST < abs(number) < math.inf:
        most = min(most, LARGEST)
        wanted = f"a number between {-most:g} and {most:g}"
        raise invalid(f'param name="{name}"', text, wanted, element.origin)
    return number


def _movable(description: RobotDescription, name: str) -> bool:
    joint = description.joint(name)
    return joint is not None and joint.drivable
