"""``libgazebo_ros_ft_sensor.so`` and ``force_torque`` sensors: the wrench on a joint."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, ClassVar

from cartwheel.codes import devices
from cartwheel.description.model import Sensor
from cartwheel.devices.noise import VectorNoise, VectorNoiseConfig
from cartwheel.dialects.gz.sensor_tags import frame_tag
from cartwheel.dialects.plugin import Plugin
from cartwheel.dialects.sdf.noise import read_noise
from cartwheel.dialects.tags import invalid, tag
from cartwheel.errors import PluginError, UnknownNameError
from cartwheel.geometry import IDENTITY, matrix_from_quat, quat_conjugate, quat_multiply
from cartwheel.messages import header, message_class
from cartwheel.simulation import Part

_AXES = "xyz"


class _JointWrench(Plugin[Any]):
    """Publishes a measured wrench; by default that of a joint, about its anchor."""

    def _take(self, name: str, *, topic: str, frame: str, rate: float) -> None:
        description = self.part.description
        joint = description.joint(name)
        if joint is None:
            raise UnknownNameError(
                "joint",
                name,
                [one.name for one in description.joints],
                code=devices.PLUGIN_JOINT_UNKNOWN,
                origin=self.tag.origin,
            )
        self._child = self.part.link(joint.child)
        self._anchor = joint.pose
        self.part.feel(joint.child)
        self._offer(topic, frame=frame or joint.child, rate=rate)

    def _offer(self, topic: str, *, frame: str, rate: float) -> None:
        """Advertises the topic and schedules the measurement."""
        self.check_not_negative("update_rate")
        self._frame = self.frame(frame)
        self._WrenchStamped = message_class("geometry_msgs/msg/WrenchStamped")
        self._Wrench = message_class("geometry_msgs/msg/Wrench")
        self._Vector3 = message_class("geometry_msgs/msg/Vector3")
        self._publisher = self.advertise(
            topic, "geometry_msgs/msg/WrenchStamped", rate=rate or None, qos="sensor"
        )
        self.part.schedule(rate, after=self._publish, active=lambda: self._publisher.wanted)

    def _measure(self) -> list[float]:
        """Returns force (N) and torque (N m) of the child link on the parent, in its frame."""
        force, torque = self._child.reaction(self._anchor.position)
        return [*force.tolist(), *torque.tolist()]

    def _publish(self) -> None:
        values = self._measure()
        wrench = self._Wrench(self._Vector3(*values[:3]), self._Vector3(*values[3:]))
        self._publisher.publish(self._WrenchStamped(header(self.part.time_ns, self._frame), wrench))


@dataclass(frozen=True, kw_only=True, slots=True)
class FtSensorParameters:
    joint: str = tag(
        "jointName",
        "joint_name",
        default="",
        doc="Joint on which the wrench is measured. Default: the sensor's joint.",
    )
    body: str = tag(
        "body_name",
        default="",
        doc="Link on which external forces are measured instead of a joint's wrench, as with "
        "`libgazebo_ros_f3d.so` (ROS 2).",
    )
    topic: str = tag(
        "topicName", "topic_name", default="wrench", doc="Topic of the WrenchStamped messages."
    )
    frame: str = tag(
        "frame_name",
        default="",
        doc="Frame ID of the wrench with `<body_name>`. A joint's wrench is in the frame of "
        "its child link, as in Gazebo. Default: `world`.",
    )
    noise: float = tag(
        "gaussianNoise",
        "gaussian_noise",
        default=0.0,
        unit="N and N m",
        doc="Standard deviation of the noise.",
    )
    update_rate: float = tag(
        "updateRate",
        "update_rate",
        default=0.0,
        unit="Hz",
        doc="Publish rate. 0: the `<update_rate>` of the sensor that contains the plugin, or else "
        "every step.",
    )


class FtSensor(_JointWrench):
    """Publishes the force and torque that a joint's child link exerts on its parent link.

    The wrench is in the child link's frame, and the torque is about the joint. A hanging load
    exerts a downward force. Fixed joints are supported without ``<preserveFixedJoint>``. Original
    plugin: ``gazebo_ros_ft_sensor`` in the package ``gazebo_plugins``.
    """

    filenames: ClassVar[tuple[str, ...]] = ("libgazebo_ros_ft_sensor.so",)
    parameters: ClassVar[type] = FtSensorParameters

    def configure(self) -> None:
        config: FtSensorParameters = self.config
        sensed = self.sensor.joint if self.sensor is not None else None
        name = config.joint or sensed or ""
        self.check_not_negative("noise")
        rate = config.update_rate or (self.sensor.update_rate if self.sensor is not None else 0.0)
        if config.body:
            # If both tags are present, Gazebo also uses the link.
            self._child = self.part.link(config.body, origin=self.tag.origin)
            self.part.feel(config.body)
            self._offer(config.topic, frame=config.frame or "world", rate=rate)
            return
        if not name:
            raise PluginError(
                "a force-torque sensor requires <jointName>",
                code=devices.PLUGIN_PARAMETER_MISSING,
                origin=self.tag.origin,
                values={"parameter": "jointName"},
            )
        if config.frame:
            self.warn(
                devices.PLUGIN_PARAMETER_IGNORED,
                "<frame_name> has no effect: the wrench of a joint is in the frame of its child",
                values={"parameter": "frame_name"},
            )
        self._take(name, topic=config.topic, frame="", rate=rate)

    def _measure(self) -> list[float]:
        if self.config.body:
            force, torque = self._child.load()
            values = [*force.tolist(), *torque.tolist()]
        else:
            values = super()._measure()
        if self.config.noise > 0:
            random = self.part.random(f"force {self._publisher.topic}")
            return [float(v) for v in values + random.normal(0.0, self.config.noise, 6)]
        return values


class JointLoad:
    """Measures the wrench of a ``force_torque`` sensor's joint, with the settings in its tag.

    Args:
        part: The robot.
        sensor: A sensor inside a joint.

    Raises:
        PluginError: A keyword or the noise is not allowed.
    """

    def __init__(self, part: Part, sensor: Sensor) -> None:
        element = sensor.element.find("force_torque") or sensor.element
        self.axes = _word(element, "frame", ("child", "parent", "sensor"))
        """Frame of the measurement: child, parent or sensor."""
        self._sign = 1.0
        if _word(element, "measure_direction", ("child_to_parent", "parent_to_child")) == (
            "parent_to_child"
        ):
            self._sign = -1.0
        noises = tuple(
            read_noise(element.find(f"{what}/{axis}/noise"), part.report)
            for what in ("force", "torque")
            for axis in _AXES
        )
        self._noise = VectorNoise(
            part,
            VectorNoiseConfig(
                name=f"force {sensor.joint} {sensor.name}", noises=noises, rate=sensor.update_rate
            ),
        )
        joint = part.description.joint(sensor.joint or "")
        assert joint is not None
        self._child = part.link(joint.child)
        known = part.description.link(joint.parent) is not None
        self._parent = part.link(joint.parent) if known else None
        self._anchor = joint.pose.position
        # The pose is relative to the child link.
        self._turn = quat_conjugate(sensor.pose.orientation)

    def measure(self) -> list[float]:
        """Returns the force in N, then the torque in N m about the joint."""
        force, torque = self._child.reaction(self._anchor)
        turn = (0.0, 0.0, 0.0, 1.0)
        if self.axes == "sensor":
            turn = self._turn
        elif self.axes == "parent":
            back = quat_conjugate(self._parent.place()[1]) if self._parent is not None else turn
            turn = quat_multiply(back, self._child.place()[1])
        matrix = self._sign * matrix_from_quat(turn)
        both = [*(matrix @ force).tolist(), *(matrix @ torque).tolist()]
        return list(self._noise.add(both))


@dataclass(frozen=True, kw_only=True, slots=True)
class GzForceTorqueParameters:
    topic: str = tag(
        "topic",
        default="",
        doc="Topic of the WrenchStamped messages. Default: "
        "`/world/<world>/model/<model>/joint/<joint>/sensor/<sensor>/forcetorque`.",
    )
    frame: str = frame_tag("Frame ID of the messages. Default: the link selected by `<frame>`.")


class GzForceTorque(_JointWrench):
    """Publishes the force and torque on the joint that contains a ``force_torque`` sensor.

    ``<frame>`` selects the frame of the vectors: ``child`` (default), ``parent`` or ``sensor``.
    ``<measure_direction>`` selects the sign: ``child_to_parent`` (default) or ``parent_to_child``.
    ``<force>`` and ``<torque>`` can contain noise for each axis.

    The default frame ID is the link selected by ``<frame>``. With ``sensor``, it is the child link,
    or the sensor's name if the sensor is rotated relative to its link. Original sensor:
    ``ForceTorqueSensor`` in gz-sensors.
    """

    filenames: ClassVar[tuple[str, ...]] = ()
    parameters: ClassVar[type] = GzForceTorqueParameters
    for_sensor: ClassVar[bool] = True
    serves: ClassVar[tuple[str, ...]] = ("force_torque",)

    def configure(self) -> None:
        sensor = self.sensor
        assert sensor is not None
        if sensor.joint is None:
            raise PluginError(
                f'sensor "{sensor.name}" measures a joint, but is not inside a <joint>',
                code=devices.SENSOR_INCOMPLETE,
                origin=sensor.origin,
                hint="Move the <sensor> into the <joint>.",
                values={"sensor": sensor.name, "missing": "joint"},
            )
        config: GzForceTorqueParameters = self.config
        scope = f"/world/{self.part.world.name}/model/{self.part.name}/joint/{sensor.joint}"
        topic = config.topic or f"{scope}/sensor/{sensor.name}/forcetorque"
        self._load = JointLoad(self.part, sensor)
        joint = self.part.description.joint(sensor.joint)
        frame = config.frame
        if not frame and joint is not None and self._load.axes == "parent":
            frame = joint.parent
        elif not frame and self._load.axes == "sensor" and sensor.pose.orientation != IDENTITY:
            frame = sensor.name
        self._take(sensor.joint, topic=topic, frame=frame, rate=sensor.update_rate)

    def _measure(self) -> list[float]:
        return self._load.measure()


def _word(element: Any, name: str, allowed: tuple[str, ...]) -> str:
    child = element.find(name)
    if child is None:
        return allowed[0]
    word: str = child.text.strip()
    if word not in allowed:
        raise invalid(name, word, f"one of {', '.join(allowed)}", child.origin)
    return word
