"""Separates overlapping models at walking pace."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

import mujoco
import numpy as np

from cartwheel.codes import world as world_codes
from cartwheel.errors import Diagnostic, Origin
from cartwheel.geometry import Pose

DEEP = 0.005
"""m; contacts between models that collide in motion are never this deep."""
_SPEED = 0.5
"""m/s; maximum speed of a model's root and prismatic joints while it overlaps another model."""
_TURN = 2.0
"""rad/s; maximum for its root and revolute joints."""
_PATH_NS = 250_000_000
"""ns; a model that is placed again within this time moves along a path."""
_FASTEST = 10.0
"""m/s; a model that would be faster on its path jumps."""
Speeds = tuple[float, float]
"""m/s and rad/s."""
STILL: Speeds = (0.0, 0.0)


class Separation:
    """Limits the speed of models that were placed inside another model.

    The contact forces act within hundredths of a second. At a depth of decimetres, they would throw
    both models across the room.

    Args:
        slow: Whether to limit the speeds.
    """

    def __init__(self, *, slow: bool = True) -> None:
        self._slow = slow
        self.roots: set[int] = set()
        """Root bodies of the models that are being separated."""
        self._most: Speeds = (_SPEED, _TURN)
        """Their maximum speeds, which are higher if an obstacle pushes them along its path."""
        self._placed_ns: dict[str, int] = {}
        """When models that are fixed to the world were last placed."""

    def forget(self) -> None:
        """Stops all separations, after a time reset."""
        self.roots.clear()
        self._placed_ns.clear()

    def along_path(self, name: str, time_ns: int, before: Pose, after: Pose) -> Speeds:
        """Speeds of a model that a program places again and again; zero at its first place.

        Args:
            name: A model that is fixed to the world.
            time_ns: Current time.
            before: Its last pose.
            after: Its new pose.
        """
        elapsed_ns = time_ns - self._placed_ns.get(name, time_ns)
        self._placed_ns[name] = time_ns
        if not 0 < elapsed_ns <= _PATH_NS:
            return STILL
        way = before.inverse() @ after
        angle = 2 * math.atan2(math.hypot(*way.orientation[:3]), abs(way.orientation[3]))
        speed, turn = math.hypot(*way.position) / elapsed_ns * 1e9, angle / elapsed_ns * 1e9
        return (speed, turn) if speed <= _FASTEST else STILL

    def resume(self, model: Any, data: Any) -> None:
        """Continues after the model was recompiled, with any remaining overlaps."""
        if self.roots:
            self.roots = {root for one, two, _ in _deep(model, data) for root in (one, two)}

    def begin(
        self, model: Any, data: Any, placed: set[int], speeds: Speeds = STILL
    ) -> list[tuple[str, float]]:
        """Finds overlaps of a model that was just placed.

        Args:
            model: The compiled model.
            data: Data after a forward pass.
            placed: Ids of the placed model's root bodies.
            speeds: Those at which it moves along a path, where it pushes what it meets.

        Returns:
            The bodies that it overlaps, each once, with the depth in m. What is pushed is left out.
        """
        found: dict[str, float] = {}
        if not self.roots:
            self._most = (_SPEED, _TURN)
        if speeds != STILL:
            # What is pushed must become faster than the obstacle to leave it.
            speed = speeds[0] + speeds[1] * _reach(model, data, placed)
            self._most = max(self._most[0], _SPEED + speed), max(self._most[1], _TURN + speeds[1])
        for one, two, depth in _deep(model, data):
            if (one in placed) == (two in placed):
                continue
            other = two if one in placed else one
            name = mujoco.mj_id2name(model, mujoco.mjtObj.mjOBJ_BODY, other) or "world"
            if speeds == STILL:
                found[name] = max(found.get(name, 0.0), depth)
            if self._slow:
                self.roots |= {one, two}
        return sorted(found.items())

    def limit(self, model: Any, data: Any) -> None:
        """Limits the speeds after a step; a separation ends when nothing overlaps any more."""
        roots = {root for one, two, _ in _deep(model, data) for root in (one, two)}
        self.roots &= roots
        for root in sorted(self.roots):
            joint = int(model.body_jntadr[root])
            if joint < 0 or model.jnt_type[joint] != mujoco.mjtJoint.mjJNT_FREE:
                continue
            start = int(model.jnt_dofadr[joint])
            for part, most in (
                (slice(start, start + 3), self._most[0]),
                (slice(start + 3, start + 6), self._most[1]),
            ):
                speed = float(np.linalg.norm(data.qvel[part]))
                if speed > most:
                    data.qvel[part] *= most / speed
            # Limbs that are pushed out pull the rest along.
            limbs = slice(start + 6, start + int(model.tree_dofnum[model.body_treeid[root]]))
            most_of_each = np.where(_turns(model, limbs), self._most[1], self._most[0])
            data.qvel[limbs] = np.clip(data.qvel[limbs], -most_of_each, most_of_each)


def overlap(
    name: str, z: float, overlaps: Sequence[tuple[str, float]], *, origin: Origin | None
) -> Diagnostic:
    """The diagnostic for a model that was placed inside others.

    Args:
        name: Model name.
        z: Height of its frame, m.
        overlaps: The bodies that it overlaps, with the depth in m.
        origin: Origin of the model.
    """
    others = ", ".join(f"{other} by {depth * 100:.0f} cm" for other, depth in overlaps)
    floor = max((d for other, d in overlaps if other.startswith("ground")), default=0.0)
    height = math.ceil((z + floor) * 100) / 100
    return world_codes.MODELS_OVERLAP.diagnostic(
        f'model "{name}" overlaps {others}, so the models are pushed apart',
        origin=origin,
        hint=f"Set z to {height:g} to place the model on the ground." if floor else "",
        values={
            "model": name,
            "others": tuple(other for other, _ in overlaps),
            "z": height if floor else None,
        },
    )


def _reach(model: Any, data: Any, roots: set[int]) -> float:
    """How far shapes are from the frames of their root bodies, m."""
    geoms = np.flatnonzero(np.isin(model.body_rootid[model.geom_bodyid], list(roots)))
    frames = data.xpos[model.body_rootid[model.geom_bodyid[geoms]]]
    reach = np.linalg.norm(data.geom_xpos[geoms] - frames, axis=1) + model.geom_rbound[geoms]
    return float(reach.max(initial=0.0))


def _turns(model: Any, dofs: slice) -> Any:
    """Mask of rotational degrees of freedom; all others are translational."""
    return model.jnt_type[model.dof_jntid[dofs]] != mujoco.mjtJoint.mjJNT_SLIDE


def _deep(model: Any, data: Any) -> list[tuple[int, int, float]]:
    """Pairs of root bodies that overlap deeply, with the depth in m."""
    if data.ncon == 0:
        return []
    distances = data.contact.dist
    found = []
    for index in np.flatnonzero(distances < -DEEP):
        one, two = (int(model.body_rootid[model.geom_bodyid[g]]) for g in data.contact.geom[index])
        found.append((one, two, -float(distances[index])))
    return found
