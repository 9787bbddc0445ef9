"""A vehicle that ArduPilot's SITL controls."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

from cartwheel.codes import wires
from cartwheel.component import Component, Scope
from cartwheel.devices.autopilots.ardupilot_packets import (
    LONGEST,
    ServoPacket,
    VehicleState,
    encode_binary,
    encode_json,
)
from cartwheel.devices.autopilots.channels import Channel, ChannelConfig
from cartwheel.devices.autopilots.conversation import Conversation
from cartwheel.devices.autopilots.datagrams import HOST, DatagramPort
from cartwheel.devices.autopilots.reports import Reports
from cartwheel.devices.inertial.unit import InertialUnit, InertialUnitConfig
from cartwheel.devices.periodic import Elapsed
from cartwheel.geometry import Pose, rotate

_SCAN = "sensor_msgs/msg/LaserScan"
_NO_RANGE = -1.0
"""Distance of a rangefinder that has not measured yet, m."""


@dataclass(frozen=True, kw_only=True, slots=True)
class ArduPilotConfig:
    port: int
    """UDP port on which the packets arrive."""
    unit: InertialUnitConfig
    """The IMU. The position, velocity and orientation are those of its link."""
    channels: tuple[ChannelConfig, ...]
    """Joints that the autopilot drives."""
    lock_step: bool = False
    """Whether each step waits for a packet."""
    time_sync: bool = False
    """Whether SITL synchronises itself with the wall clock."""
    most_missed: int = 10
    """Number of waits of 10 ms without a packet that are allowed; see `Conversation`."""
    to_north_east_down: Pose = Pose()  # noqa: RUF009 - frozen
    """Pose of the simulation's world in the autopilot's world, whose axes are north, east, down."""
    body: Pose = Pose()  # noqa: RUF009 - frozen
    """Pose of the autopilot's body, whose axes are forward, right, down, in the link."""
    range_topics: tuple[str, ...] = ()
    """Topics (LaserScan) of the rangefinders."""


class ArduPilot(Component):
    """Drives joints as ArduPilot commands, and sends it the vehicle's state at every step.

    The port is opened at the first step. If it cannot be opened, this is reported, and the joints
    are not driven.

    Raises:
        UnknownNameError: A joint or the link of the IMU does not exist.
    """

    _unsaved = frozenset({"_autopilot", "_is_open"})

    def __init__(self, scope: Scope, config: ArduPilotConfig) -> None:
        super().__init__(scope)
        part = self.part
        self._config = config
        self._unit = InertialUnit(part, config.unit, origin=self.origin)
        self._link = part.link(config.unit.link, origin=self.origin)
        self._channels = [self.add(Channel(scope, channel)) for channel in config.channels]
        self._ranges = [_NO_RANGE] * len(config.range_topics)
        for index, topic in enumerate(config.range_topics):
            self.subscribe(topic, _SCAN, self._range_reader(index), unset=True)
        self._elapsed = Elapsed()
        self._binary = False
        self._autopilot: Conversation | None = None
        self._is_open = False
        part.schedule(0, before=self._control)
        part.schedule(0, after=self._send_state, active=lambda: self._connected)

    def reset(self) -> None:
        super().reset()
        self._elapsed = Elapsed()
        self._ranges = [_NO_RANGE] * len(self._ranges)

    def _range_reader(self, index: int) -> Any:
        def on_scan(scan: Any) -> None:
            self._ranges[index] = nearest(scan)

        return on_scan

    @property
    def _connected(self) -> bool:
        return self._autopilot is not None and self._autopilot.connected

    def _open_port(self) -> None:
        """Opens the port: at the first step, so that a model that is only loaded opens none."""
        self._is_open = True
        config = self._config
        try:
            port = DatagramPort(config.port, longest=LONGEST)
        except OSError as error:
            self.warn(
                wires.ADDRESS_UNAVAILABLE,
                f"ArduPilot cannot connect because port {config.port} cannot be opened: "
                f"{error.strerror}",
                hint="Give each vehicle a different port in <fdm_port_in>.",
                values={"host": HOST, "port": config.port},
            )
            return
        self._autopilot = self.keep(
            Conversation(
                port,
                lock_step=config.lock_step,
                most_missed=config.most_missed,
                reports=Reports(self.part.report, title=self.title, origin=self.origin),
            )
        )

    def _control(self) -> None:
        if not self._is_open:
            self._open_port()
        packet = self._autopilot.next() if self._autopilot is not None else None
        if packet is not None:
            self.part.count_command()
            self._set_outputs(packet)
        elif not self._connected:
            for channel in self._channels:
                channel.switch_off()
        seconds = self._elapsed.seconds(self.part.time_ns)
        for channel in self._channels:
            channel.drive(seconds)

    def _set_outputs(self, packet: ServoPacket) -> None:
        self._binary = packet.protocol == "binary"
        for channel in self._channels:
            number = channel.config.number
            if number >= len(packet.outputs):
                channel.switch_off()
            elif self._binary:
                channel.set_output(packet.outputs[number])
            else:
                channel.set_pulse(packet.outputs[number])

    def _send_state(self) -> None:
        config, autopilot = self._config, self._autopilot
        assert autopilot is not None
        _, rates, acceleration = self._unit.measure()
        world = config.to_north_east_down
        linear, _ = self._link.motion(local=False)
        state = VehicleState(
            seconds=self.part.seconds,
            rates=rates,
            acceleration=acceleration,
            pose=world @ self._link.pose @ config.body,
            velocity=rotate(world.orientation, linear),
            ranges=self._ranges,
        )
        autopilot.send(
            encode_binary(state)
            if self._binary
            else encode_json(state, time_sync=config.time_sync, lock_step=config.lock_step)
        )


def nearest(scan: Any) -> float:
    """Returns the smallest distance in a LaserScan, m; without one, twice the maximum range."""
    ranges = [float(each) for each in scan.ranges]
    near = [float(scan.range_min) if each == -math.inf else each for each in ranges]
    nothing = 2.0 * float(scan.range_max)
    return min((each for each in near if math.isfinite(each)), default=nothing)
