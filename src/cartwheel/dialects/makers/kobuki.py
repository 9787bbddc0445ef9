"""``libgazebo_ros_kobuki.so``: the base of the TurtleBot 2."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np

from cartwheel.codes import running
from cartwheel.description.model import Sensor
from cartwheel.devices.bases.kobuki import KobukiSensors, KobukiSensorsConfig
from cartwheel.devices.drives.differential import DifferentialDriveConfig
from cartwheel.devices.drives.drive import DriveConfig
from cartwheel.devices.drives.odometry import OdometryConfig
from cartwheel.devices.joints.states import JointStatesConfig
from cartwheel.dialects import drive_tags
from cartwheel.dialects.common_tags import publish_rate_tag
from cartwheel.dialects.plugin import Plugin
from cartwheel.dialects.sdf.contact import read_collisions
from cartwheel.dialects.sdf.imu import read_inertial_unit
from cartwheel.dialects.sdf.scan import read_scanner
from cartwheel.dialects.tags import tag
from cartwheel.dialects.wheel_pairs import add_differential_drive, wheel_pairs
from cartwheel.errors import UnknownNameError

_BASE = "mobile_base/"
"""Namespace of the topics that kobuki_node defines."""
_POSE_COVARIANCE = np.diag([0.1, 0.1, 1e6, 1e6, 1e6, 0.05]).ravel()


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
    torque: float = tag(
        "torque", unit="N m", role="wheel_torque", doc="Maximum torque of each motor."
    )
    timeout: float = tag(
        "velocity_command_timeout",
        unit="s",
        doc="Time without a command after which the robot stops.",
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
        doc="Distance between the sensor and the floor at which a cliff is reported.",
    )
    bumper: str = tag("bumper_name", doc="Name of the bumper's contact sensor.")
    drop_left: str = tag(
        "wheel_drop_left_sensor_name",
        default="",
        doc="Name of the left wheel's contact sensor. While it has no contact, a wheel drop is "
        "reported. Versions of the plugin before 2023 do not have this tag.",
    )
    drop_right: str = tag(
        "wheel_drop_right_sensor_name",
        default="",
        doc="Name of the right wheel's contact sensor. While it has no contact, a wheel drop is "
        "reported.",
    )
    imu: str = tag("imu_name", doc="Name of the imu sensor.")
    publish_tf: bool = drive_tags.publish_transform("publish_tf", default=False)
    rate: float = publish_rate_tag("update_rate", of="all topics")


class Kobuki(Plugin[KobukiParameters]):
    """Drives a Kobuki base, and publishes its odometry, IMU data, and bumper and cliff events.

    The odometry is computed from the distances that the wheels travel and the angular velocity that
    the IMU measures. A contact within 30° of the forward direction presses the centre bumper. A
    contact between 30° and 90° presses the left or right bumper. Bumper, cliff and wheel drop
    events are published when their state changes. The robot stops while its motor power is off.
    Original package: ``kobuki_gazebo_plugins``.
    """

    filenames: ClassVar[tuple[str, ...]] = ("libgazebo_ros_kobuki.so",)

    def configure(self) -> None:
        config = self.config
        joints = config.left_joint, config.right_joint
        pairs = wheel_pairs(self, [joints], [config.separation], [config.diameter])
        sensors = self.add(KobukiSensors(self.scope, self._sensors_config(config)))
        self.subscribe(_BASE + "commands/motor_power", "kobuki_msgs/msg/MotorPower", self._on_power)
        self.subscribe(
            _BASE + "commands/reset_odometry",
            "std_msgs/msg/Empty",
            lambda _: self._drive.reckoning.restart(),
        )
        self._drive = add_differential_drive(
            self,
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
            yaw_rate=lambda: sensors.unit.rates()[2],
        )

    def _sensors_config(self, config: KobukiParameters) -> KobukiSensorsConfig:
        left, center, right = (
            read_scanner(self._sensor(name), self.part.report)
            for name in (config.cliff_left, config.cliff_center, config.cliff_right)
        )
        names = (config.bumper, config.drop_left, config.drop_right)
        bumper, drop_left, drop_right = (
            read_collisions(self, self._sensor(name)) if name else None for name in names
        )
        return KobukiSensorsConfig(
            floors=(left, center, right),
            cliff_threshold=config.cliff_threshold,
            bumper=bumper or frozenset(),
            wheels=(drop_left, drop_right),
            unit=read_inertial_unit(self.part, self._sensor(config.imu)),
            namespace=_BASE,
            frame="base_link",
            rate=config.rate,
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
