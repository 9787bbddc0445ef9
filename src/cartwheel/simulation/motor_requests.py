"""A plugin's requests for motors of joints, and for a drive of the whole model."""

from __future__ import annotations

import math
from collections.abc import Collection, Mapping
from dataclasses import replace
from functools import partial

import numpy as np

from cartwheel.codes import running
from cartwheel.description.kinematics import link_poses
from cartwheel.description.model import Mimic
from cartwheel.description.solids import solid_of
from cartwheel.errors import Origin, PluginError
from cartwheel.geometry import Array, Pose
from cartwheel.simulation.dynamics.external_servos import BodyDriveHandle
from cartwheel.simulation.dynamics.joint_servo import Efforts, ServoHandle
from cartwheel.simulation.dynamics.velocity_motor import JointStop, MotorHandle
from cartwheel.simulation.requests import Requests
from cartwheel.world.entry import BodyDrive, Motor

_DRIVE_WEIGHTS = 5.0
"""Maximum force of a whole-model servo, as a multiple of the weight: well above any friction."""
_DRIVE_BAND = 0.05
"""Velocity error at which the servo reaches its maximum force, m/s or rad/s."""
_UPRIGHT_WEIGHTS = 2.0
"""Maximum torque of an upright servo, as a multiple of the weight at the height of the centre of
mass: the friction tilts with at most 1. Ramps still pitch a base that is wider than it is high."""
_TILT_BAND = 0.01
"""Roll or pitch rate at which an upright servo reaches its maximum torque, rad/s."""
_DRIVE_ARM = 0.1
"""Minimum lever arm for the maximum torque, m."""
_LAST = 1 << 40
"""Added to the order of a task that runs after all those that command motors."""


class MotorRequests(Requests):
    """Creates handles to motors, and adds the motors to the model."""

    def velocity_motor(
        self,
        joint: str,
        *,
        max_effort: float | None,
        beyond: bool = False,
        replaces_friction: bool = False,
        yields: bool = False,
        repeats: bool = False,
        origin: Origin | None = None,
    ) -> MotorHandle:
        """A motor that holds a joint's velocity with at most `max_effort` N m or N.

        Several requests for the same joint share the first motor whose owner does not yield, or the
        last one if all owners repeat their commands. If a servo already drives the joint, the motor
        is shared; see `ServoHandle`.

        Args:
            joint: Joint name.
            max_effort: N m or N.
            beyond: Whether `max_effort` may exceed the joint's effort limit.
            replaces_friction: Whether the joint's own dry friction has no effect. ODE uses one
                parameter for friction and the maximum torque of a motor.
            yields: Whether the caller leaves the joint to others while it has no command for it. It
                then reports itself when both drive the joint.
            repeats: Whether the caller is a drive of Gazebo, which commands the joint at each
                update, even with 0. Of several such drives, only the last one has an effect, with
                its torque.
            origin: Origin of the request, for errors.
        """
        self.joint(joint, origin=origin)
        motor = self._entry.motors.get(joint)
        made = Motor(
            joint=joint,
            mode="velocity",
            max_effort=max_effort,
            beyond=beyond,
            replaces_friction=replaces_friction,
        )
        if motor is not None and motor.mode == "servo":
            motor = self._share(motor, max_effort)
        elif motor is None or (
            not yields
            and all(each.yields or (repeats and _repeats(each)) for each in self._drives(joint))
        ):
            motor = self._entry.motors[joint] = made
        handle = MotorHandle(motor, self._stop(joint), yields=yields, repeats=repeats)
        self._add_drive(handle, origin)
        return handle

    def servo(
        self,
        joint: str,
        *,
        max_effort: float | None,
        beyond: bool = False,
        yields: bool = False,
        efforts: Efforts | None = None,
        origin: Origin | None = None,
    ) -> ServoHandle:
        """A joint drive with effort, velocity or position commands.

        If a drive plugin already drives the joint, the motor is shared; see `ServoHandle`.

        Args:
            joint: Joint name.
            max_effort: N m or N; at most the joint's own limit.
            beyond: Whether positions and velocities may use more than the joint's limit.
            yields: See `velocity_motor`.
            efforts: How efforts combine with those of another request, if the caller commands
                nothing else; see `add_effort`.
            origin: Origin of the request, for errors.
        """
        self.joint(joint, origin=origin)
        made = Motor(joint=joint, mode="servo", max_effort=max_effort, beyond=beyond)
        motor = self._entry.motors.setdefault(joint, made)
        drives = motor.mode == "velocity"
        handle = ServoHandle(self.name, motor, yields=yields, efforts=efforts)
        self._add_drive(handle, origin)
        if drives:
            self._share(motor, motor.max_effort)
        servos = self._servos(joint)
        # A further servo of a shared motor leaves the velocity to the drive as well.
        handle.shared = any(each.shared for each in servos)
        for servo in servos:
            servo.alone = len(servos) == 1 and not servo.shared
        task = self.schedule(0, before=handle.follow)
        task.asleep = task.reads_state = True
        handle.wake = partial(self._engine.wake, task)
        return handle

    def add_effort(self, handle: ServoHandle, effort: float) -> None:
        """Applies an effort in N m or N, in addition to that of another plugin on the same joint.

        Args:
            handle: A handle whose efforts are added.
            effort: N m or N.
        """
        others = [each for each in self._servos(handle.motor.joint) if _are_added(handle, each)]
        for each in others:
            each.add(effort)
        if not others:
            handle.command_effort(effort)

    def _stop(self, joint: str) -> JointStop:
        """Stops the motors of a joint at its limits."""
        for each in self.handles:
            if isinstance(each, JointStop) and each.name == joint:
                return each
        stop = JointStop(self.name, joint, partial(self._servos, joint))
        self.handles.append(stop)
        task = self.schedule(0, before=stop.follow, idle=stop.rests)
        task.order += _LAST
        task.asleep = task.reads_state = True
        stop.wake = partial(self._engine.wake, task)
        return stop

    def _drives(self, joint: str) -> list[MotorHandle | ServoHandle]:
        drives = (h for h in self.handles if isinstance(h, MotorHandle | ServoHandle))
        return [each for each in drives if each.motor.joint == joint]

    def _servos(self, joint: str) -> list[ServoHandle]:
        return [each for each in self._drives(joint) if isinstance(each, ServoHandle)]

    def _add_drive(self, handle: MotorHandle | ServoHandle, origin: Origin | None) -> None:
        """Adds a handle to its joint, and reports others that drive the joint at the same time."""
        joint = handle.motor.joint
        others = self._drives(joint)
        self.handles.append(handle)
        # One of two that yield must hold the joint.
        second = handle.yields and any(each.yields for each in others)
        handle.yields = handle.yields and not second
        drives = [*others, handle]
        for each in drives:
            each.rivalled = any(not one.yields for one in drives if one is not each)
        rivals = [
            each for each in others if (second or not each.yields) and not _are_added(handle, each)
        ]
        if handle.yields or not rivals:
            return
        kinds = {type(each) for each in (*rivals, handle)}
        repeating = [each for each in rivals if isinstance(each, MotorHandle) and each.repeats]
        if _repeats(handle) and repeating:
            for each in repeating:
                each.overrule()
            result = "as in Gazebo, only the last one has an effect, with its torque"
            self.report_two_drives(joint, result, origin)
        elif len(kinds) == 1:
            self.report_two_drives(joint, "the last command is used", origin)
        else:
            self.report_two_drives(joint, "the efforts of both plugins are added", origin)

    def contest(
        self, joint: str, handle: MotorHandle | ServoHandle, *, sets_motor: bool
    ) -> list[MotorHandle] | None:
        """Decides whether a controller or the drive plugins of its joint turn it.

        All of them command it at each update. In gz-sim, they set the same command, so the last one
        in the file wins. In Gazebo Classic, gazebo_ros2_control sets the velocity of the joint once
        in each step, in which the motor of a drive turns it back.

        Args:
            joint: Joint name.
            handle: The handle with the commands of the controller.
            sets_motor: Whether it commands the same motor as the drives.

        Returns:
            The handles of drives that have no effect from now on; None if the controller has none.
        """
        drives = self._drives(joint)
        rivals = [
            each
            for each in drives
            if isinstance(each, MotorHandle) and each.repeats and each is not handle
        ]
        after = any(drives.index(each) > drives.index(handle) for each in rivals)
        if rivals and (after or not sets_motor):
            return None
        overruled = [each for each in rivals if not each.overruled]
        for each in overruled:
            each.overrule()
        return overruled

    def _share(self, motor: Motor, max_effort: float | None) -> Motor:
        """Shares a joint's motor between a drive, which sets its strength, and a servo."""
        shared = replace(motor, mode="servo", max_effort=max_effort)
        self._entry.motors[motor.joint] = shared
        for handle in self._servos(motor.joint):
            handle.shared, handle.alone = True, False
        return shared

    def report_two_drives(self, joint: str, result: str, origin: Origin | None) -> None:
        """Reports that two plugins drive a joint.

        Args:
            joint: Joint name.
            result: What becomes of it.
            origin: Origin of the second plugin's request.
        """
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
        self,
        *,
        gains: tuple[float, float] | None = None,
        upright: bool = False,
        at: Collection[str] = (),
        origin: Origin | None = None,
    ) -> BodyDriveHandle:
        """A servo that moves the whole model by its canonical link.

        Its force acts at the centre of mass, or at that of some links.

        Args:
            gains: Force gain in N s/m and torque gain in N m s/rad, without a limit. None is as
                stiff as possible, with at most `_DRIVE_WEIGHTS` times the model's weight.
            upright: Whether the torque about the vertical also overcomes friction at the farthest
                collision, and level commands also hold the roll and pitch rates at 0, so that
                friction at the bottom of the model does not tip it over. The torque is then at most
                `_UPRIGHT_WEIGHTS` times the weight, at the height of the centre of mass.
            at: Links at whose centre of mass the force acts; they are fixed to the root link.
            origin: Origin for errors.

        Raises:
            PluginError: The model cannot move, or has no mass.
        """
        description = self.description
        link = description.link(description.canonical_link)
        if link is None or not description.is_free:
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
            (other.inertial, (to_link @ poses[other.name]).apply(other.inertial.pose.position))
            for other in description.links
            if other.inertial is not None
        ]
        for inertial, place in places:
            centre += inertial.mass / description.mass * np.array(place)
        for inertial, place in places:
            # The square of the radius of gyration about the centre of mass, m².
            far = inertial.mass * float(np.sum((np.array(place) - centre) ** 2))
            reach += (far + sum(inertial.diagonal) / 2) / description.mass
        band = _DRIVE_BAND if gains is None else math.inf
        height, width = self._extent(to_link, poses, centre) if upright else (0.0, 0.0)
        if gains is None:
            force = _DRIVE_WEIGHTS * 9.8 * description.mass / _DRIVE_BAND
            gains = (force, force * max(_DRIVE_ARM, 2 * reach**0.5, width))
        tilt = _UPRIGHT_WEIGHTS * 9.8 * description.mass * height / _TILT_BAND
        pushed = [
            (each.inertial.mass, (to_link @ poses[each.name]).apply(each.inertial.pose.position))
            for each in description.links
            if each.name in at and each.inertial is not None
        ]
        if weight := sum(mass for mass, _ in pushed):
            centre = sum((mass / weight * np.array(place) for mass, place in pushed), np.zeros(3))
        drive = BodyDrive(
            link=link.name,
            centre=(float(centre[0]), float(centre[1]), float(centre[2])),
            force_gain=gains[0],
            torque_gain=gains[1],
            band=band,
            tilt_gain=tilt,
            tilt_band=_TILT_BAND,
            number=len(self._entry.drives),
        )
        self._entry.drives.append(drive)
        handle = BodyDriveHandle(self.name, drive)
        self.handles.append(handle)
        self.schedule(0, before=handle.hold).reads_state = True
        return handle

    def _extent(
        self, to_link: Pose, poses: Mapping[str, Pose], centre: Array
    ) -> tuple[float, float]:
        """Height of the centre of mass above the lowest collision, and distance of the farthest
        collision from the vertical through it, m.

        Args:
            to_link: The model's frame in the root link.
            poses: Poses of the links in the model's frame.
            centre: Centre of mass in the root link, shape (3,), m.
        """
        clouds = [
            solid.placed(to_link @ poses[link.name])
            for link in self.description.links
            for part in link.collisions
            if (solid := solid_of(part, link.name)) is not None
        ]
        if not clouds:
            return 0.0, 0.0
        gaps = np.concatenate(clouds) - centre
        radii = np.hypot(gaps[:, 0], gaps[:, 1])
        return max(0.0, float(-gaps[:, 2].min())), float(radii.max())


def _are_added(one: MotorHandle | ServoHandle, other: MotorHandle | ServoHandle) -> bool:
    """Whether the efforts of two handles are added, so that neither disturbs the other."""
    if not (isinstance(one, ServoHandle) and isinstance(other, ServoHandle)):
        return False
    return {one.efforts, other.efforts} == {"set", "added"}


def _repeats(handle: MotorHandle | ServoHandle) -> bool:
    """Whether the owner of a handle commands its joint at each update."""
    return isinstance(handle, MotorHandle) and handle.repeats
