"""Handles to parts of the model for plugins, with names resolved once per compiled model.

Spawning and deleting recompile the model and change every index. The simulation binds all handles
again, so a plugin can keep its handles. Use them only on the simulation's thread.
"""

from __future__ import annotations

from collections.abc import Sequence
from math import atan2, cos, sin
from typing import Any

import mujoco
import numpy as np

from cartwheel.description.model import CameraIntrinsics
from cartwheel.geometry import (
    Array,
    Pose,
    Quat,
    Vec3,
    cross,
    from_wxyz,
    matrix_from_quat,
    quat_multiply,
    rotate,
)
from cartwheel.simulation.dynamics.external_servos import BodyDriveHandle, WrenchHandle
from cartwheel.simulation.dynamics.fixed_joints import AttachmentHandle, SurroundingsHandle
from cartwheel.simulation.dynamics.joint_servo import ServoHandle
from cartwheel.simulation.dynamics.moving_surface import SurfaceHandle
from cartwheel.simulation.dynamics.velocity_motor import JointStop, MotorHandle
from cartwheel.simulation.dynamics.wheel_slip import SlipHandle
from cartwheel.world.entry import ROTOR, scoped

_OBJ = mujoco.mjtObj
_XBODY = _OBJ.mjOBJ_XBODY.value  # Converting an enumeration takes a quarter of a call.
_JOINT = mujoco.mjtJoint
_MOTOR_ROW = mujoco.mjtConstraint.mjCNSTR_FRICTION_TENDON.value


class LinkHandle:
    """A link's frame and motion.

    Args:
        model: Model name.
        link: Link name.
    """

    def __init__(self, model: str, link: str) -> None:
        self.model_name = model
        self.name = link
        self._six = np.zeros(6)

    def bind(self, model: Any, data: Any) -> None:
        """Resolves the name in a compiled model."""
        self._model, self._data = model, data
        self.id = mujoco.mj_name2id(model, _OBJ.mjOBJ_BODY, scoped(self.model_name, self.name))
        self._position, self._quaternion = data.xpos[self.id], data.xquat[self.id]
        self._spatial = data.cvel[self.id]
        self._centre = data.subtree_com[model.body_rootid[self.id]]
        self.moves = bool(model.body_treeid[self.id] >= 0)
        """Whether the link can move: it is neither static nor fixed to the world."""

    @property
    def pose(self) -> Pose:
        """The link's frame in the world."""
        return Pose(*self.place())

    def place(self) -> tuple[Vec3, Quat]:
        """Position and orientation of `pose` as plain tuples, for high-rate access."""
        x, y, z = self._position.tolist()
        qw, qx, qy, qz = self._quaternion.tolist()
        return (x, y, z), (qx, qy, qz, qw)

    def turn(self) -> Quat:
        """Orientation of `pose`, as `place` returns it."""
        qw, qx, qy, qz = self._quaternion.tolist()
        return (qx, qy, qz, qw)

    def motion(self, *, local: bool) -> tuple[Vec3, Vec3]:
        """`velocity` as plain tuples."""
        if local:
            mujoco.mj_objectVelocity(self._model, self._data, _XBODY, self.id, self._six, 1)
            wx, wy, wz, vx, vy, vz = self._six.tolist()
            return (vx, vy, vz), (wx, wy, wz)
        return self.motion_at(self._position.tolist())

    def motion_at(self, point: Sequence[float]) -> tuple[Vec3, Vec3]:
        """Linear velocity of a point on the link and the link's angular velocity, in world axes.

        Args:
            point: In the world, m.
        """
        # Equivalent to mj_objectVelocity in world axes, but cheaper. MuJoCo stores a body's
        # velocity at the centre of mass of its kinematic tree.
        wx, wy, wz, vx, vy, vz = self._spatial.tolist()
        x, y, z = point
        cx, cy, cz = self._centre.tolist()
        x, y, z = x - cx, y - cy, z - cz
        return (vx - (y * wz - z * wy), vy - (z * wx - x * wz), vz - (x * wy - y * wx)), (
            wx,
            wy,
            wz,
        )

    def planar_motion(self) -> tuple[Vec3, Quat, Vec3, Vec3]:
        """`place`, and the velocity in the plane along the heading, m/s and rad/s."""
        # This is `place`, `motion_at` and `yaw_of` inlined: it runs for each message of odometry.
        x, y, z = place = tuple(self._position.tolist())
        qw, qx, qy, qz = self._quaternion.tolist()
        wx, wy, wz, vx, vy, _ = self._spatial.tolist()
        cx, cy, cz = self._centre.tolist()
        z -= cz
        vx -= (y - cy) * wz - z * wy
        vy -= z * wx - (x - cx) * wz
        yaw = atan2(2 * (qw * qz + qx * qy), 1 - 2 * (qy * qy + qz * qz))
        c, s = cos(yaw), sin(yaw)
        return place, (qx, qy, qz, qw), (c * vx + s * vy, c * vy - s * vx, 0.0), (0.0, 0.0, wz)

    def velocity(self, *, local: bool) -> tuple[Array, Array]:
        """Linear velocity of the link's origin in m/s and angular velocity in rad/s, each shape
        (3,).

        Args:
            local: Use the link's axes instead of the world's.
        """
        linear, angular = self.motion(local=local)
        return np.array(linear), np.array(angular)

    def proper_acceleration(self, offset: Sequence[float] = (0.0, 0.0, 0.0)) -> Array:
        """Acceleration as measured by an accelerometer, with gravity: m/s², link axes, shape (3,).

        Args:
            offset: The accelerometer's position in the link, m.
        """
        return self._acceleration(offset)[0]

    def felt(self, offset: Sequence[float]) -> list[float]:
        """`proper_acceleration` as plain numbers, for high-rate access."""
        if any(offset) or not self.moves:
            return [*self._acceleration(offset)[0].tolist()]
        self._find_accelerations()
        mujoco.mj_objectAcceleration(self._model, self._data, _XBODY, self.id, self._six, 1)
        return [*self._six.tolist()[3:]]

    def acceleration(self, offset: Sequence[float] = (0.0, 0.0, 0.0)) -> tuple[Vec3, Vec3]:
        """Linear and angular acceleration of a point on the link, m/s² and rad/s², in world axes.

        Args:
            offset: The point in the link, m.
        """
        proper, angular = self._acceleration(offset)
        turn: Array = self._data.xmat[self.id].reshape(3, 3)
        ax, ay, az = (turn @ proper + self._model.opt.gravity).tolist()
        wx, wy, wz = (turn @ angular).tolist()
        return (ax, ay, az), (wx, wy, wz)

    def _acceleration(self, offset: Sequence[float]) -> tuple[Array, Array]:
        """`proper_acceleration` and the angular acceleration in rad/s², link axes."""
        if not self.moves:
            # The engine computes no acceleration for fixed bodies, so only gravity remains.
            turn: Array = self._data.xmat[self.id].reshape(3, 3)
            weight: Array = -turn.T @ self._model.opt.gravity
            return weight, np.zeros(3)
        self._find_accelerations()
        six = np.empty(6)
        mujoco.mj_objectAcceleration(self._model, self._data, _XBODY, self.id, six, 1)
        acceleration: Array = six[3:]
        if any(offset):
            arm = np.asarray(offset, dtype=float)
            _, rate = self.velocity(local=True)
            acceleration = acceleration + cross(six[:3], arm) + cross(rate, cross(rate, arm))
        return acceleration, six[:3]

    def _find_accelerations(self) -> None:
        """Computes accelerations and forces of all bodies, which stepping alone does not need.

        The sensors of a state share them.
        """
        if not self._data.flg_rnepost:
            mujoco.mj_rnePostConstraint(self._model, self._data)

    def reaction(self, point: Sequence[float] = (0.0, 0.0, 0.0)) -> tuple[Array, Array]:
        """Force in N and torque in N m that the link exerts on its parent through their joint.

        Each has shape (3,), in the link's axes. The torque is about `point`, given in the link
        frame, m.
        """
        self._find_accelerations()
        # MuJoCo stores the parent's action on the link, about the tree's centre of mass.
        torque, force = self._data.cfrc_int[self.id, :3], self._data.cfrc_int[self.id, 3:]
        if self._model.flg_gravcomp:
            lift, about_centre = self._compensation()
            force, torque = force - lift, torque - about_centre
        turn: Array = self._data.xmat[self.id].reshape(3, 3)
        about = self._position + turn @ np.asarray(point, dtype=float)
        torque = torque - cross(about - self._centre, force)
        return -turn.T @ force, -turn.T @ torque

    def _compensation(self) -> tuple[Array, Array]:
        """Forces that cancel gravity on the link and on what it carries: N and N m.

        In world axes, about the tree's centre of mass. MuJoCo's forces between bodies lack them.
        """
        model, parents = self._model, self._model.body_parentid
        end = self.id + 1
        # The bodies that a body carries follow it.
        while end < model.nbody and parents[end] >= self.id:
            end += 1
        carried = slice(self.id, end)
        masses = model.body_gravcomp[carried] * model.body_mass[carried]
        lifts = -masses[:, None] * model.opt.gravity
        arms = self._data.xipos[carried] - self._centre
        return lifts.sum(axis=0), np.cross(arms, lifts).sum(axis=0)

    def load(self) -> tuple[Array, Array]:
        """Force in N and torque in N m on the link from contacts, pushes and attachments.

        Each has shape (3,), in world axes. The torque is about the link's centre of mass.
        """
        self._find_accelerations()
        # MuJoCo stores it about the tree's centre of mass.
        torque, force = self._data.cfrc_ext[self.id, :3], self._data.cfrc_ext[self.id, 3:]
        arm = self._data.xipos[self.id] - self._centre
        return force.copy(), torque - cross(arm, force)

    @property
    def gravity(self) -> list[float]:
        """Gravity, m/s², in world axes."""
        pull: list[float] = self._model.opt.gravity.tolist()
        return pull

    @property
    def mass(self) -> float:
        """Mass, kg."""
        return float(self._model.body_mass[self.id])

    @property
    def inertia(self) -> Array:
        """Principal moments of inertia about the centre of mass, kg m², shape (3,)."""
        turn = matrix_from_quat(from_wxyz(self._model.body_iquat[self.id].tolist()))
        moments: Array = (turn**2) @ self._model.body_inertia[self.id]
        return moments


class JointHandle:
    """A joint with one degree of freedom."""

    def __init__(self, model: str, joint: str) -> None:
        self.model_name = model
        self.name = joint

    def bind(self, model: Any, data: Any) -> None:
        """Resolves the name in a compiled model."""
        self.id = mujoco.mj_name2id(model, _OBJ.mjOBJ_JOINT, scoped(self.model_name, self.name))
        self._data = data
        # Memory views contain Python floats, and are cheaper than arrays.
        self.qpos: Any = memoryview(data.qpos)
        self.qvel: Any = memoryview(data.qvel)
        """Positions and velocities of the compiled model; `qposadr` and `dofadr` are the joint's
        indices. A caller at a high rate may read them itself, as `position` and `velocity` do.
        """
        rotor = scoped(self.model_name, self.name, ROTOR)
        self._motor = mujoco.mj_name2id(model, _OBJ.mjOBJ_TENDON, rotor)
        self.qposadr = int(model.jnt_qposadr[self.id])
        self.dofadr = int(model.jnt_dofadr[self.id])
        body = int(model.jnt_bodyid[self.id])
        self._rest: Vec3 = tuple(model.body_pos[body].tolist())
        self._rest_turn = from_wxyz(model.body_quat[body].tolist())
        self._anchor: Vec3 = tuple(model.jnt_pos[self.id].tolist())
        self._axis: Vec3 = tuple(model.jnt_axis[self.id].tolist())
        self._off_centre = any(self._anchor)
        self._axis_turn = quat_multiply(self._rest_turn, (*self._axis, 0.0))
        """The product of the orientation at rest and the axis."""
        self._terms = (*self._rest_turn, *self._axis_turn)
        self._slides = bool(model.jnt_type[self.id] == _JOINT.mjJNT_SLIDE)
        self._zero = float(model.qpos0[self.qposadr])
        self.lightness = float(model.dof_invweight0[self.dofadr])
        """Acceleration per effort, 1/(kg m²) or 1/kg, with everything that the joint carries, where
        it was spawned.
        """

    @property
    def position(self) -> float:
        """Position, rad or m."""
        position: float = self.qpos[self.qposadr]
        return position

    @position.setter
    def position(self, value: float) -> None:
        self.qpos[self.qposadr] = value

    @property
    def velocity(self) -> float:
        """Velocity, rad/s or m/s."""
        velocity: float = self.qvel[self.dofadr]
        return velocity

    @velocity.setter
    def velocity(self, value: float) -> None:
        self.qvel[self.dofadr] = value

    @property
    def effort(self) -> float:
        """Effort of the joint's drive in N m or N: a motor, a servo or a commanded effort."""
        data = self._data
        effort = float(data.qfrc_actuator[self.dofadr])
        if self._motor >= 0:
            rows = (data.efc_type == _MOTOR_ROW) & (data.efc_id == self._motor)
            effort += float(data.efc_force[rows].sum())
        return effort

    def child_place(self) -> tuple[Vec3, Quat]:
        """Position and orientation of the child link in the parent link.

        Computed only from the joint's position, so it is exact anywhere in the world.
        """
        moved = self.qpos[self.qposadr] - self._zero
        if self._slides:
            x, y, z = self._axis
            dx, dy, dz = rotate(self._rest_turn, (x * moved, y * moved, z * moved))
            px, py, pz = self._rest
            return (px + dx, py + dy, pz + dz), self._rest_turn
        # The orientation at rest times the rotation: this runs for each wheel at the rate of
        # odometry.
        half = moved / 2
        s, c = sin(half), cos(half)
        ax, ay, az, aw, x, y, z, w = self._terms
        turn = (ax * c + x * s, ay * c + y * s, az * c + z * s, aw * c + w * s)
        if not self._off_centre:
            return self._rest, turn
        # The anchor is fixed.
        px, py, pz = self._rest
        ax, ay, az = rotate(self._rest_turn, self._anchor)
        dx, dy, dz = rotate(turn, self._anchor)
        return (px + ax - dx, py + ay - dy, pz + az - dz), turn


class JointsHandle:
    """Several joints that are read together, which is cheaper than reading each one.

    Args:
        joints: Joints of one model, bound before this handle.
    """

    def __init__(self, joints: Sequence[JointHandle]) -> None:
        self._joints = tuple(joints)

    def bind(self, model: Any, data: Any) -> None:  # noqa: ARG002 - all handles bind alike
        """Stores the joints' indices in a compiled model."""
        self._qpos, self._qvel = data.qpos, data.qvel
        self._positions_at = np.array([joint.qposadr for joint in self._joints], dtype=np.intp)
        self._velocities_at = np.array([joint.dofadr for joint in self._joints], dtype=np.intp)

    def positions(self) -> Array:
        """Positions, rad or m; a new array of shape (joints,)."""
        positions: Array = self._qpos[self._positions_at]
        return positions

    def velocities(self) -> Array:
        """Velocities, rad/s or m/s; a new array of shape (joints,)."""
        velocities: Array = self._qvel[self._velocities_at]
        return velocities

    def efforts(self) -> Array:
        """Efforts, N m or N; a new array of shape (joints,); see `JointHandle.effort`."""
        return np.array([joint.effort for joint in self._joints])


class CameraHandle:
    """A camera for the renderer."""

    def __init__(self, model: str, name: str, intrinsics: CameraIntrinsics) -> None:
        self.model_name = model
        self.name = name
        self.intrinsics = intrinsics
        self.id = -1

    def bind(self, model: Any, data: Any) -> None:  # noqa: ARG002 - all handles bind alike
        """Resolves the name in a compiled model."""
        self.id = mujoco.mj_name2id(model, _OBJ.mjOBJ_CAMERA, scoped(self.model_name, self.name))


Handle = (
    LinkHandle
    | JointHandle
    | JointsHandle
    | JointStop
    | MotorHandle
    | ServoHandle
    | CameraHandle
    | BodyDriveHandle
    | WrenchHandle
    | AttachmentHandle
    | SurroundingsHandle
    | SlipHandle
    | SurfaceHandle
)
