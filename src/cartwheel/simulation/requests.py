"""A plugin's requests for joints, links, motors, cameras and other parts of its model."""

from __future__ import annotations

import math
from collections.abc import Callable, Collection, Sequence
from dataclasses import replace
from functools import partial

import numpy as np

from cartwheel.codes import devices, running
from cartwheel.description.kinematics import link_poses
from cartwheel.description.model import CameraIntrinsics, Mimic, RobotDescription
from cartwheel.errors import (
    Diagnostic,
    Origin,
    PluginError,
    StaticModelError,
    UnknownNameError,
)
from cartwheel.geometry import Array, Pose
from cartwheel.simulation.clock import Task, Topic, always
from cartwheel.simulation.dynamics.external_servos import BodyDriveHandle, WrenchHandle
from cartwheel.simulation.dynamics.fixed_joints import AttachmentHandle, SurroundingsHandle
from cartwheel.simulation.dynamics.joint_servo import ServoHandle
from cartwheel.simulation.dynamics.wheel_slip import SlipHandle
from cartwheel.simulation.engine import Engine
from cartwheel.simulation.handles import (
    CameraHandle,
    Handle,
    JointHandle,
    JointsHandle,
    LinkHandle,
    MotorHandle,
)
from cartwheel.simulation.sensing.rays import RayHandle
from cartwheel.world.additions import Addition
from cartwheel.world.entry import BodyDrive, CameraMount, ModelEntry, Motor, scoped
from cartwheel.world.tyres import axle_of

_DRIVE_WEIGHTS = 5.0
"""Maximum force of a whole-model servo, as a multiple of the weight: well above any friction."""
_DRIVE_BAND = 0.05
"""Velocity error at which the servo reaches its maximum force, m/s or rad/s."""
_DRIVE_ARM = 0.1
"""Minimum lever arm for the maximum torque, m."""


class Requests:
    """Creates handles, which are bound to the compiled model, and adds motors and cameras to it.

    Args:
        engine: The engine that simulates the model.
        entry: The model, to which motors, cameras and attachments are added.
    """

    def __init__(self, engine: Engine, entry: ModelEntry) -> None:
        self._engine = engine
        self._entry = entry
        self.handles: list[Handle | RayHandle] = []
        self.tasks: list[Task] = []
        self.diagnostics: list[Diagnostic] = []
        """Diagnostics from before the model was spawned."""
        self.spawned = False

    @property
    def name(self) -> str:
        """The model's name in this world."""
        return self._entry.name

    @property
    def start(self) -> Pose:
        """Spawn pose of the model's frame in the world."""
        return self._entry.pose

    @property
    def description(self) -> RobotDescription:
        return self._entry.description

    def adds(self, addition: Addition) -> bool:
        """Whether physics that the description does not state may be added to the model."""
        return addition not in self._engine.without

    def schedule(
        self,
        rate: float,
        *,
        before: Callable[[], None] | None = None,
        after: Callable[[], None] | None = None,
        active: Callable[[], bool] = always,
        topics: Collection[Topic] | None = None,
        idle: Callable[[], bool] | None = None,
    ) -> Task:
        """Schedules callbacks at a rate in Hz; 0 is every step. See `Task`."""
        task = self._engine.task(
            rate, before=before, after=after, active=active, topics=topics, idle=idle
        )
        self.tasks.append(task)
        return task

    def report(self, diagnostic: Diagnostic) -> None:
        """Reports a diagnostic about this model, at startup or at run time."""
        if self.spawned:
            self._engine.report(diagnostic)
        else:
            self.diagnostics.append(diagnostic)

    def link(self, name: str, *, origin: Origin | None = None) -> LinkHandle:
        """A handle to a link of this model.

        Raises:
            UnknownNameError: The link does not exist; the error has this `origin`.
        """
        if self.description.link(name) is None:
            raise UnknownNameError(
                "link",
                name,
                [link.name for link in self.description.links],
                code=running.UNKNOWN_LINK,
                origin=origin,
            )
        handle = LinkHandle(self.name, name)
        self.handles.append(handle)
        return handle

    def joint(self, name: str, *, origin: Origin | None = None) -> JointHandle:
        """A handle to a movable joint of this model.

        Raises:
            UnknownNameError: The joint does not exist; the error has this `origin`.
            StaticModelError: The model is static.
        """
        movable = [joint.name for joint in self.description.joints if joint.drivable]
        if self.description.static:
            raise StaticModelError(
                f'model "{self.name}" is static, so its joints do not move',
                code=running.STATIC_MODEL_DRIVEN,
                origin=origin,
                values={"model": self.name, "joint": name},
            )
        if name not in movable:
            raise UnknownNameError(
                "movable joint",
                name,
                movable,
                code=devices.PLUGIN_JOINT_UNKNOWN,
                origin=origin,
            )
        handle = JointHandle(self.name, name)
        self.handles.append(handle)
        return handle

    def together(self, joints: Sequence[JointHandle]) -> JointsHandle:
        """A handle to several joints of this model that are read together."""
        handle = JointsHandle(joints)
        self.handles.append(handle)
        return handle

    def velocity_motor(
        self,
        joint: str,
        *,
        max_effort: float | None,
        beyond: bool = False,
        origin: Origin | None = None,
    ) -> MotorHandle:
        """A motor that holds a joint's velocity with at most `max_effort` N m or N.

        With `beyond`, `max_effort` may exceed the joint's effort limit. Several requests for the
        same joint share the first motor. If a servo already drives the joint, the motor is shared;
        see `ServoHandle`.
        """
        self.joint(joint, origin=origin)
        motor = self._entry.motors.get(joint)
        if motor is None:
            motor = Motor(joint=joint, mode="velocity", max_effort=max_effort, beyond=beyond)
            self._entry.motors[joint] = motor
        elif motor.mode == "servo":
            motor = self._share(motor, max_effort, origin)
        else:
            self._warn_of_two(joint, "the last command is used", origin)
        handle = MotorHandle(self.name, motor)
        self.handles.append(handle)
        return handle

    def servo(
        self,
        joint: str,
        *,
        max_effort: float | None,
        beyond: bool = False,
        origin: Origin | None = None,
    ) -> ServoHandle:
        """A joint drive with effort, velocity or position commands.

        If a drive plugin already drives the joint, the motor is shared; see `ServoHandle`.

        Args:
            joint: Joint name.
            max_effort: N m or N; at most the joint's own limit.
            beyond: Whether positions and velocities may use more than the joint's limit.
            origin: Origin of the request, for errors.
        """
        self.joint(joint, origin=origin)
        made = Motor(joint=joint, mode="servo", max_effort=max_effort, beyond=beyond)
        motor = self._entry.motors.setdefault(joint, made)
        drives = motor.mode == "velocity"
        handle = ServoHandle(self.name, motor)
        self.handles.append(handle)
        if drives:
            self._share(motor, motor.max_effort, origin)
        servos = self._servos(joint)
        for servo in servos:
            servo.alone = len(servos) == 1 and not servo.shared
        if len(servos) == 2:
            self._warn_of_two(joint, "the last command is used", origin)
        task = self.schedule(0, before=handle.follow)
        task.asleep = task.reads_state = True
        handle.wake = partial(self._engine.wake, task)
        return handle

    def _servos(self, joint: str) -> list[ServoHandle]:
        return [h for h in self.handles if isinstance(h, ServoHandle) and h.motor.joint == joint]

    def _share(self, motor: Motor, max_effort: float | None, origin: Origin | None) -> Motor:
        """Shares a joint's motor between a drive, which sets its strength, and a servo."""
        shared = replace(motor, mode="servo", max_effort=max_effort)
        self._entry.motors[motor.joint] = shared
        for handle in self._servos(motor.joint):
            handle.shared, handle.alone = True, False
        self._warn_of_two(motor.joint, "the efforts of both plugins are added", origin)
        return shared

    def _warn_of_two(self, joint: str, result: str, origin: Origin | None) -> None:
        self.report(
            running.JOINT_DRIVEN_TWICE.diagnostic(
                f'joint "{joint}" is driven by two plugins: {result}',
                origin=origin,
                values={"joint": joint},
            )
        )

    def mimic(self, joint: str, mimic: Mimic, *, origin: Origin | None = None) -> None:
        """Makes a joint follow another joint.

        Raises:
            UnknownNameError: A joint does not exist or cannot move; the error has this `origin`.
        """
        for name in (joint, mimic.joint):
            self.joint(name, origin=origin)
        self._entry.mimics[joint] = mimic

    def body_drive(
        self, *, gains: tuple[float, float] | None = None, origin: Origin | None = None
    ) -> BodyDriveHandle:
        """A servo that moves the whole model by its canonical link.

        Its force acts at the centre of mass.

        Args:
            gains: Force gain in N s/m and torque gain in N m s/rad, without a limit. None is as
                stiff as possible, with at most `_DRIVE_WEIGHTS` times the model's weight.
            origin: Origin for errors.

        Raises:
            PluginError: The model cannot move, or has no mass.
        """
        description = self.description
        link = description.link(description.canonical_link)
        bolted = any(j.child == description.canonical_link for j in description.joints)
        if description.static or bolted or link is None or description.mass <= 0:
            raise PluginError(
                f'model "{self.name}" cannot be moved because it is static, is fixed to the '
                "world or has no mass",
                code=running.MODEL_NOT_MOVABLE,
                origin=origin,
                values={"model": self.name},
            )
        poses = link_poses(description, {})
        to_link = poses[link.name].inverse()
        centre, reach = np.zeros(3), 0.0
        places = [
            (other.inertial.mass, (to_link @ poses[other.name]).apply(other.inertial.pose.position))
            for other in description.links
            if other.inertial is not None
        ]
        for mass, place in places:
            centre += mass / description.mass * np.array(place)
        for mass, place in places:
            reach += mass / description.mass * float(np.sum((np.array(place) - centre) ** 2))
        band = _DRIVE_BAND if gains is None else math.inf
        if gains is None:
            force = _DRIVE_WEIGHTS * 9.8 * description.mass / _DRIVE_BAND
            gains = (force, force * max(_DRIVE_ARM, 2 * reach**0.5))
        drive = BodyDrive(
            link=link.name,
            centre=(float(centre[0]), float(centre[1]), float(centre[2])),
            force_gain=gains[0],
            torque_gain=gains[1],
            band=band,
            number=len(self._entry.drives),
        )
        self._entry.drives.append(drive)
        handle = BodyDriveHandle(self.name, drive)
        self.handles.append(handle)
        self.schedule(0, before=handle.hold).reads_state = True
        return handle

    def wrench(self, link: str, *, origin: Origin | None = None) -> WrenchHandle:
        """A wrench on a link.

        Raises:
            UnknownNameError: The link does not exist; the error has this `origin`.
        """
        self.link(link, origin=origin)
        handle = WrenchHandle(self.name, link)
        self.handles.append(handle)
        return handle

    def feel(self, link: str) -> None:
        """Keeps bodies in contact with the link awake, because sleeping bodies exert no force."""
        self._entry.felt.append(link)

    def slip(self, link: str, *, radius: float, origin: Origin | None = None) -> SlipHandle:
        """A wheel's slip on the ground.

        Raises:
            UnknownNameError: The link does not exist; the error has this `origin`.
            PluginError: The link is not a wheel, or another plugin already sets its slip.
        """
        self.link(link, origin=origin)
        joint = next((each for each in self.description.joints if each.child == link), None)
        if axle_of(joint) is None:
            raise PluginError(
                f'link "{link}" is not a wheel because no continuous joint turns it',
                code=running.NOT_A_WHEEL,
                origin=origin,
                values={"link": link},
            )
        if link in self._entry.slips:
            raise PluginError(
                f'two plugins set the slip of link "{link}"',
                code=running.JOINT_DRIVEN_TWICE,
                origin=origin,
                values={"link": link},
            )
        self._entry.slips[link] = radius
        handle = SlipHandle(self.name, link, radius)
        self.handles.append(handle)
        return handle

    def attachment(self) -> AttachmentHandle:
        """A fixed joint between links of any models, which can be added and removed at any time."""
        name = scoped(self.name, "attachment", str(len(self._entry.attachments)))
        self._entry.attachments.append(name)
        handle = AttachmentHandle(name)
        self.handles.append(handle)
        if self.spawned:
            for callback in self._engine.on_entries:
                callback()
        return handle

    def surroundings(self) -> SurroundingsHandle:
        """All links in the world, including those of other models."""
        handle = SurroundingsHandle()
        self.handles.append(handle)
        return handle

    def camera(
        self, name: str, link: str, pose: Pose, intrinsics: CameraIntrinsics
    ) -> CameraHandle:
        """A camera on a link, looking along the x axis of `pose`."""
        taken = {mount.name for mount in self._entry.cameras}
        unique = name
        count = 1
        while unique in taken:
            count += 1
            unique = f"{name}_{count}"
        self._entry.cameras.append(
            CameraMount(name=unique, link=link, pose=pose, intrinsics=intrinsics)
        )
        handle = CameraHandle(self.name, unique, intrinsics)
        self.handles.append(handle)
        return handle

    def rays(
        self, link: str, pose: Pose, directions: Array, *, minimum: float, maximum: float,
        visuals: bool = False,
    ) -> RayHandle:  # fmt: skip
        """Rays from a link into the world, which hit visuals or collisions; see `RayHandle`."""
        engine = self._engine
        if (missing := engine.ray_scenes.missing()) is not None:
            self.report(missing)
        handle = RayHandle(
            self.name, link, pose, directions, minimum=minimum, maximum=maximum,
            scenes=engine.ray_scenes, visuals=engine.visuals if visuals else None,
        )  # fmt: skip
        self.handles.append(handle)
        return handle
