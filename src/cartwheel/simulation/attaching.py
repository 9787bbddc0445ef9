"""Fixed joints that are made and undone while time goes on, between links of any models.

Each is a weld that was compiled in without anything to hold; whom it holds is told to it while it
runs. It lasts over spawning and deleting, until one of the two links is gone.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import mujoco
import numpy as np

from cartwheel.geometry import Array, Pose, Vec3, from_wxyz, to_wxyz
from cartwheel.world.entry import SHIFT, scoped

_OBJ = mujoco.mjtObj
_POSE = slice(3, 10)
"""Of a weld's numbers: where the second body is in the first."""
_EQUALITY = mujoco.mjtConstraint.mjCNSTR_EQUALITY.value
_NEVER = -1e9
"""m, a margin at which nothing touches."""


@dataclass(frozen=True, slots=True)
class Held:
    """Two links and how they are held."""

    holder: str
    """Scoped name; "world" is the world itself."""
    link: str
    pose: Pose
    """Of the link in its holder."""
    collides: bool
    """Whether the link goes on touching others."""


class AttachmentHandle:
    """Holds a link in another one, or in the world, as a fixed joint would.

    Args:
        name: Of the weld.
    """

    def __init__(self, name: str) -> None:
        self.name = name
        self.held: Held | None = None
        """None while it holds nothing."""
        self._kept: list[tuple[Any, int, float]] = []

    def bind(self, model: Any, data: Any) -> None:
        """Resolves the names in a compiled model; lets go where one of the two is gone."""
        self._model, self._data = model, data
        self._kept = []
        self.id = mujoco.mj_name2id(model, _OBJ.mjOBJ_EQUALITY, self.name)
        held = self.held
        if held is None:
            return
        if self._body(held.holder) < 0 or self._body(held.link) < 0:
            self.held = None
            return
        self._take(held)

    def hold(
        self, holder: tuple[str, str] | None, link: tuple[str, str], *, collides: bool = True
    ) -> None:
        """Holds a link where it is now; what was held before is let go.

        Args:
            holder: Model and link that it is held in; None is the world.
            link: Model and link; must stand in the world, as the holder must.
            collides: Whether the link goes on touching others.
        """
        self.release()
        one, two = "world" if holder is None else scoped(*holder), scoped(*link)
        # What was last computed may be of the state before.
        mujoco.mj_kinematics(self._model, self._data)
        pose = self._pose(self._body(one)).inverse() @ self._pose(self._body(two))
        self.held = Held(one, two, pose, collides)
        self._take(self.held)

    def shift(self, step: Vec3) -> None:
        """Moves the place that the link is held at, m in the holder's axes."""
        held = self.held
        if held is not None:
            x, y, z = np.add(held.pose.position, step).tolist()
            moved = Pose((x, y, z), held.pose.orientation)
            self.held = Held(held.holder, held.link, moved, held.collides)
            self._model.eq_data[self.id, _POSE][:3] = moved.position

    def link_pose(self) -> Pose:
        """Of the link that is held, in the world."""
        assert self.held is not None
        return self._pose(self._body(self.held.link))

    def force(self) -> Array:
        """What it exerts on the link, N in the world's axes, shape (3,); 0 while it holds none."""
        data = self._data
        rows = np.flatnonzero((data.efc_type == _EQUALITY) & (data.efc_id == self.id))
        if self.held is None or len(rows) < 3:
            return np.zeros(3)
        # The first three rows are the places', along the world's axes.
        exerted: Array = -data.efc_force[rows[:3]]
        return exerted

    def release(self) -> None:
        """Lets go."""
        self.held = None
        if self.id >= 0:
            self._data.eq_active[self.id] = 0
        for array, index, value in reversed(self._kept):
            array[index] = value
        self._kept = []

    def _take(self, held: Held) -> None:
        model = self._model
        model.eq_obj1id[self.id] = self._body(held.holder)
        model.eq_obj2id[self.id] = body = self._body(held.link)
        model.eq_data[self.id, _POSE] = [*held.pose.position, *to_wxyz(held.pose.orientation)]
        self._data.eq_active[self.id] = 1
        for tree in {int(model.body_treeid[each]) for each in (body, self._body(held.holder))}:
            if tree >= 0:
                # Asleep it would be no load to its holder, and would stay where it is let go.
                self._set(model.tree_sleep_policy, tree, mujoco.mjtSleepPolicy.mjSLEEP_NEVER.value)
                self._data.tree_awake[tree] = 1
        if not held.collides:
            self._pass_through(body)

    def _pass_through(self, body: int) -> None:
        """Ends the body's touching: in general, and in the pairs that are stated by themselves."""
        model = self._model
        geoms = set(np.flatnonzero(model.geom_bodyid == body).tolist())
        for geom in geoms:
            self._set(model.geom_contype, geom, 0)
            self._set(model.geom_conaffinity, geom, 0)
        for pair in range(model.npair):
            if {int(model.pair_geom1[pair]), int(model.pair_geom2[pair])} & geoms:
                self._set(model.pair_margin, pair, _NEVER)

    def _set(self, array: Any, index: int, value: float) -> None:
        self._kept.append((array, index, array[index]))
        array[index] = value

    def _body(self, name: str) -> int:
        return int(mujoco.mj_name2id(self._model, _OBJ.mjOBJ_BODY, name))

    def _pose(self, body: int) -> Pose:
        x, y, z = self._data.xpos[body].tolist()
        return Pose((x, y, z), from_wxyz(self._data.xquat[body].tolist()))


class SurroundingsHandle:
    """All links in the world, whichever model they are of."""

    links: tuple[tuple[str, str], ...] = ()
    """Model and link of each."""
    moving: frozenset[tuple[str, str]] = frozenset()
    """Those that can move at all."""

    def bind(self, model: Any, data: Any) -> None:
        """Sees what stands in a compiled model."""
        found = {}
        for body in range(1, model.nbody):
            name = mujoco.mj_id2name(model, _OBJ.mjOBJ_BODY, body)
            if mujoco.mj_name2id(model, _OBJ.mjOBJ_TENDON, name) >= 0:
                # The rotor of a motor.
                continue
            if mujoco.mj_name2id(model, _OBJ.mjOBJ_JOINT, scoped(name, SHIFT)) >= 0:
                # The tyre of a wheel that slips.
                continue
            owner, _, link = name.partition("::")
            found[owner, link] = body
        self.links = tuple(found)
        self.moving = frozenset(key for key, body in found.items() if model.body_treeid[body] >= 0)
        self._found = found
        self._bodies = list(found.values())
        self._data = data

    def pose(self, model: str, link: str) -> Pose | None:
        """Of a link in the world; None where there is none of that name."""
        body = self._found.get((model, link))
        if body is None:
            return None
        x, y, z = self._data.xpos[body].tolist()
        return Pose((x, y, z), from_wxyz(self._data.xquat[body].tolist()))

    def distances(self, point: Vec3) -> Array:
        """From a point in the world to the frames of all `links`, m, shape (links,)."""
        places: Array = self._data.xpos[self._bodies].reshape(-1, 3)
        away: Array = np.linalg.norm(places - np.asarray(point), axis=1)
        return away
