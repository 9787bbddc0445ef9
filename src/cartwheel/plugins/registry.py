"""Which plugin answers to which file name, and what a model's tags make."""

from __future__ import annotations

import functools
import importlib.metadata
import re
from collections.abc import Collection, Iterable, Iterator
from typing import Any, Literal

from cartwheel.description.model import PluginTag, Sensor
from cartwheel.errors import CartwheelError, Diagnostic, StaticModelError, likely
from cartwheel.graph import Graph
from cartwheel.plugins.base import Plugin
from cartwheel.plugins.gz_sensor import SYSTEMS, own_tag, publishes
from cartwheel.plugins.parameters import tags_of
from cartwheel.simulation import Part
from cartwheel.simulation.resident import Behaviour


def short_name(filename: str) -> str:
    """A plugin's name without path, ``lib``, ``.so`` and the vendor's older spelling."""
    stem = filename.rsplit("/", 1)[-1]
    stem = re.sub(r"\.(so|dylib|dll)$", "", stem)
    stem = stem.removeprefix("lib")
    return stem.replace("ignition-gazebo-", "gz-sim-")


@functools.cache
def plugins() -> dict[str, type[Plugin[object]]]:
    """All plugins by short name: ours, and those of installed packages."""
    from cartwheel.plugins.ackermann import AckermannDrive, GzAckermann
    from cartwheel.plugins.battery import Battery
    from cartwheel.plugins.block_laser import BlockLaser
    from cartwheel.plugins.camera import Camera, Prosilica, TriggeredCamera
    from cartwheel.plugins.contact import Bumper
    from cartwheel.plugins.control.ros2_control import Ros2Control
    from cartwheel.plugins.control.ros_control import RosControl
    from cartwheel.plugins.depth_camera import DepthCamera, OpenniKinect
    from cartwheel.plugins.detachable_joint import DetachableJoint
    from cartwheel.plugins.diff_drive import DiffDrive
    from cartwheel.plugins.elevator import Elevator
    from cartwheel.plugins.f3d import F3D
    from cartwheel.plugins.foot_contact import FootContact
    from cartwheel.plugins.force import Force
    from cartwheel.plugins.force_based_move import ForceBasedMove
    from cartwheel.plugins.ft_sensor import FtSensor
    from cartwheel.plugins.gps import GpsSensor, HectorGps
    from cartwheel.plugins.grasp_fix import GraspFix
    from cartwheel.plugins.gz_diff_drive import GzDiffDrive
    from cartwheel.plugins.gz_joint_controller import (
        ApplyJointForce,
        JointController,
        JointPositionController,
    )
    from cartwheel.plugins.gz_joint_trajectory import GzJointTrajectory
    from cartwheel.plugins.hand_of_god import HandOfGod
    from cartwheel.plugins.hector_baro import HectorBaro
    from cartwheel.plugins.hector_imu import HectorImu
    from cartwheel.plugins.imu import Imu, ImuSensor
    from cartwheel.plugins.joint_pose_trajectory import JointPoseTrajectory
    from cartwheel.plugins.joint_state_publisher import (
        GzJointStatePublisher,
        JointStatePublisher,
    )
    from cartwheel.plugins.kobuki import Kobuki
    from cartwheel.plugins.laser import Laser
    from cartwheel.plugins.link_attacher import LinkAttacher, LinkAttacherRos2
    from cartwheel.plugins.magnetic import HectorMagnetic
    from cartwheel.plugins.mecanum import MecanumDrive
    from cartwheel.plugins.mimic_joint import Differential, MimicJoint
    from cartwheel.plugins.multi_wheel import MultiWheelDrive
    from cartwheel.plugins.p3d import P3D, OdometryPublisher, WorldOdometry
    from cartwheel.plugins.planar_move import PlanarMove, VelocityControl
    from cartwheel.plugins.pose_publisher import PosePublisher
    from cartwheel.plugins.range import HectorSonar, Range
    from cartwheel.plugins.ray_sensor import RaySensor
    from cartwheel.plugins.realsense import RealSense
    from cartwheel.plugins.skid_steer import SkidSteerDrive
    from cartwheel.plugins.tricycle import TricycleDrive
    from cartwheel.plugins.vacuum_gripper import VacuumGripper
    from cartwheel.plugins.velodyne_laser import VelodyneLaser
    from cartwheel.plugins.wheel_slip import WheelSlip

    known: dict[str, type[Plugin[object]]] = {}
    third = (entry.load() for entry in importlib.metadata.entry_points(group="cartwheel.plugins"))
    drives: tuple[type[Plugin[Any]], ...] = (
        DiffDrive,
        SkidSteerDrive,
        MultiWheelDrive,
        TricycleDrive,
        AckermannDrive,
        PlanarMove,
        ForceBasedMove,
        Kobuki,
        GzDiffDrive,
        GzAckermann,
        MecanumDrive,
        VelocityControl,
    )
    states: tuple[type[Plugin[Any]], ...] = (
        P3D,
        WorldOdometry,
        OdometryPublisher,
        PosePublisher,
        Battery,
        JointStatePublisher,
        GzJointStatePublisher,
        JointPositionController,
        JointController,
        ApplyJointForce,
        GzJointTrajectory,
        JointPoseTrajectory,
        MimicJoint,
        Differential,
        FtSensor,
        F3D,
        Force,
        HandOfGod,
        WheelSlip,
        Imu,
        ImuSensor,
        HectorImu,
        GpsSensor,
        HectorGps,
        HectorMagnetic,
        HectorBaro,
    )
    joining: tuple[type[Plugin[Any]], ...] = (
        GraspFix,
        VacuumGripper,
        LinkAttacher,
        LinkAttacherRos2,
        DetachableJoint,
    )
    lasers = (Laser, RaySensor, BlockLaser, VelodyneLaser, Range, HectorSonar)
    cameras = (Camera, DepthCamera, OpenniKinect, TriggeredCamera, Prosilica, RealSense)
    for plugin in (
        *drives,
        *cameras,
        *lasers,
        *states,
        Bumper,
        FootContact,
        Elevator,
        *joining,
        RosControl,
        Ros2Control,
        *third,
    ):
        for filename in plugin.filenames:
            known[short_name(filename)] = plugin
    return known


@functools.cache
def sensor_plugins() -> dict[str, type[Plugin[object]]]:
    """The plugins that serve sensors without a ``<plugin>``, by the sensor's type."""
    from cartwheel.plugins.air_pressure import AirPressure
    from cartwheel.plugins.ft_sensor import GzForceTorque
    from cartwheel.plugins.gps import GzNavSat
    from cartwheel.plugins.gz_camera import GzCamera
    from cartwheel.plugins.gz_contact import GzContact
    from cartwheel.plugins.gz_lidar import GzLidar
    from cartwheel.plugins.imu import GzImu
    from cartwheel.plugins.magnetic import GzMagnetometer

    own: tuple[type[Plugin[Any]], ...] = (
        GzLidar,
        GzCamera,
        GzImu,
        GzNavSat,
        GzMagnetometer,
        AirPressure,
        GzContact,
        GzForceTorque,
    )
    return {kind: plugin for plugin in (*own, *plugins().values()) for kind in plugin.serves}


def attach(part: Part, graph: Graph) -> list[Behaviour]:
    """Makes the plugins of a model; what is not supported is reported, never passed over.

    A plugin that cannot be made is an error of the model. A system of new Gazebo that a world's
    model names costs itself alone, as there, and so does a sensor without a plugin: that is
    reported.

    Raises:
        CartwheelError: A plugin's parameters make no sense; those made before are closed.
    """
    made: list[Plugin[object]] = []
    sensors = [sensor for link in part.description.links for sensor in link.sensors]
    pairs: list[tuple[PluginTag, Sensor | None]] = [(tag, None) for tag in part.description.plugins]
    pairs += [(tag, sensor) for sensor in sensors for tag in sensor.plugins]
    systems = {short_name(tag.filename) for tag in (*part.world.plugins, *part.description.plugins)}
    try:
        for tag, sensor in pairs:
            plugin = plugins().get(short_name(tag.filename))
            new = short_name(tag.filename).startswith("gz-sim-")
            if plugin is None and short_name(tag.filename) in SYSTEMS:
                continue
            if plugin is None:
                _report_unknown(part, tag)
            elif plugin.for_world or (plugin.for_sensor and sensor is None):
                place = "<world>" if plugin.for_world else "<sensor>"
                part.report(
                    Diagnostic(
                        severity="warning",
                        message=f'plugin "{tag.filename}" has no effect here: '
                        f"it belongs inside a {place}",
                        origin=tag.origin,
                    )
                )
            else:
                made += _made(
                    part, graph, plugin, tag, sensor, lenient="in worlds" if new else "never"
                )
        alone = [one for one in sensors if not one.plugins and one.name not in part.read_sensors]
        made += _serve(part, graph, alone, systems)
    except CartwheelError:
        for plugin_made in made:
            plugin_made.close()
        raise
    return list(made)


def _made(
    part: Part,
    graph: Graph,
    plugin: type[Plugin[object]],
    tag: PluginTag,
    sensor: Sensor | None,
    *,
    lenient: Literal["never", "in worlds", "always"],
) -> list[Plugin[object]]:
    """The plugin; none where it cannot be made and that is reported."""
    try:
        with part.undone_on_error():
            return [plugin(part, graph, tag, sensor)]
    except CartwheelError as error:
        if isinstance(error, StaticModelError):
            lenient = "always"
        own = any(model is part.description for model in part.world.models)
        if lenient == "never" or (lenient == "in worlds" and not own):
            raise
        what = f'plugin "{tag.filename}"' if tag.filename else f'sensor "{tag.name}"'
        hint = f" {error.hint}" if error.hint else ""
        part.report(
            Diagnostic(
                severity="error",
                message=f"{what} is left out: {error.message}.{hint}",
                origin=error.origin or tag.origin,
            )
        )
        return []


def _serve(
    part: Part, graph: Graph, sensors: Iterable[Sensor], systems: Collection[str]
) -> Iterator[Plugin[object]]:
    """The plugins of sensors that have none of their own."""
    for sensor in sensors:
        plugin = sensor_plugins().get(sensor.type)
        wanted = publishes(sensor, systems)
        if wanted and plugin is not None:
            tag = own_tag(sensor, tags_of(plugin.parameters))
            yield from _made(part, graph, plugin, tag, sensor, lenient="always")
            continue
        message = f'sensor "{sensor.name}" has no <plugin>, so it publishes nothing'
        if wanted:
            message = (
                f'sensor "{sensor.name}": without a <plugin> a sensor of type "{sensor.type}" '
                "publishes nothing yet"
            )
        part.report(
            Diagnostic(
                severity="warning" if wanted else "info", message=message, origin=sensor.origin
            )
        )


def _report_unknown(part: Part, tag: PluginTag) -> None:
    # Only a spelling error has a likely meant name: other plugins share most of theirs.
    meant = likely(tag.filename, [f"lib{name}.so" for name in plugins()], cutoff=0.92)
    part.report(
        Diagnostic(
            severity="warning",
            message=f'plugin "{tag.filename}" is not supported: what it does is missing here. '
            f"{meant}".rstrip(),
            origin=tag.origin,
        )
    )
