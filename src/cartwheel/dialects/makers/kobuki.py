"""``libgazebo_ros_kobuki.so``: the base of the TurtleBot 2."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np

from cartwheel.codes import running
from cartwheel.description.model import Sensor
from cartwheel.devices.drives.differential import DifferentialDrive, DifferentialDriveConfig
from cartwheel.devices.drives.drive import DriveConfig
from cartwheel.devices.drives.odometry import OdometryConfig
from cartwheel.devices.inertial.messages import imu_message
from cartwheel.devices.inertial.unit import InertialUnit
from cartwheel.devices.joints.states import JointStatesConfig
from cartwheel.devices.rays.scan import Scanner
from cartwheel.dialects.plugin import Plugin
from cartwheel.dialects.sdf.contact import read_collisions
from cartwheel.dialects.sdf.imu import read_inertial_unit
from cartwheel.dialects.sdf.scan import read_scanner
from cartwheel.dialects.tags import tag
from cartwheel.dialects.wheel_pairs import report_swapped_wheels, wheel_pairs
from cartwheel.errors import UnknownNameError
from cartwheel.geometry import Array, yaw_of
from cartwheel.messages import header, message_class

_BASE = "mobile_base/"
"""Namespace of the topics that kobuki_node defines."""
_SIDES = ("left", "center", "right")
_LOWEST, _HIGHEST = 0.01, 0.13
"""m above the root link: contacts between these heights press the bumper."""
_POSE_COVARIANCE = np.diag([0.1, 0.1, 1e6, 1e6, 1e6, 0.05]).ravel()
_IMU_COVARIANCES = (*[np.diag([1e6, 1e6, 0.05]).ravel()] * 2, np.zeros(9))
_MOST = 4095
"""Largest reading of a cliff sensor's A/D converter."""


@dataclass(frozen=True, kw_only=True, slots=True)
class KobukiParameters:
    left_joint: str = tag(
        "left_wheel_joint_name", role="left_wheel", doc="Joint of the left wheel."
    )
    right_joint: str = tag(
        "right_wheel_joint_name", role="right_wheel", doc="Joint of the right wheel."
    )
    separation: float = tag(
        "wheel_separation", unit="m", role="wheel_separation", doc="Distance between the wheels."
    )
    diameter: float = tag(
        "wheel_diameter", unit="m", role="wheel_diameter", doc="Diameter of both wheels."
    )
    torque: float = tag("torque", unit="N m", doc="Maximum torque of each motor.")
    timeout: float = tag(
        "velocity_command_timeout",
        unit="s",
        doc="The robot stops after this time without a command.",
    )
    cliff_left: str = tag(
        "cliff_sensor_left_name", doc="Name of the left ray sensor, which faces the floor."
    )
    cliff_center: str = tag(
        "cliff_sensor_center_name", doc="Name of the centre ray sensor, which faces the floor."
    )
    cliff_right: str = tag(
        "cliff_sensor_right_name", doc="Name of the right ray sensor, which faces the floor."
    )
    cliff_threshold: float = tag(
        "cliff_detection_threshold",
        unit="m",
        doc="A cliff is reported if the floor is at least this far from the sensor.",
    )
    bumper: str = tag("bumper_name", doc="Name of the bumper's contact sensor.")
    drop_left: str = tag(
        "wheel_drop_left_sensor_name",
        doc="Name of the left wheel's contact sensor. While it has no contact, a wheel drop is "
        "reported.",
    )
    drop_right: str = tag(
        "wheel_drop_right_sensor_name",
        doc="Name of the right wheel's contact sensor. While it has no contact, a wheel drop is "
        "reported.",
    )
    imu: str = tag("imu_name", doc="Name of the imu sensor.")
    publish_tf: bool = tag(
        "publish_tf", default=False, doc="Publish the transform of the odometry."
    )
    rate: float = tag(
        "update_rate",
        default=0.0,
        unit="Hz",
        doc="Publish rate of all topics. 0: every step.",
    )


class Kobuki(Plugin[KobukiParameters]):
    """Drives a Kobuki base and publishes odometry and IMU, bumper, cliff and wheel drop data.

    The odometry uses the travelled distance of the wheels and the rotation from the gyroscope. A
    contact within 30° of straight ahead presses the centre bumper. A contact from 30° to 90°
    presses the left or right bumper. Bumper, cliff and wheel drop events are published when their
    state changes. The robot stops while its motor power is off. Original package:
    ``kobuki_gazebo_plugins``.
    """

    filenames: ClassVar[tuple[str, ...]] = ("libgazebo_ros_kobuki.so",)
    parameters: ClassVar[type] = KobukiParameters

    def configure(self) -> None:
        config = self.config
        joints = config.left_joint, config.right_joint
        pairs = wheel_pairs(self, [joints], [config.separation], [config.diameter])
        self.check_not_negative("rate")
        self._take_sensors(config)
        self.subscribe(_BASE + "commands/motor_power", "kobuki_msgs/msg/MotorPower", self._on_power)
        self.subscribe(
            _BASE + "commands/reset_odometry",
            "std_msgs/msg/Empty",
            lambda _: self._drive.reckoning.restart(),
        )
        self.part.schedule(config.rate, after=self._sense, active=self._sensed)
        self._drive = self.add(
            DifferentialDrive(
                self.scope,
                DifferentialDriveConfig(
                    pairs=pairs,
                    max_torque=config.torque,
                    odometry="positions",
                    drive=DriveConfig(
                        command_topic=_BASE + "commands/velocity",
                        timeout=config.timeout,
                        control_rate=0.0,
                        odometry=OdometryConfig(
                            topic="odom",
                            frame="odom",
                            base="base_footprint",
                            rate=config.rate,
                            transform=config.publish_tf,
                            pose_covariance=_POSE_COVARIANCE,
                        ),
                        joint_states=JointStatesConfig(
                            joints=joints,
                            rate=config.rate,
                            velocities=True,
                            efforts=True,
                            frame="base_link",
                        ),
                    ),
                ),
                yaw_rate=lambda: self._unit.rates()[2],
            )
        )
        report_swapped_wheels(self, pairs)
        self.reset()

    def reset(self) -> None:
        super().reset()
        self._cliff = dict.fromkeys(_SIDES, False)
        self._pressed = dict.fromkeys(_SIDES, False)
        self._dropped = dict.fromkeys(("left", "right"), False)

    def _take_sensors(self, config: KobukiParameters) -> None:
        rays = (config.cliff_left, config.cliff_center, config.cliff_right)
        self._floors = {
            side: Scanner(self.part, read_scanner(self._sensor(name), self.part.report))
            for side, name in zip(_SIDES, rays, strict=True)
        }
        self._bumper = read_collisions(self, self._sensor(config.bumper))
        self._wheels = {
            "left": read_collisions(self, self._sensor(config.drop_left)),
            "right": read_collisions(self, self._sensor(config.drop_right)),
        }
        imu = self._sensor(config.imu)
        self._unit = InertialUnit(self.part, read_inertial_unit(self.part, imu))
        self._root = self.part.link(self.part.description.canonical_link)
        self._frame = self.frame("base_link")
        kinds = {
            "cliff": "CliffEvent",
            "bumper": "BumperEvent",
            "wheel_drop": "WheelDropEvent",
        }
        types = {name: f"kobuki_msgs/msg/{kind}" for name, kind in kinds.items()}
        self._Events = {name: message_class(kind) for name, kind in types.items()}
        self._events = {
            name: self.advertise(f"{_BASE}events/{name}", kind) for name, kind in types.items()
        }
        rate = config.rate or None
        self._imu = self.advertise(_BASE + "sensors/imu_data", "sensor_msgs/msg/Imu", rate=rate)
        self._Core = message_class("kobuki_msgs/msg/SensorState")
        self._core = self.advertise(
            _BASE + "sensors/core", "kobuki_msgs/msg/SensorState", rate=rate
        )

    def _sensor(self, name: str) -> Sensor:
        sensors = [sensor for link in self.part.description.links for sensor in link.sensors]
        match = next((sensor for sensor in sensors if sensor.name == name), None)
        if match is None:
            known = [sensor.name for sensor in sensors]
            raise UnknownNameError(
                "sensor", name, known, code=running.UNKNOWN_SENSOR, origin=self.tag.origin
            )
        self.part.read_sensors.add(name)
        return match

    def _on_power(self, message: Any) -> None:
        self._drive.enabled = message.state == message.ON

    def _sensed(self) -> bool:
        return any(each.wanted for each in (self._imu, self._core, *self._events.values()))

    def _sense(self) -> None:
        if self._imu.wanted:
            moment = header(self.part.time_ns, self._frame)
            self._imu.publish(imu_message(moment, *self._unit.measure(), _IMU_COVARIANCES))
        self._check_cliffs()
        self._check_contacts()
        if self._core.wanted:
            self._core.publish(
                self._Core(
                    header=header(self.part.time_ns, self._frame),
                    time_stamp=self.part.time_ns // 1_000_000 % 65536,
                    bumper=_bits(self._pressed, left=4, center=2, right=1),
                    wheel_drop=_bits(self._dropped, left=2, right=1),
                    cliff=_bits(self._cliff, left=4, center=2, right=1),
                    left_encoder=0,
                    right_encoder=0,
                    left_pwm=0,
                    right_pwm=0,
                    buttons=0,
                    charger=0,
                    battery=0,
                    bottom=np.zeros(0, np.uint16),
                    current=np.zeros(0, np.uint8),
                    over_current=0,
                    digital_input=0,
                    analog_input=np.zeros(0, np.uint16),
                )
            )

    def _check_cliffs(self) -> None:
        for index, side in enumerate(_SIDES):
            scanner = self._floors[side]
            # Only the first ray is used. If it is out of range, the floor is at the maximum range.
            floor = min(float(scanner.measure().ranges[0, 0]), scanner.pattern.maximum)
            cliff = floor >= self.config.cliff_threshold
            if cliff != self._cliff[side]:
                self._cliff[side] = cliff
                # Reading of the A/D converter for a distance in mm.
                reading = 76123.0 * math.atan2(0.995, max(floor, 0.0) * 1000)
                self._publish_event("cliff", index, int(cliff), min(int(reading), _MOST))

    def _check_contacts(self) -> None:
        place, turned = self._root.place()
        pressed = dict.fromkeys(_SIDES, False)
        for contact in self.part.contacts(self._bumper):
            if _LOWEST <= contact.position[2] - place[2] <= _HIGHEST:
                side = _bumper_of(contact.normal, yaw_of(turned))
                if side:
                    pressed[side] = True
        self._publish_changes("bumper", self._pressed, pressed)
        dropped = {
            side: not self.part.contacts(collisions) for side, collisions in self._wheels.items()
        }
        self._publish_changes("wheel_drop", self._dropped, dropped)

    def _publish_changes(self, name: str, before: dict[str, bool], now: dict[str, bool]) -> None:
        for index, (side, state) in enumerate(now.items()):
            if before[side] != state:
                before[side] = state
                self._publish_event(name, index, int(state))

    def _publish_event(self, name: str, *values: int) -> None:
        if self._events[name].wanted:
            self._events[name].publish(self._Events[name](*values))


def _bumper_of(normal: Array, heading: float) -> str:
    """Returns the pressed bumper; empty behind the robot. The normal points into the robot."""
    x, y, _ = (-normal).tolist()
    angle = math.remainder(math.atan2(y, x) - heading, 2 * math.pi)
    if abs(angle) > math.pi / 2:
        return ""
    if abs(angle) <= math.pi / 6:
        return "center"
    return "left" if angle > 0 else "right"


def _bits(states: dict[str, bool], **values: int) -> int:
    return sum(values[side] for side, state in states.items() if state)
