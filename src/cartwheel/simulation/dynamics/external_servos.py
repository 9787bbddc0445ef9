"""External servos and forces on whole models and links."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

import mujoco
import numpy as np

from cartwheel.geometry import Vec3, rotate
from cartwheel.world.entry import DRIVE_AXES, BodyDrive, scoped

_OBJ = mujoco.mjtObj
_FREE: tuple[float | None, ...] = (None,) * 6


class BodyDriveHandle:
    """A servo that moves a whole model by its root link; inactive until the first command."""

    def __init__(self, model: str, drive: BodyDrive) -> None:
        self.model_name = model
        self.drive = drive
        self._velocity: tuple[float | None, ...] = _FREE
        self._linear_target: Vec3 = (0.0, 0.0, 0.0)
        self._angular_target: Vec3 = (0.0, 0.0, 0.0)
        self._level = True
        self._bands = (drive.band,) * 6
        """Largest velocity error of each axis, m/s or rad/s."""
        self._rows = range(0)
        """Actuator ids; empty until the model is compiled."""
        self._holds = False
        """Whether `hold` has anything to do."""

    def bind(self, model: Any, data: Any) -> None:
        """Resolves the names in a compiled model."""
        link = scoped(self.model_name, self.drive.link)
        name = scoped(link, self.drive.name, DRIVE_AXES[0])
        first = mujoco.mj_name2id(model, _OBJ.mjOBJ_ACTUATOR, name)
        last = first + len(DRIVE_AXES)
        # Memory views contain Python floats, and are cheaper than arrays.
        self._ctrl: Any = memoryview(data.ctrl)[first:last]
        self._gain, self._bias = model.actuator_gainprm, model.actuator_biasprm
        self._rows = range(first, last)
        joint = mujoco.mj_name2id(model, _OBJ.mjOBJ_JOINT, link)
        position, velocity = int(model.jnt_qposadr[joint]), int(model.jnt_dofadr[joint])
        self._turned: Any = memoryview(data.qpos)[position + 3 : position + 7]
        self._motion: Any = memoryview(data.qvel)[velocity : velocity + 6]
        self._enable()
        self.hold()

    def command(
        self,
        linear: Sequence[float | None],
        angular: Sequence[float | None],
        *,
        level: bool = True,
    ) -> None:
        """Sets the velocity of the link's origin until the next command, in the link's axes.

        Args:
            linear: m/s; None leaves a direction free.
            angular: rad/s; None leaves a direction free.
            level: Use axes that follow only the link's heading, with z up. The drive's `tilt_gain`
                then damps rotation about x and y.
        """
        if level and self.drive.tilt_gain and any(value is not None for value in linear):
            angular = (angular[0] or 0.0, angular[1] or 0.0, angular[2])
        self._velocity = (*linear, *angular)
        x, y, z, *turn = (value or 0.0 for value in self._velocity)
        self._linear_target, self._angular_target = (x, y, z), (turn[0], turn[1], turn[2])
        self._level = level
        self._enable()
        self.hold()

    def release(self) -> None:
        """Lets the model move freely."""
        self.command((None,) * 3, (None,) * 3)

    def _enable(self) -> None:
        self._holds = bool(self._rows) and self._velocity != _FREE
        drive = self.drive
        tilt = (drive.torque_gain, drive.band)
        if self._level and drive.tilt_gain:
            tilt = (drive.tilt_gain, drive.tilt_band)
        gains = (*(drive.force_gain,) * 3, tilt[0], tilt[0], drive.torque_gain)
        self._bands = (*(drive.band,) * 3, tilt[1], tilt[1], drive.band)
        for row, value, gain in zip(self._rows, self._velocity, gains, strict=False):
            used = 0.0 if value is None else gain
            self._gain[row, 0], self._bias[row, 2] = used, -used

    def hold(self) -> None:
        """Updates the actuators; called before each step, because they act in world axes."""
        if not self._holds:
            return
        w, x, y, z = self._turned.tolist()
        vx, vy, vz, ax, ay, az = self._motion.tolist()
        sx, sy, sz = self._angular_target
        tx, ty, tz = self._linear_target
        # This runs at every step, so calls of `rotate` and cross products are written out.
        if self._level:
            half = math.atan2(2 * (w * z + x * y), 1 - 2 * (y * y + z * z)) / 2
            sin, cos = math.sin(half), math.cos(half)
            mx, my = -2 * (sin * ty), 2 * (sin * tx)
            tx, ty = tx + cos * mx - sin * my, ty + cos * my + sin * mx
            if sx or sy:
                mx, my = -2 * (sin * sy), 2 * (sin * sx)
                sx, sy = sx + cos * mx - sin * my, sy + cos * my + sin * mx
        else:
            turn = (x, y, z, w)
            sx, sy, sz = rotate(turn, self._angular_target)
            tx, ty, tz = rotate(turn, self._linear_target)
        mx, my, mz = 2 * (y * az - z * ay), 2 * (z * ax - x * az), 2 * (x * ay - y * ax)
        wx = ax + w * mx + y * mz - z * my
        wy = ay + w * my + z * mx - x * mz
        wz = az + w * mz + x * my - y * mx
        # The servo acts at the centre of mass, which rotates about the link's origin.
        cx, cy, cz = self.drive.centre
        mx, my, mz = 2 * (y * cz - z * cy), 2 * (z * cx - x * cz), 2 * (x * cy - y * cx)
        x, y, z = (
            cx + w * mx + y * mz - z * my,
            cy + w * my + z * mx - x * mz,
            cz + w * mz + x * my - y * mx,
        )
        now = (vx + (wy * z - wz * y), vy + (wz * x - wx * z), vz + (wx * y - wy * x), wx, wy, wz)
        targets = (
            tx + (sy * z - sz * y),
            ty + (sz * x - sx * z),
            tz + (sx * y - sy * x),
            sx,
            sy,
            sz,
        )
        ctrl, bands = self._ctrl, self._bands
        for row in range(6):
            # With a limit on the force itself, the servo would overshoot within a step.
            change, band = targets[row] - now[row], bands[row]
            if change > band:
                change = band
            elif change < -band:
                change = -band
            ctrl[row] = now[row] + change


class WrenchHandle:
    """An external force and torque on a link, which act until they are changed."""

    def __init__(self, model: str, link: str) -> None:
        self.model_name = model
        self.name = link
        self._given = np.zeros(6)

    def bind(self, model: Any, data: Any) -> None:
        """Resolves the name in a compiled model."""
        body = mujoco.mj_name2id(model, _OBJ.mjOBJ_BODY, scoped(self.model_name, self.name))
        self._total = data.xfrc_applied[body]
        # Other handles may push the same link.
        self._total += self._given

    def apply(self, force: Sequence[float], torque: Sequence[float]) -> None:
        """Sets the force in N at the centre of mass and the torque in N m, both in world axes."""
        self._total -= self._given
        self._given = np.array([*force, *torque], dtype=float)
        self._total += self._given

    def forget(self) -> None:
        """Clears the wrench when a reset has removed all forces."""
        self._given = np.zeros(6)
