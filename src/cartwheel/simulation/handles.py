"""Parts of a running model that plugins hold: names resolved once for each compiled model.

Spawning and deleting compile anew and move every index; the simulation binds all handles
again, so a plugin keeps its handle for its life. For the simulation's thread alone.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import mujoco
import numpy as np

from cartwheel.description.model import CameraIntrinsics
from cartwheel.geometry import Array, Pose, from_wxyz
from cartwheel.world.entry import Motor, scoped

_OBJ = mujoco.mjtObj


class LinkHandle:
    """A link's frame and motion.

    Args:
        model: Name of the model.
        link: Name of the link.
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

    @property
    def pose(self) -> Pose:
        """The link's frame in the world."""
        x, y, z = self._position.tolist()
        return Pose((x, y, z), from_wxyz(self._quaternion.tolist()))

    def velocity(self, *, local: bool) -> tuple[Array, Array]:
        """Linear velocity of the link's origin in m/s and angular in rad/s, each shape (3,).

        Args:
            local: In the link's axes; else in the world's.
        """
        six = self._six
        mujoco.mj_objectVelocity(
            self._model, self._data, _OBJ.mjOBJ_XBODY, self.id, six, int(local)
        )
        return six[3:].copy(), six[:3].copy()

    def proper_acceleration(self, offset: Sequence[float] = (0.0, 0.0, 0.0)) -> Array:
        """What an accelerometer reads: m/s², link axes, gravity's reaction included, shape (3,).

        Args:
            offset: Where it sits in the link, m.
        """
        six = np.zeros(6)
        # Fills the accelerations of all bodies, which stepping alone does not need.
        mujoco.mj_rnePostConstraint(self._model, self._data)
        mujoco.mj_objectAcceleration(self._model, self._data, _OBJ.mjOBJ_XBODY, self.id, six, 1)
        acceleration: Array = six[3:]
        if any(offset):
            arm = np.asarray(offset, dtype=float)
            _, rate = self.velocity(local=True)
            acceleration = (
                acceleration + np.cross(six[:3], arm) + np.cross(rate, np.cross(rate, arm))
            )
        return acceleration


class JointHandle:
    """A joint of one degree of freedom."""

    def __init__(self, model: str, joint: str) -> None:
        self.model_name = model
        self.name = joint

    def bind(self, model: Any, data: Any) -> None:
        """Resolves the name in a compiled model."""
        self.id = mujoco.mj_name2id(model, _OBJ.mjOBJ_JOINT, scoped(self.model_name, self.name))
        self._qpos, self._qvel = data.qpos, data.qvel
        self._position_index = int(model.jnt_qposadr[self.id])
        self._velocity_index = int(model.jnt_dofadr[self.id])

    @property
    def position(self) -> float:
        """rad or m."""
        return float(self._qpos[self._position_index])

    @position.setter
    def position(self, value: float) -> None:
        self._qpos[self._position_index] = value

    @property
    def velocity(self) -> float:
        """rad/s or m/s."""
        return float(self._qvel[self._velocity_index])

    @velocity.setter
    def velocity(self, value: float) -> None:
        self._qvel[self._velocity_index] = value


class MotorHandle:
    """A driven joint: a velocity servo with limited effort, or an effort."""

    def __init__(self, model: str, motor: Motor) -> None:
        self.model_name = model
        self.motor = motor
        self.target = 0.0

    def bind(self, model: Any, data: Any) -> None:
        """Resolves the name in a compiled model."""
        name = scoped(self.model_name, self.motor.joint)
        self.id = mujoco.mj_name2id(model, _OBJ.mjOBJ_ACTUATOR, name)
        self._ctrl, self._force = data.ctrl, data.actuator_force
        self._ctrl[self.id] = self.target

    def command(self, target: float) -> None:
        """Sets the target: rad/s or m/s of a velocity motor, N m or N of an effort motor."""
        self.target = target
        self._ctrl[self.id] = target

    @property
    def effort(self) -> float:
        """N m or N that the motor gives."""
        return float(self._force[self.id])


class CameraHandle:
    """A camera that the renderer can look through."""

    def __init__(self, model: str, name: str, intrinsics: CameraIntrinsics) -> None:
        self.model_name = model
        self.name = name
        self.intrinsics = intrinsics
        self.id = -1

    def bind(self, model: Any, data: Any) -> None:  # noqa: ARG002 - all handles bind alike
        """Resolves the name in a compiled model."""
        self.id = mujoco.mj_name2id(model, _OBJ.mjOBJ_CAMERA, scoped(self.model_name, self.name))


Handle = LinkHandle | JointHandle | MotorHandle | CameraHandle
