"""The supported elements of a ``<sensor>``: unknown ones are reported.

Source: SDF 1.4 to 1.12, ``sensor.sdf`` and its includes, and additional tags that Gazebo reads.
"""

from __future__ import annotations

from typing import Any

from cartwheel.description.elements.xml import Node


def _tags(*names: str, **below: Any) -> dict[str, Any]:
    """A table of elements: plain ones, and those with children."""
    return {name: {} for name in names} | below


_NOISE = _tags(
    "type",
    "mean",
    "stddev",
    "bias_mean",
    "bias_stddev",
    "dynamic_bias_stddev",
    "dynamic_bias_correlation_time",
    "precision",
)
_NOISY = {"noise": _NOISE}
_BY_AXIS = dict.fromkeys("xyz", _NOISY)
_HORIZONTAL_VERTICAL = {"horizontal": _NOISY, "vertical": _NOISY}
_SWEEP = _tags("samples", "resolution", "min_angle", "max_angle")
_CLIP = _tags("near", "far")
_RAYS = _tags(
    "visibility_mask",
    scan={"horizontal": _SWEEP, "vertical": _SWEEP},
    range=_tags("min", "max", "resolution"),
    noise=_NOISE,
)
_CAMERA = _tags(
    "pose",
    "horizontal_fov",
    "visibility_mask",
    "triggered",
    "trigger_topic",
    "camera_info_topic",
    "optical_frame_id",
    "segmentation_type",
    "box_type",
    image=_tags("width", "height", "format", "anti_aliasing"),
    clip=_CLIP,
    save=_tags("path"),
    depth_camera={"output": {}, "clip": _CLIP},
    # Image noise has neither bias nor precision.
    noise=_tags("type", "mean", "stddev"),
    distortion=_tags("k1", "k2", "k3", "p1", "p2", "center"),
    lens=None,
)
_PLACE = {
    "position_sensing": _HORIZONTAL_VERTICAL,
    "velocity_sensing": _HORIZONTAL_VERTICAL,
}
_IMU = _tags(
    "topic",
    "enable_orientation",
    orientation_reference_frame=_tags("localization", "custom_rpy", "grav_dir_x"),
    angular_velocity=_BY_AXIS,
    linear_acceleration=_BY_AXIS,
    # The form of SDF 1.4.
    noise={"type": {}, "rate": _NOISE, "accel": _NOISE},
)
_SENSOR = _tags(
    "pose",
    "update_rate",
    "always_on",
    "visualize",
    "topic",
    "enable_metrics",
    "gz_frame_id",
    "ignition_frame_id",
    "frame_id",
    plugin=None,
    camera=_CAMERA,
    ray=_RAYS,
    lidar=_RAYS,
    # Used by some files for ray sensors.
    noise=_NOISE,
    contact=_tags("collision", "topic"),
    imu=_IMU,
    gps=_PLACE,
    navsat=_PLACE,
    magnetometer=_BY_AXIS,
    altimeter={"vertical_position": _NOISY, "vertical_velocity": _NOISY},
    logical_camera=_tags("near", "far", "horizontal_fov", "aspect_ratio"),
    air_pressure={"reference_altitude": {}, "pressure": _NOISY},
    force_torque=_tags("frame", "measure_direction", force=_BY_AXIS, torque=_BY_AXIS),
    # For unsupported sensors, which are reported as a whole.
    **dict.fromkeys(
        (
            "air_speed",
            "rfid",
            "rfidtag",
            "sonar",
            "transceiver",
        )
    ),
)
"""The children of each element; None for any."""
_NUMBERS = frozenset({
    "mean", "stddev", "bias_mean", "bias_stddev", "dynamic_bias_stddev",
    "dynamic_bias_correlation_time", "precision", "samples", "resolution", "min_angle", "max_angle",
    "near", "far", "min", "max", "horizontal_fov", "width", "height", "k1", "k2", "k3", "p1", "p2",
    "aspect_ratio", "reference_altitude",
})  # fmt: skip
"""Elements that contain one number."""
_MANY = ("camera", "collision", "plugin")
"""Elements that may be repeated."""
_ATTRIBUTES = (
    "name",
    "type",
    "relative_to",
    "frame",
    "parent_frame",
    "degrees",
    "rotation_format",
    "enabled",
)


def mark_known(sensor: Node) -> None:
    """Marks the known elements of a sensor as read; `unread` reports the rest."""
    _mark(sensor, _SENSOR)


def _mark(node: Node, known: dict[str, Any]) -> None:
    for name in _ATTRIBUTES:
        node.get(name)
    for tag, below in known.items():
        first = node.child(tag)
        for each in node.all(tag) if tag in _MANY else [first] if first is not None else []:
            if below is None:
                each.mark()
            else:
                _mark(each, below)
            if tag in _NUMBERS:
                each.cut(1)
