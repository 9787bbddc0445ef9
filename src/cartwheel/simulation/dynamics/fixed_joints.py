"""Fixed joints that can be added and removed at run time, between links of any models.

Each joint is a weld that is compiled in without bodies; its bodies are set at run time. It persists
when models are spawned or deleted, until one of its two links is removed.
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
"""Elements in a weld's data: pose of the second body in the first."""
_EQUALITY = mujoco.mjtConstraint.mjCNSTR_EQUALITY.value
_NEVER = -1e9
"""Contact margin at which nothing collides, m."""


@dataclass(frozen=True, slots=True)
class Held:
    """Two attached links and their relative pose."""

    holder: str
    """Scoped link name; "world" for the world itself."""
    link: str
    pose: Pose
    """Pose of the link in its holder."""
    collides: bool
    """Whether the link still collides."""


class AttachmentHandle:
    """Attaches a link to another link or to the world, as a fixed joint does.

    Args:
        name: Name of the weld.
    """

    def __init__(self, name: str) -> None:
        self.name = name
        self.held: Held | None = None
        """None while nothing is attached."""
        self._kept: list[tuple[str, int, float]] = []
        """Values of the compiled model before the attachment: array, index and value."""

    def bind(self, model: Any, data: Any) -> None:
        """Resolves the names in a compiled model; detaches if a link was removed."""
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
        """Attaches a link at its current pose; detaches the previous link.

        Args:
            holder: Model and link to attach to; None for the world.
            link: Model and link to attach. Both links must exist.
            collides: Whether the link still collides.
        """
        self.release()
        one, two = "world" if holder is None else scoped(*holder), scoped(*link)
        # The computed poses may belong to an earlier state.
        mujoco.mj_kinematics(self._model, self._data)
        pose = self._pose(self._body(one)).inverse() @ self._pose(self._body(two))
        self.held = Held(one, two, pose, collides)
        self._take(self.held)

    def shift(self, step: Vec3) -> None:
        """Moves the attached link's target position, m in the holder's axes."""
        held = self.held
        if held is not None:
            x, y, z = np.add(held.pose.position, step).tolist()
            moved = Pose((x, y, z), held.pose.orientation)
            self.held = Held(held.holder, held.link, moved, held.collides)
            self._model.eq_data[self.id, _POSE][:3] = moved.position

    def link_pose(self) -> Pose:
        """World pose of the attached link."""
        assert self.held is not None
        return self._pose(self._body(self.held.link))

    def force(self) -> Array:
        """Force on the attached link, N in world axes, shape (3,); 0 while nothing is attached."""
        data = self._data
        rows = np.flatnonzero((data.efc_type == _EQUALITY) & (data.efc_id == self.id))
        if self.held is None or len(rows) < 3:
            return np.zeros(3)
        # The first three rows are the translational constraints, along the world's axes.
        exerted: Array = -data.efc_force[rows[:3]]
        return exerted

    def release(self) -> None:
        """Detaches the link."""
        self.held = None
        if self.id >= 0:
            self._data.eq_active[self.id] = 0
        for name, index, value in reversed(self._kept):
            getattr(self._model, name)[index] = value
        self._kept = []

    def _take(self, held: Held) -> None:
        model = self._model
        model.eq_obj1id[self.id] = self._body(held.holder)
        model.eq_obj2id[self.id] = body = self._body(held.link)
        model.eq_data[self.id, _POSE] = [*held.pose.position, *to_wxyz(held.pose.orientation)]
        self._data.eq_active[self.id] = 1
        for tree in {int(model.body_treeid[each]) for each in (body, self._body(held.holder))}:
            if tree >= 0:
                # While asleep, the link would not load its holder and would float after it is
                # released.
                self._set("tree_sleep_policy", tree, mujoco.mjtSleepPolicy.mjSLEEP_NEVER.value)
                self._data.tree_awake[tree] = 1
        if not held.collides:
            self._pass_through(body)

    def _pass_through(self, body: int) -> None:
        """Disables the body's collisions, in general and in explicit contact pairs."""
        model = self._model
        geoms = set(np.flatnonzero(model.geom_bodyid == body).tolist())
        for geom in geoms:
            self._set("geom_contype", geom, 0)
            self._set("geom_conaffinity", geom, 0)
        for pair in range(model.npair):
            if {int(model.pair_geom1[pair]), int(model.pair_geom2[pair])} & geoms:
                self._set("pair_margin", pair, _NEVER)

    def _set(self, name: str, index: int, value: float) -> None:
        array = getattr(self._model, name)
        self._kept.append((name, index, array[index]))
        array[index] = value

    def _body(self, name: str) -> int:
        return int(mujoco.mj_name2id(self._model, _OBJ.mjOBJ_BODY, name))

    def _pose(self, body: int) -> Pose:
        x, y, z = self._data.xpos[body].tolist()
        return Pose((x, y, z), from_wxyz(self._data.xquat[body].tolist()))


class SurroundingsHandle:
    """All links in the world, in any model."""

    links: tuple[tuple[str, str], ...] = ()
    """Model and link names."""
    moving: frozenset[tuple[str, str]] = frozenset()
    """The links that can move."""

    def bind(self, model: Any, data: Any) -> None:
        """Finds the links in a compiled model."""
        found = {}
        for body in range(1, model.nbody):
            name = mujoco.mj_id2name(model, _OBJ.mjOBJ_BODY, body)
            if mujoco.mj_name2id(model, _OBJ.mjOBJ_TENDON, name) >= 0:
                # the rotor of a motor
                continue
            if mujoco.mj_name2id(model, _OBJ.mjOBJ_JOINT, scoped(name, SHIFT)) >= 0:
                # the tyre of a wheel with slip
                continue
            owner, _, link = name.partition("::")
            found[owner, link] = body
        self.links = tuple(found)
        self.moving = frozenset(key for key, body in found.items() if model.body_treeid[body] >= 0)
        self._found = found
        self._bodies = list(found.values())
        self._data = data

    def pose(self, model: str, link: str) -> Pose | None:
        """World pose of a link; None if the link does not exist."""
        body = self._found.get((model, link))
        if body is None:
            return None
        x, y, z = self._data.xpos[body].tolist()
        return Pose((x, y, z), from_wxyz(self._data.xquat[body].tolist()))

    def distances(self, point: Vec3) -> Array:
        """Distances from a point in the world to the frames of all `links`, m, shape (links,)."""
        places: Array = self._data.xpos[self._bodies].reshape(-1, 3)
        away: Array = np.linalg.norm(places - np.asarray(point), axis=1)
        return away
