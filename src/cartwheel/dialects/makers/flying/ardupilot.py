"""``ArduPilotPlugin``: the interface to ArduPilot's SITL."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import ClassVar, Literal

from cartwheel.codes import devices
from cartwheel.description.model import Element, Sensor
from cartwheel.devices.autopilots.ardupilot import ArduPilot, ArduPilotConfig
from cartwheel.devices.autopilots.channels import ChannelConfig
from cartwheel.devices.autopilots.datagrams import HOST
from cartwheel.devices.joints.pid import PidGains, limited_gains
from cartwheel.dialects.gz.drive_tags import gz_name
from cartwheel.dialects.makers.flying.ports import MOST_PORT, check_address
from cartwheel.dialects.plugin import Plugin
from cartwheel.dialects.sdf.imu import read_inertial_unit
from cartwheel.dialects.tags import SMALLEST, invalid, missing, tag, vector
from cartwheel.errors import PluginError, UnknownNameError
from cartwheel.geometry import Pose

_MOST_RANGES = 6
"""Rangefinders that ArduPilot's JSON interface supports."""
_KINDS: dict[str, Literal["velocity", "position", "effort", "message"]] = {
    "VELOCITY": "velocity",
    "POSITION": "position",
    "EFFORT": "effort",
    "COMMAND": "message",
}
_DIRECTIONS = {"cw": -1.0, "ccw": 1.0}


@dataclass(frozen=True, kw_only=True, slots=True)
class _ControlTags:
    """The tags in ``<control>``; the older spellings are those of the plugin for Classic."""

    joint: str = tag("jointName", role="joint", doc="Joint to drive.")
    kind: str = tag("type", default="VELOCITY", doc="Quantity that is controlled.")
    force: bool = tag("useForce", default=True, doc="Whether a PID controller applies an effort.")
    topic: str = tag("cmd_topic", default="", doc="Topic of the command.")
    multiplier: float = tag("multiplier", default=1.0, doc="Command per output.")
    direction: str = tag("turningDirection", default="", doc="Older form of the multiplier.")
    offset: float = tag("offset", default=0.0, doc="Is added to the output.")
    low: float = tag("servo_min", default=1000.0, doc="Pulse width of the output 0.")
    high: float = tag("servo_max", default=2000.0, doc="Pulse width of the output 1.")
    slowdown: float = tag("rotorVelocitySlowdownSim", default=1.0, doc="Ratio of velocities.")
    p: float = tag("p_gain", "vel_p_gain", default=0.1, doc="Proportional gain.")
    i: float = tag("i_gain", "vel_i_gain", default=0.0, doc="Integral gain.")
    d: float = tag("d_gain", "vel_d_gain", default=0.0, doc="Derivative gain.")
    i_max: float = tag("i_max", "vel_i_max", default=0.0, doc="Maximum of the integral term.")
    i_min: float = tag("i_min", "vel_i_min", default=0.0, doc="Minimum of the integral term.")
    cmd_max: float = tag("cmd_max", "vel_cmd_max", default=1.0, doc="Maximum effort.")
    cmd_min: float = tag("cmd_min", "vel_cmd_min", default=-1.0, doc="Minimum effort.")


_NO_EFFECT = ("frequencyCutoff", "samplingRate", "controlVelocitySlowdownSim")
"""Tags in ``<control>`` without an effect in Gazebo."""


@dataclass(frozen=True, kw_only=True, slots=True)
class _RangeTags:
    """The tags in ``<sensor>``."""

    kind: str = tag("type", default="", doc="No effect, as in Gazebo.")
    index: int = tag("index", doc="Number of the rangefinder, from 1 to 6.")
    topic: str = tag("topic", doc="Topic of its LaserScan messages.")


@dataclass(frozen=True, kw_only=True, slots=True)
class ArduPilotParameters:
    address: str = tag(
        "fdm_addr",
        default=HOST,
        doc="Address on which packets are received. Only loopback addresses are supported: for "
        "any other address, the plugin receives packets on 127.0.0.1.",
    )
    port: int = tag(
        "fdm_port_in",
        default=9002,
        least=1,
        most=MOST_PORT,
        role="udp_port",
        doc="UDP port on which packets are received.",
    )
    listen: str = tag("listen_addr", default="", doc="No effect, as in Gazebo.")
    port_out: str = tag(
        "fdm_port_out",
        default="",
        doc="No effect, as in gz-sim: the state is sent to the port from which SITL sends.",
    )
    most_missed: int = tag(
        "connectionTimeoutMaxCount",
        default=10,
        doc="Number of waits of 10 ms for a packet after which, without `<lock_step>`, the "
        "connection is lost. With `<lock_step>`, the last state is sent again.",
    )
    lock_step: bool = tag(
        "lock_step",
        default=False,
        doc="Whether the simulation waits for a packet at each step, for up to 1 s.",
    )
    no_time_sync: bool = tag(
        "no_time_sync",
        default=True,
        doc="Whether SITL is asked not to synchronise itself with the wall clock.",
    )
    wide: bool = tag(
        "have_32_channels",
        default=False,
        doc="No effect: packets with 16 and with 32 channels are recognised by their length.",
    )
    to_body: str = tag(
        "modelXYZToAirplaneXForwardZDown",
        default="0 0 0 3.141592653589793 0 0",
        doc="Pose of the body with the axes forward, right, down in the link of the IMU.",
    )
    to_world: str = tag(
        "gazeboXYZToNED",
        default="0 0 0 3.141592653589793 0 0",
        doc="Pose of the world with the axes north, east, down in the simulated world.",
    )
    imu: str = tag(
        "imuName",
        default="imu_sensor",
        doc="Name of the IMU sensor, which may be preceded by the names of models and the link, "
        "as in `drone::imu_link::imu_sensor`.",
    )
    controls: str = tag(
        "control",
        "rotor",
        default="",
        nested=True,
        doc="An output channel. The attribute `channel` is its zero-based number. The tags inside "
        "are `<jointName>`, `<type>` (`VELOCITY`, `POSITION`, `EFFORT` or `COMMAND`), "
        "`<multiplier>`, `<offset>`, `<servo_min>` and `<servo_max>` (in µs), `<useForce>`, "
        "`<cmd_topic>`, `<rotorVelocitySlowdownSim>`, and the gains and limits of the PID "
        "controller: `<p_gain>`, `<i_gain>`, `<d_gain>`, `<i_max>`, `<i_min>`, `<cmd_max>` and "
        "`<cmd_min>`. Repeat the tag for each channel.",
    )
    rangefinders: str = tag(
        "sensor",
        default="",
        nested=True,
        doc="A rangefinder. The tags inside are `<index>` (1 to 6) and `<topic>`, the topic of "
        "its LaserScan messages. Repeat the tag for each rangefinder.",
    )


class ArduPilotPlugin(Plugin[ArduPilotParameters]):
    """Connects the model to ArduPilot's SITL, which then drives its joints.

    The plugin receives the outputs of the autopilot's channels on a UDP port, and sends back the
    state of the IMU's link at each step. The length of a packet determines the interface: SITL's
    model ``JSON`` sends 16 or 32 pulse widths, and its model ``gazebo-iris`` sends 16 numbers. A
    pulse width between ``<servo_min>`` and ``<servo_max>`` becomes an output between 0 and 1. The
    command of a channel is ``multiplier * (output + offset)``. With the type ``VELOCITY`` or
    ``POSITION``, a PID controller moves the joint. With ``EFFORT``, the command is the joint's
    effort. With ``COMMAND``, it is published on ``<cmd_topic>`` (Float64). A pulse width of 0
    switches the channel off.

    Only the program that connected first can control the vehicle, until it sends no packets for
    the time described at ``<connectionTimeoutMaxCount>``. The joints are then no longer driven.
    [ArduPilot SITL](../how-to/sitl.md) describes both sides. Original plugins:
    ``ArduPilotPlugin`` in the repositories ``ArduPilot/ardupilot_gazebo`` and
    ``khancyr/ardupilot_gazebo``.
    """

    filenames: ClassVar[tuple[str, ...]] = ("ArduPilotPlugin", "libArduPilotPlugin.so")

    def configure(self) -> None:
        config, element = self.config, self.tag.element
        check_address(self, "fdm_addr", config.address, program="SITL")
        self.check_not_negative("most_missed")
        controls = tuple(element.find_all("control")) or tuple(element.find_all("rotor"))
        if not controls:
            self.warn(devices.PLUGIN_IDLE, "the plugin has no <control>, so no joint is driven")
        self.add(
            ArduPilot(
                self.scope,
                ArduPilotConfig(
                    port=config.port,
                    unit=read_inertial_unit(self.part, self._imu()),
                    channels=tuple(
                        self._channel(each, number) for number, each in enumerate(controls)
                    ),
                    lock_step=config.lock_step,
                    time_sync=not config.no_time_sync,
                    most_missed=config.most_missed,
                    to_north_east_down=self._pose("to_world").inverse(),
                    body=self._pose("to_body"),
                    range_topics=self._range_topics(),
                ),
            )
        )

    def _imu(self) -> Sensor:
        """Returns the IMU sensor.

        Raises:
            UnknownNameError: The model has no such sensor.
        """
        name = self.config.imu.strip()
        sensors = {
            f"{self.part.description.name}::{link.name}::{sensor.name}": sensor
            for link in self.part.description.links
            for sensor in link.sensors
            if sensor.type == "imu"
        }
        for full, sensor in sensors.items():
            if f"::{full}".endswith(f"::{name}"):
                return sensor
        raise UnknownNameError(
            "IMU sensor",
            name,
            [sensor.name for sensor in sensors.values()],
            code=devices.PLUGIN_PARAMETER_INVALID,
            origin=self.place_of("imuName"),
        )

    def _channel(self, element: Element, place: int) -> ChannelConfig:
        """Reads a ``<control>``.

        Args:
            element: The element.
            place: Its place among the controls, which is the channel without an attribute.

        Raises:
            PluginError: A value is invalid.
        """
        config = self.read_tags(_ControlTags, element, ignore=_NO_EFFECT)
        stated = element.attribute("channel") or element.attribute("id") or str(place)
        if not stated.strip().isdecimal() or int(stated) >= 32:
            raise invalid("control", stated, "the number of a channel from 0 to 31", element.origin)
        kind = _KINDS.get(config.kind.strip())
        if kind is None:
            raise invalid("type", config.kind, f"one of {', '.join(_KINDS)}", element.origin)
        if config.high - config.low < SMALLEST:
            raise PluginError(
                f"<servo_max> must exceed <servo_min> (got {config.high:g} and {config.low:g})",
                code=devices.PLUGIN_RANGE_REVERSED,
                origin=element.origin,
                values={"parameter": "servo_min", "value": config.low, "most": config.high},
            )
        joint = config.joint.strip()
        if kind == "position" and not config.force:
            self.warn(
                devices.PLUGIN_PARAMETER_UNSUPPORTED,
                f'joint "{joint}" is not driven because <type> POSITION requires <useForce>',
                at=element.origin,
                values={"parameter": "useForce", "value": "false"},
            )
        default = f"/world/{self.part.world.name}/model/{self.part.name}/joint/{joint}/cmd"
        return ChannelConfig(
            number=int(stated),
            joint=joint,
            kind=kind,
            topic=gz_name(self, config.topic.strip() or default.replace("::", "/"), ""),
            gains=_gains(config) if config.force and kind in ("velocity", "position") else None,
            low=config.low,
            high=config.high,
            multiplier=_multiplier(config, element),
            offset=config.offset,
            slowdown=config.slowdown if abs(config.slowdown) >= SMALLEST else 1.0,
        )

    def _pose(self, field: str) -> Pose:
        """Returns the pose in a tag.

        Raises:
            PluginError: The tag does not contain six numbers.
        """
        name = {"to_body": "modelXYZToAirplaneXForwardZDown", "to_world": "gazeboXYZToNED"}[field]
        element = self.tag.element.find(name)
        if element is None:
            return Pose.from_xyz_rpy((0, 0, 0), (math.pi, 0, 0))
        x, y, z, *angles = vector(element, 6)
        if (element.attribute("degrees") or "").strip().lower() in ("true", "1"):
            angles = [math.radians(angle) for angle in angles]
        return Pose.from_xyz_rpy((x, y, z), angles)

    def _range_topics(self) -> tuple[str, ...]:
        """Returns the topics of the rangefinders, in the order of their numbers.

        Raises:
            PluginError: A number is missing or used twice.
        """
        topics: dict[int, str] = {}
        for element in self.tag.element.find_all("sensor"):
            config = self.read_tags(_RangeTags, element)
            if not 1 <= config.index <= _MOST_RANGES or config.index in topics:
                wanted = f"a different number from 1 to {_MOST_RANGES} for each rangefinder"
                raise invalid("index", config.index, wanted, element.origin)
            topics[config.index] = gz_name(self, config.topic, "")
        for index in range(1, len(topics) + 1):
            if index not in topics:
                raise missing("plugin", f"sensor with the <index> {index}", self.tag.origin)
        return tuple(topics[index] for index in sorted(topics))


def _gains(config: _ControlTags) -> PidGains:
    return limited_gains(
        config.p,
        config.i,
        config.d,
        integral=(config.i_min, config.i_max),
        output=(config.cmd_min, config.cmd_max),
    )


def _multiplier(config: _ControlTags, element: Element) -> float:
    """Returns the multiplier, which ``<turningDirection>`` replaces in older files.

    Raises:
        PluginError: The direction is neither cw, ccw nor a number.
    """
    direction = element.find("turningDirection")
    if element.find("multiplier") is not None or direction is None:
        return config.multiplier
    word = config.direction.strip()
    if word in _DIRECTIONS:
        return _DIRECTIONS[word]
    return vector(direction, 1)[0]
