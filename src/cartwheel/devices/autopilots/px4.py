"""A vehicle that PX4's SITL controls."""

from __future__ import annotations

from collections import deque
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

from cartwheel.codes import devices, wires
from cartwheel.component import Component, Scope
from cartwheel.devices.air.propeller import ACTUATORS
from cartwheel.devices.autopilots.channels import Channel, ChannelConfig
from cartwheel.devices.autopilots.datagrams import HOST
from cartwheel.devices.autopilots.frames import TO_FORWARD_RIGHT_DOWN, TO_NORTH_EAST_DOWN
from cartwheel.devices.autopilots.mavlink import (
    Controls,
    Fix,
    Measurements,
    Truth,
    encode_gps,
    encode_heartbeat,
    encode_sensor,
    encode_time,
    encode_truth,
)
from cartwheel.devices.autopilots.px4_link import Px4Link
from cartwheel.devices.autopilots.reports import Reports
from cartwheel.devices.autopilots.streams import StreamPort
from cartwheel.devices.periodic import Elapsed, Periodic
from cartwheel.devices.position.barometer import LAPSE, TEMPERATURE, height_at
from cartwheel.geometry import Array, Vec3, quat_conjugate, quat_multiply, rotate
from cartwheel.messages import header, message_class

RATE = 250.0
"""Rate of the states, Hz, which PX4 requires."""
_GAUSS = 1e4
"""Gauss per T."""
_ZERO_CELSIUS = 273.15
_DELAY_US = 120_000
"""Age of a position when PX4 receives it, as in Gazebo."""
_OUTPUTS = 16
_NOWHERE = (0.0, 0.0, 0.0)


@dataclass(frozen=True, kw_only=True, slots=True)
class MotorConfig:
    """An output that is a speed of a motor, rad/s."""

    number: int
    """Index of the output, and of the speed in the command."""
    scale: float
    """Speed per output, rad/s."""
    offset: float
    """Is added to the output before the multiplication."""
    armed: float
    """Is added to the speed while PX4 is armed, rad/s."""
    disarmed: float
    """Speed while PX4 is disarmed, rad/s."""


@dataclass(frozen=True, kw_only=True, slots=True)
class Px4Config:
    port: int
    """TCP port to which PX4 connects."""
    link: str
    """Link whose true state is sent."""
    lock_step: bool = False
    """Whether a step waits for PX4's controls while PX4 is armed."""
    imu_topic: str
    """Topic of the IMU (Imu). Its axes are forward, left, up."""
    field_topic: str
    """Topic of the magnetometer (MagneticField). Its axes are forward, left, up."""
    pressure_topic: str
    """Topic of the barometer (FluidPressure)."""
    truth_topic: str
    """Topic of the true position (NavSatFix)."""
    fix_topics: tuple[tuple[str, str], ...] = ()
    """Topics of the position (NavSatFix) and velocity (Vector3Stamped) of each receiver."""
    motor_topic: str
    """Topic of the motors' speeds (Actuators)."""
    motors: tuple[MotorConfig, ...] = ()
    """Outputs that are speeds of motors."""
    channels: tuple[ChannelConfig, ...] = ()
    """Outputs that drive joints."""
    disarmed: tuple[float, ...] = ()
    """Command of each channel while PX4 is disarmed."""


class Px4(Component):
    """Drives motors and joints as PX4 commands, and sends it what the sensors measure.

    The port is opened at the first step. If it cannot be opened, this is reported, and the motors
    and joints are not driven.

    Raises:
        UnknownNameError: A joint or the link does not exist.
    """

    _unsaved = frozenset({"_vehicle", "_is_open"})

    def __init__(self, scope: Scope, config: Px4Config) -> None:
        super().__init__(scope)
        part = self.part
        self._config = config
        self._link = part.link(config.link, origin=self.origin)
        self._channels = [self.add(Channel(scope, channel)) for channel in config.channels]
        self._motors = self.advertise(config.motor_topic, ACTUATORS)
        self._Actuators = message_class(ACTUATORS)
        self._vehicle: Px4Link | None = None
        self._is_open = False
        self._forget()
        self._listen()
        part.schedule(RATE, before=self._step)

    def reset(self) -> None:
        super().reset()
        self._forget()

    def _forget(self) -> None:
        self._measured: dict[str, Any] = {}
        self._place: Vec3 = _NOWHERE
        self._velocity: Vec3 | None = None
        self._places: dict[int, Vec3] = {}
        self._fixes: deque[Fix] = deque()
        self._elapsed = Elapsed()
        self._each_second = Periodic(1.0)
        self._drives = False

    def _listen(self) -> None:
        """Subscribes to the sensors."""
        config = self._config
        for name, topic, kind in (
            ("imu", config.imu_topic, "Imu"),
            ("field", config.field_topic, "MagneticField"),
            ("pressure", config.pressure_topic, "FluidPressure"),
        ):
            self.subscribe(topic, f"sensor_msgs/msg/{kind}", self._keeper(name))
        self.subscribe(config.truth_topic, "sensor_msgs/msg/NavSatFix", self._on_truth)
        for number, (fix, velocity) in enumerate(config.fix_topics):
            self.subscribe(fix, "sensor_msgs/msg/NavSatFix", self._fix_reader(number))
            self.subscribe(
                velocity, "geometry_msgs/msg/Vector3Stamped", self._velocity_reader(number)
            )

    def _keeper(self, name: str) -> Callable[[Any], None]:
        def keep(message: Any) -> None:
            self._measured[name] = message

        return keep

    def _on_truth(self, fix: Any) -> None:
        self._place = (fix.latitude, fix.longitude, fix.altitude)

    def _fix_reader(self, number: int) -> Callable[[Any], None]:
        def on_fix(message: Any) -> None:
            self._places[number] = (message.latitude, message.longitude, message.altitude)

        return on_fix

    def _velocity_reader(self, number: int) -> Callable[[Any], None]:
        def on_velocity(message: Any) -> None:
            # A receiver publishes the velocity after the position of the same moment.
            place = self._places.get(number)
            if place is None or not self._connected:
                return
            now, velocity = self.part.time_ns, message.vector
            self._fixes.append(
                Fix(
                    time_us=now // 1000,
                    place=place,
                    velocity=(velocity.y, velocity.x, -velocity.z),
                    receiver=number,
                )
            )

        return on_velocity

    @property
    def _connected(self) -> bool:
        return self._vehicle is not None and self._vehicle.connected

    def _open_port(self) -> None:
        """Opens the port: at the first step, so that a model that is only loaded opens none."""
        self._is_open = True
        config = self._config
        physics = 1e9 / self.part.period_ns(0)
        if physics < RATE:
            self.warn(
                devices.RATE_ABOVE_PHYSICS,
                f"PX4 requires {RATE:g} states per second, but the physics rate is {physics:g} Hz",
                hint=f"Set <max_step_size> of the world to {1 / RATE:g}.",
                values={"rate": RATE, "physics": physics},
            )
        try:
            port = StreamPort(config.port)
        except OSError as error:
            self.warn(
                wires.ADDRESS_UNAVAILABLE,
                f"PX4 cannot connect because port {config.port} cannot be opened: {error.strerror}",
                hint="Give each vehicle a different port in <mavlink_tcp_port>.",
                values={"host": HOST, "port": config.port},
            )
            return
        reports = Reports(self.part.report, title=self.title, origin=self.origin)
        self._vehicle = self.keep(Px4Link(port, lock_step=config.lock_step, reports=reports))

    def _step(self) -> None:
        if not self._is_open:
            self._open_port()
        vehicle, seconds = self._vehicle, self._elapsed.seconds(self.part.time_ns)
        if vehicle is None:
            return
        if vehicle.connected:
            self._send(vehicle, seconds)
        controls = vehicle.next()
        if controls is not None:
            self.part.count_command()
            self._drives = True
            self._command(controls)
        elif self._drives and not vehicle.connected:
            self._switch_off()
        for channel in self._channels:
            channel.drive(seconds)

    def _command(self, controls: Controls) -> None:
        config = self._config
        speeds = np.zeros(_OUTPUTS)
        for motor in config.motors:
            output = controls.outputs[motor.number]
            if not controls.armed:
                speeds[motor.number] = motor.disarmed
            elif output is not None:
                speeds[motor.number] = motor.scale * (output + motor.offset) + motor.armed
        self._publish(speeds)
        for channel, disarmed in zip(self._channels, config.disarmed, strict=True):
            output = controls.outputs[channel.config.number]
            if not controls.armed:
                channel.set_command(disarmed)
            elif output is None:
                channel.switch_off()
            else:
                channel.set_output(output)

    def _switch_off(self) -> None:
        """No longer drives the motors and joints."""
        self._drives = False
        self._fixes.clear()
        self._publish(np.zeros(_OUTPUTS))
        for channel in self._channels:
            channel.switch_off()

    def _publish(self, speeds: Array) -> None:
        empty = np.zeros(0)
        self._motors.publish(self._Actuators(header(self.part.time_ns, ""), empty, speeds, empty))

    def _send(self, vehicle: Px4Link, seconds: float) -> None:
        """Sends the measurements since the last call, whose age is given in s."""
        now_us, number = self.part.time_ns // 1000, vehicle.number
        messages = []
        if self._each_second.due(self.part.time_ns):
            messages += [encode_heartbeat(number()), encode_time(now_us, number())]
        messages.append(encode_sensor(self._measurements(now_us), number()))
        messages.append(encode_truth(self._truth(now_us, seconds), number()))
        while self._fixes and self._fixes[0].time_us + _DELAY_US <= now_us:
            messages.append(encode_gps(self._fixes.popleft(), number()))
        vehicle.send(*messages)

    def _measurements(self, now_us: int) -> Measurements:
        """Returns what the sensors have measured since the last call."""
        measured, self._measured = self._measured, {}
        imu, field, pressure = (measured.get(each) for each in ("imu", "field", "pressure"))
        altitude = height_at(pressure.fluid_pressure) if pressure is not None else 0.0
        return Measurements(
            time_us=now_us,
            acceleration=_to_body(imu.linear_acceleration) if imu is not None else None,
            rates=_to_body(imu.angular_velocity) if imu is not None else _NOWHERE,
            field=_to_body(field.magnetic_field, _GAUSS) if field is not None else None,
            pressure=pressure.fluid_pressure / 100 if pressure is not None else None,
            altitude=altitude,
            temperature=TEMPERATURE - LAPSE * altitude - _ZERO_CELSIUS,
        )

    def _truth(self, now_us: int, seconds: float) -> Truth:
        """Returns the true state, a time in s after the last one."""
        orientation = quat_multiply(
            quat_multiply(TO_NORTH_EAST_DOWN, self._link.pose.orientation), TO_FORWARD_RIGHT_DOWN
        )
        linear, _ = self._link.motion(local=False)
        _, angular = self._link.motion(local=True)
        velocity = rotate(TO_NORTH_EAST_DOWN, linear)
        before, self._velocity = self._velocity, velocity
        acceleration = _NOWHERE
        if before is not None and seconds > 0:
            x, y, z = ((now - old) / seconds for now, old in zip(velocity, before, strict=True))
            acceleration = (x, y, z)
        return Truth(
            time_us=now_us,
            orientation=orientation,
            rates=rotate(TO_FORWARD_RIGHT_DOWN, angular),
            place=self._place,
            velocity=velocity,
            airspeed=rotate(quat_conjugate(orientation), velocity)[0],
            acceleration=acceleration,
        )


def _to_body(vector: Any, factor: float = 1.0) -> Vec3:
    """Returns a vector with axes forward, left, up in the axes forward, right, down."""
    return rotate(TO_FORWARD_RIGHT_DOWN, (vector.x * factor, vector.y * factor, vector.z * factor))
