"""``libgazebo_mavlink_interface.so``: the interface to PX4's SITL."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import ClassVar, Literal

from cartwheel.codes import devices
from cartwheel.description.model import Element, PluginTag, Sensor
from cartwheel.devices.autopilots.channels import ChannelConfig
from cartwheel.devices.autopilots.px4 import MotorConfig, Px4, Px4Config
from cartwheel.devices.joints.pid import PidGains, limited_gains
from cartwheel.dialects.catalogue import short_name
from cartwheel.dialects.makers.flying.ports import MOST_PORT, check_address
from cartwheel.dialects.makers.flying.px4_gps import GPS_PLUGIN, gps_topics
from cartwheel.dialects.makers.flying.px4_sensors import px4_topic
from cartwheel.dialects.plugin import Plugin
from cartwheel.dialects.tags import invalid, tag

_OUTPUTS = 16
_ANY_ADDRESS = "INADDR_ANY"
_KINDS: dict[str, Literal["velocity", "position", "exact position", "message"]] = {
    "velocity": "velocity",
    "position": "position",
    "position_kinematic": "exact position",
    "position_gztopic": "message",
}
_ANOTHER_WAY = "No effect: PX4 is connected by TCP."


@dataclass(frozen=True, kw_only=True, slots=True)
class _ChannelTags:
    """The tags in ``<channel>``."""

    index: int = tag("input_index", least=0, most=_OUTPUTS - 1, doc="Index of the output.")
    offset: float = tag("input_offset", default=0.0, doc="Is added to the output.")
    scaling: float = tag("input_scaling", default=0.0, doc="Command per output.")
    disarmed: float = tag("zero_position_disarmed", default=0.0, doc="Command while disarmed.")
    armed: float = tag("zero_position_armed", default=0.0, doc="Is added to the command.")
    kind: str = tag("joint_control_type", default="velocity", doc="Quantity of the command.")
    joint: str = tag("joint_name", default="", role="joint", doc="Joint to drive.")
    topic: str = tag("gztopic", default="", doc="Topic of the command.")
    pid: str = tag("joint_control_pid", default="", nested=True, doc="Gains.")


@dataclass(frozen=True, kw_only=True, slots=True)
class _PidTags:
    """The tags in ``<joint_control_pid>``."""

    p: float = tag("p", default=0.0, doc="Proportional gain.")
    i: float = tag("i", default=0.0, doc="Integral gain.")
    d: float = tag("d", default=0.0, doc="Derivative gain.")
    i_max: float = tag("iMax", default=0.0, doc="Maximum of the integral term.")
    i_min: float = tag("iMin", default=0.0, doc="Minimum of the integral term.")
    cmd_max: float = tag("cmdMax", default=0.0, doc="Maximum effort.")
    cmd_min: float = tag("cmdMin", default=0.0, doc="Minimum effort.")
    most_error: float = tag("errMax", default=0.0, least=0.0, doc="Maximum position error.")


@dataclass(frozen=True, kw_only=True, slots=True)
class Px4Parameters:
    address: str = tag(
        "mavlink_addr",
        default=_ANY_ADDRESS,
        doc="Address on which PX4 connects. Only loopback addresses are supported: for any other "
        "address, PX4 connects to 127.0.0.1.",
    )
    port: int = tag(
        "mavlink_tcp_port",
        default=4560,
        least=1,
        most=MOST_PORT,
        role="tcp_port",
        doc="TCP port to which PX4 connects.",
    )
    use_tcp: bool = tag(
        "use_tcp",
        default=False,
        doc="Must be true: the connection by UDP, which old versions of PX4 use, is not supported.",
    )
    lock_step: bool = tag(
        "enable_lockstep",
        default=False,
        doc="Whether each step waits for PX4's controls while PX4 is armed, for up to 0.1 s.",
    )
    imu_topic: str = tag("imuSubTopic", default="/imu", doc="Topic of the IMU.")
    field_topic: str = tag("magSubTopic", default="/mag", doc="Topic of the magnetometer.")
    pressure_topic: str = tag("baroSubTopic", default="/baro", doc="Topic of the barometer.")
    truth_topic: str = tag(
        "groundtruthSubTopic", default="/groundtruth", doc="Topic of the true position."
    )
    motor_topic: str = tag(
        "motorSpeedCommandPubTopic",
        default="/gazebo/command/motor_speed",
        doc="Topic of the motors' speeds (Actuators).",
    )
    controls: str = tag(
        "control_channels",
        default="",
        nested=True,
        doc="Contains a `<channel>` for each output. The tags inside are `<input_index>` (0 to "
        "15), `<input_offset>`, `<input_scaling>`, `<zero_position_disarmed>`, "
        "`<zero_position_armed>`, `<joint_control_type>` (`velocity`, `position`, "
        "`position_kinematic` or `position_gztopic`), `<joint_name>`, `<gztopic>`, and "
        "`<joint_control_pid>` with `<p>`, `<i>`, `<d>`, `<iMax>`, `<iMin>`, `<cmdMax>`, "
        "`<cmdMin>` and `<errMax>`.",
    )
    hil_mode: bool = tag(
        "hil_mode", default=False, doc="Must be false: hardware in the loop is not supported."
    )
    serial: bool = tag(
        "serialEnabled", default=False, doc="Must be false: serial ports are not supported."
    )
    hil_level: bool = tag("hil_state_level", default=False, doc="No effect without `<hil_mode>`.")
    udp_port: str = tag("mavlink_udp_port", default="", doc=_ANOTHER_WAY)
    device: str = tag("serialDevice", default="", doc=_ANOTHER_WAY)
    baud_rate: str = tag("baudRate", default="", doc=_ANOTHER_WAY)
    ground_address: str = tag("qgc_addr", default="", doc="No effect without `<hil_mode>`.")
    ground_port: str = tag("qgc_udp_port", default="", doc="No effect without `<hil_mode>`.")
    sdk_address: str = tag("sdk_addr", default="", doc="No effect without `<hil_mode>`.")
    sdk_port: str = tag("sdk_udp_port", default="", doc="No effect without `<hil_mode>`.")
    imu_rate: str = tag("imu_rate", default="", doc="No effect, as in Gazebo.")
    odometry: bool = tag(
        "send_odometry", default=False, doc="No effect: visual odometry is not supported."
    )
    vision: bool = tag(
        "send_vision_estimation", default=False, doc="No effect: visual odometry is not supported."
    )
    vision_topic: str = tag(
        "visionSubTopic", default="", doc="No effect: visual odometry is not supported."
    )
    flow_topic: str = tag(
        "opticalFlowSubTopic", default="", doc="No effect: optical flow is not supported."
    )
    lock_topic: str = tag("irlockSubTopic", default="", doc="No effect: IR-LOCK is not supported.")


class Px4Interface(Plugin[Px4Parameters]):
    """Connects the model to PX4's SITL, which then drives its motors and joints.

    PX4 connects to a TCP port and exchanges MAVLink 2 messages. At 250 Hz, the plugin sends
    HIL_SENSOR with the measurements of ``libgazebo_imu_plugin.so``,
    ``libgazebo_magnetometer_plugin.so`` and ``libgazebo_barometer_plugin.so``, and
    HIL_STATE_QUATERNION with the true state. It sends HIL_GPS for each
    ``libgazebo_gps_plugin.so``, 0.12 s after the measurement, and HEARTBEAT and SYSTEM_TIME once
    per second. It receives HIL_ACTUATOR_CONTROLS.

    While PX4 is armed, the command of a channel is ``(output + input_offset) * input_scaling +
    zero_position_armed``; otherwise, it is ``zero_position_disarmed``. The commands of all channels
    are published as speeds of the motors. If the model has the joint of a channel, the channel also
    drives this joint: with ``position`` and ``velocity`` by a PID controller.

    Only the program that connected first can control the vehicle, until it closes the connection.
    The motors then stop. [PX4 and ArduPilot SITL](../how-to/sitl.md) describes both sides. Original
    plugin: ``gazebo_mavlink_interface`` in ``PX4-SITL_gazebo-classic``.
    """

    filenames: ClassVar[tuple[str, ...]] = ("libgazebo_mavlink_interface.so",)

    def configure(self) -> None:
        config = self.config
        if config.address.strip() != _ANY_ADDRESS:
            check_address(self, "mavlink_addr", config.address, program="PX4")
        self._check_connection()
        motors, channels, disarmed = self._channels()
        self.add(
            Px4(
                self.scope,
                Px4Config(
                    port=config.port,
                    link=self.part.description.canonical_link,
                    lock_step=config.lock_step,
                    imu_topic=px4_topic(self, config.imu_topic),
                    field_topic=px4_topic(self, config.field_topic),
                    pressure_topic=px4_topic(self, config.pressure_topic),
                    truth_topic=px4_topic(self, config.truth_topic),
                    fix_topics=self._receivers(),
                    motor_topic=px4_topic(self, config.motor_topic),
                    motors=motors,
                    channels=channels,
                    disarmed=disarmed,
                ),
            )
        )

    def _check_connection(self) -> None:
        config = self.config
        for name, wrong in (
            ("use_tcp", not config.use_tcp),
            ("serialEnabled", config.serial),
            ("hil_mode", config.hil_mode),
        ):
            if wrong:
                right = "true" if name == "use_tcp" else "false"
                self.warn(
                    devices.PLUGIN_PARAMETER_UNSUPPORTED,
                    f"<{name}> must be {right}: PX4 connects only by TCP, to port {config.port}",
                    at=self.place_of(name),
                    hint=f"Write <{name}>{right}</{name}>.",
                    values={"parameter": name, "value": str(name != "use_tcp").lower()},
                )

    def _receivers(self) -> tuple[tuple[str, str], ...]:
        """Returns the topics of the satellite receivers."""

        def of_gps(plugin: PluginTag) -> bool:
            return short_name(plugin.filename) == short_name(GPS_PLUGIN)

        found: list[tuple[Sensor, PluginTag]] = [
            (sensor, plugin)
            for link in self.part.description.links
            for sensor in link.sensors
            for plugin in sensor.plugins
            if of_gps(plugin)
        ]
        return tuple(gps_topics(self.part.name, sensor, plugin) for sensor, plugin in found)

    def _channels(
        self,
    ) -> tuple[tuple[MotorConfig, ...], tuple[ChannelConfig, ...], tuple[float, ...]]:
        """Returns the motors, the channels that drive joints, and the latter's disarmed commands.

        Raises:
            PluginError: A value is invalid, or two channels have the same index.
        """
        motors: dict[int, MotorConfig] = {}
        channels, disarmed = [], []
        group = self.tag.element.find("control_channels")
        for element in group.find_all("channel") if group is not None else ():
            config = self.read_tags(_ChannelTags, element)
            if config.index in motors:
                wanted = "a different number for each channel"
                raise invalid("input_index", config.index, wanted, element.origin)
            motors[config.index] = MotorConfig(
                number=config.index,
                scale=config.scaling,
                offset=config.offset,
                armed=config.armed,
                disarmed=config.disarmed,
            )
            channel = self._channel(config, element)
            if channel is not None:
                channels.append(channel)
                disarmed.append(config.disarmed)
        if not motors:
            self.warn(devices.PLUGIN_IDLE, "the plugin has no <channel>, so it drives nothing")
        return tuple(motors.values()), tuple(channels), tuple(disarmed)

    def _channel(self, config: _ChannelTags, element: Element) -> ChannelConfig | None:
        """Returns the channel that drives a joint or publishes a message; None: it does not.

        Raises:
            PluginError: The type of the command is unknown.
        """
        kind = _KINDS.get(config.kind.strip())
        if kind is None:
            wanted = f"one of {', '.join(_KINDS)}"
            raise invalid("joint_control_type", config.kind, wanted, element.origin)
        joint = config.joint.strip()
        names = [each.name for each in self.part.description.joints if each.drivable]
        if kind != "message" and joint not in names:
            if joint:
                # As in Gazebo: PX4's models contain channels for the joints of other models.
                self.warn(
                    devices.PLUGIN_JOINT_UNKNOWN,
                    f"channel {config.index} drives no joint because the model has no movable "
                    f'joint "{joint}"',
                    at=element.origin,
                    severity="info",
                    values={"joint": joint},
                )
            return None
        pid = element.find("joint_control_pid")
        gains = self.read_tags(_PidTags, pid) if pid is not None else _PidTags()
        default = f"control_position_gztopic_{config.index}"
        return ChannelConfig(
            number=config.index,
            joint=joint,
            kind=kind,
            topic=px4_topic(self, config.topic.strip() or default),
            gains=_gains(gains) if kind in ("velocity", "position") else None,
            multiplier=config.scaling,
            offset=config.offset,
            constant=config.armed,
            most_error=gains.most_error or math.inf,
        )


def _gains(config: _PidTags) -> PidGains:
    return limited_gains(
        config.p,
        config.i,
        config.d,
        integral=(config.i_min, config.i_max),
        output=(config.cmd_min, config.cmd_max),
    )
