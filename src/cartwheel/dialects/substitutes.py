"""The supported plugin that is nearest to an unsupported one, and the text to write for it."""

from __future__ import annotations

import contextlib
import dataclasses
import re
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from html import escape

from cartwheel.description.model import Element, PluginTag
from cartwheel.dialects.catalogue import plugin_named, short_name
from cartwheel.dialects.plugin import Plugin
from cartwheel.dialects.tag_roles import JOINT_ROLES

_PURPOSES = (
    (r"ackerman", "a car", "libgazebo_ros_ackermann_drive.so"),
    (r"skid ?steer", "a skid-steer drive", "libgazebo_ros_skid_steer_drive.so"),
    (
        r"diff ?drive|differential ?drive|segway",
        "a differential drive",
        "libgazebo_ros_diff_drive.so",
    ),
    (r"tricycle|steer(?:ing)? ?drive", "a tricycle drive", "libgazebo_ros_tricycle_drive.so"),
    (r"mecanum|\bomni|holonomic|planar ?move", "planar motion", "libgazebo_ros_planar_move.so"),
    (
        r"livox|velodyne|ouster|robosense|rslidar|hesai",
        "a 3D lidar",
        "libgazebo_ros_velodyne_laser.so",
    ),
    (r"laser|lidar|\bray ?(?:sensor|plugin)|hokuyo", "a lidar", "libgazebo_ros_ray_sensor.so"),
    (r"(?<!image )sonar|ultrasonic|ultrasound|range ?finder", "a sonar", "libgazebo_ros_range.so"),
    (
        r"kinect|depth ?camera|rgbd|\bastra\b|\bzed|realsense",
        "a depth camera",
        "libgazebo_ros_openni_kinect.so",
    ),
    (r"camera(?! ?move)", "a camera", "libgazebo_ros_camera.so"),
    (r"magnetometer|compass", "a magnetometer", "libhector_gazebo_ros_magnetic.so"),
    (r"barometer|altimeter", "a barometer", "libhector_gazebo_ros_baro.so"),
    (r"gps|gnss|navsat", "a GPS receiver", "libhector_gazebo_ros_gps.so"),
    (r"\bimu\b", "an IMU", "libgazebo_ros_imu_sensor.so"),
    (r"ground ?truth|pose ?gt|odom", "the ground-truth pose", "libgazebo_ros_p3d.so"),
    (r"joint ?state|encoders?\b", "joint states", "libgazebo_ros_joint_state_publisher.so"),
    (r"mimic", "mimic joints", "libroboticsgroup_upatras_gazebo_mimic_joint_plugin.so"),
    (r"bumper|contact ?sensor", "a bumper", "libgazebo_ros_bumper.so"),
    (r"vacuum|suction", "a vacuum gripper", "libgazebo_ros_vacuum_gripper.so"),
    (r"grasp ?(?:fix|hack)|fix ?grasp|sticky fingers", "a gripper", "libgazebo_grasp_fix.so"),
    (r"link ?attach|ros attach", "the attachment of links", "libgazebo_ros_link_attacher.so"),
    (r"motor ?model", "a propeller", "librotors_gazebo_motor_model.so"),
    (r"thruster", "a marine propeller", "gz-sim-thruster-system"),
    (r"lift ?drag", "lift and drag", "gz-sim-lift-drag-system"),
    (r"hydro ?dynamics?", "forces of water", "gz-sim-hydrodynamics-system"),
    (r"buoyancy(?! ?engine)", "buoyancy", "libBuoyancyPlugin.so"),
    (r"\bwind\b(?!.*visual)", "the force of wind", "librotors_gazebo_wind_plugin.so"),
    (r"battery(?! ?consumer)", "a battery", "gz-sim-linear-battery-plugin-system"),
    (r"wheel ?slip", "wheel slip", "libgazebo_ros_wheel_slip.so"),
    (
        r"^plugin drone|quadrotor simple controller|drone simple controller",
        "a drone that follows Twist commands",
        "gz-sim-velocity-control-system",
    ),
    (
        r"controller ?manager|^fetch gazebo plugin$|^panda gazebo$",
        "a controller manager",
        "libgazebo_ros_control.so",
    ),
)
"""Patterns, the plugins' purposes, and the supported plugins; the first match applies. A pattern is
for the words of a short name, in lower case and with spaces between them."""
_VALUES = {"gz-sim-velocity-control-system": {"topic": "{}/cmd_vel", "initial_linear": "0 0 0"}}
"""Further tags of supported plugins, with "{}" for the namespace. With these, a drone hovers before
the first command, and subscribes to the topic of ROS."""
_WORD = re.compile(r"[A-Z]+(?![a-z])|[A-Z]?[a-z]+|[0-9]+")
_BLANK = "…"
"""A value for the user to fill in."""
_LONGEST = 100
"""Characters of a name or value."""


@dataclass(frozen=True, kw_only=True, slots=True)
class Substitute:
    """A supported plugin for the purpose of an unsupported one."""

    filename: str
    purpose: str
    text: str
    """The ``<plugin>`` to write, with the values of the unsupported plugin."""
    sensor_type: str
    """Type of the ``<sensor>`` that must contain it; empty for plugins of models."""

    def hint(self, *, in_sensor: bool) -> str:
        """Returns what to write, as a sentence."""
        inside = f' inside a <sensor type="{self.sensor_type}">'
        blanks = f' Replace each "{_BLANK}" with a value.' if _BLANK in self.text else ""
        return (
            f'The nearest supported plugin for {self.purpose} is "{self.filename}". To use it, '
            f"write {self.text}{inside if self.sensor_type and not in_sensor else ''}.{blanks}"
        )


def substitute(tag: PluginTag) -> Substitute | None:
    """Returns the nearest supported plugin, by the purpose that an unsupported one's name states.

    Returns:
        None if the name states no known purpose.
    """
    name = " ".join(_WORD.findall(short_name(tag.filename)[:_LONGEST])).lower()
    for pattern, purpose, filename in _PURPOSES:
        plugin = plugin_named(filename) if re.search(pattern, name) else None
        if plugin is not None:
            return Substitute(
                filename=filename,
                purpose=purpose,
                text=rewritten(tag, filename),
                sensor_type=plugin.sensor_type if plugin.for_sensor else "",
            )
    return None


def rewritten(tag: PluginTag, filename: str, *, name: str = "", ros2: bool = False) -> str:
    """Returns the text of a supported plugin with the values of another one.

    Args:
        tag: The other plugin.
        filename: The file of the supported plugin.
        name: Its name; by default that of the other one.
        ros2: Whether to write the tags of ROS 2, which contain no capital letters.
    """
    plugin = plugin_named(filename)
    values = _VALUES.get(filename, {})
    inner = "" if plugin is None else "".join(_translated(plugin, tag.element, values, ros2=ros2))
    shown = escape(name or tag.name[:_LONGEST])
    return f'<plugin name="{shown}" filename="{filename}">{inner}</plugin>'


def _translated(
    plugin: type[Plugin[object]], element: Element, more: Mapping[str, str], *, ros2: bool = False
) -> Iterator[str]:
    """Returns the supported tags for which the unsupported plugin has a value.

    Tags that the supported plugin requires, and joints, have the value `_BLANK` if it has none.
    """
    values = {_words(each.tag): each.text.strip() for each in element.children if each.text.strip()}
    values |= dict(_other_sizes(values))
    ros = element.find("ros/namespace")
    namespace = ros.text.strip() if ros is not None else values.get(_words("robotNamespace"), "")
    if namespace and not more:
        yield _written("robotNamespace", namespace)
    prefix = namespace.rstrip("/")
    values = {_words(name): value.replace("{}", prefix) for name, value in more.items()} | values
    for item in dataclasses.fields(plugin.parameters):
        tags: tuple[str, ...] = item.metadata["tags"]
        if any("/" in each for each in tags):
            continue
        role = item.metadata["role"]
        found = next((values[_words(each)] for each in tags if _words(each) in values), None)
        side = role.partition("_")[0]
        if found is None and role in JOINT_ROLES and side not in ("joint", "other"):
            found = next(
                (
                    value
                    for words, value in values.items()
                    if side in words and words & {"wheel", "joint", "wheels", "joints"}
                ),
                None,
            )
        required = item.default is dataclasses.MISSING
        if found is None and (
            required or (role in JOINT_ROLES and not item.metadata["optional"] and item.default)
        ):
            found = _BLANK
        if found is not None:
            plain = (each for each in tags if ros2 and each.islower())
            yield _written(next(plain, tags[0]), found)


def _other_sizes(values: Mapping[frozenset[str], str]) -> Iterator[tuple[frozenset[str], str]]:
    """Returns the radius of the wheels if their diameter is stated, or the other way round."""
    for stated, other, factor in (("diameter", "radius", 0.5), ("radius", "diameter", 2.0)):
        wanted = frozenset({"wheel", other})
        text = values.get(frozenset({"wheel", stated}), "")
        with contextlib.suppress(ValueError):
            if wanted not in values:
                yield wanted, f"{factor * float(text):g}"


def _written(tag: str, value: str) -> str:
    return f"<{tag}>{escape(value, quote=False) if len(value) <= _LONGEST else _BLANK}</{tag}>"


def _words(tag: str) -> frozenset[str]:
    """Returns the words of a tag, so that ``leftFrontJoint`` equals ``front_left_joint``."""
    return frozenset(word.lower() for word in _WORD.findall(tag))
