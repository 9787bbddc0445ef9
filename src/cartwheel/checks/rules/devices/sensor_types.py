"""Types of sensors, and plugins that do not accept them."""

from __future__ import annotations

from collections.abc import Iterator

from cartwheel.checks import spelling
from cartwheel.checks.rule import rule
from cartwheel.checks.rules.devices.sensor_ranges import sensors_of
from cartwheel.checks.subject import Subject
from cartwheel.codes import devices as devices_codes
from cartwheel.dialects.classic.refusals import refusals
from cartwheel.errors import Diagnostic

TYPES = (
    "air_pressure", "air_speed", "altimeter", "boundingbox", "boundingbox_camera", "camera",
    "contact", "custom", "depth", "depth_camera", "dvl", "force_torque", "gps", "gpu_lidar",
    "gpu_ray", "imu", "lidar", "logical_camera", "magnetometer", "multicamera", "navsat", "ray",
    "rfid", "rfidtag", "rgbd", "rgbd_camera", "segmentation", "segmentation_camera", "sonar",
    "thermal", "thermal_camera", "triggered_camera", "wide_angle_camera", "wideanglecamera",
    "wireless_receiver", "wireless_transmitter",
)  # fmt: skip
"""Sensor types up to SDF 1.11."""


@rule(devices_codes.SENSOR_REFUSED)
def sensor_refused(subject: Subject) -> Iterator[Diagnostic]:
    for robot in subject.robots:
        yield from refusals(robot.description)


@rule(devices_codes.SENSOR_TYPE_UNKNOWN)
def sensor_type_unknown(subject: Subject) -> Iterator[Diagnostic]:
    for _, sensor in sensors_of(subject):
        if sensor.type in TYPES:
            continue
        yield spelling.misspelt(
            devices_codes.SENSOR_TYPE_UNKNOWN,
            sensor.type,
            TYPES,
            attribute="type",
            message=f'sensor "{sensor.name}" has the type "{sensor.type}", which Gazebo does '
            "not support",
            values={"sensor": sensor.name, "type": sensor.type},
            origin=sensor.origin,
            mark="type",
        )
