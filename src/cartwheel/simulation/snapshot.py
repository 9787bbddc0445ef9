"""Immutable copies of the state of a simulation, for other threads."""

from __future__ import annotations

import enum
from dataclasses import dataclass

from cartwheel.description.model import RobotDescription, WorldDescription
from cartwheel.geometry import Array, Pose


class RunState(enum.Enum):
    """Whether simulation time advances."""

    RUNNING = "running"
    WAITING = "waiting"
    """Between two calls of `World.run`."""
    PAUSED = "paused"
    STOPPED = "stopped"


@dataclass(frozen=True, kw_only=True, slots=True)
class PlacedModel:
    """A model as spawned."""

    name: str
    description: RobotDescription
    pose: Pose


@dataclass(frozen=True, kw_only=True, slots=True)
class Scene:
    """The models, links and joints in the world between two spawns or deletes."""

    version: int
    world: WorldDescription
    models: tuple[PlacedModel, ...]
    links: tuple[tuple[str, str], ...]
    """Model and link for each row of a snapshot's poses."""
    joints: tuple[tuple[str, str], ...]
    """Model and joint for each joint position of a snapshot; only joints with one degree of
    freedom.
    """


@dataclass(frozen=True, kw_only=True, slots=True)
class Snapshot:
    """The state at one time."""

    scene: Scene
    time_ns: int
    run_state: RunState
    speed: float | None
    """The target real-time factor; None is as fast as possible."""
    real_time_factor: float
    """Measured over the last second or so; 0 while paused."""
    positions: Array
    """Shape (links, 3), m, in the world."""
    quaternions: Array
    """Shape (links, 4), in the (w, x, y, z) order of MuJoCo and viser, in the world."""
    joint_positions: Array
    """Shape (joints,), rad or m."""


@dataclass(frozen=True, kw_only=True, slots=True)
class Contact:
    """A contact between two collisions at one point."""

    first: str
    """``model::link::collision``."""
    second: str
    position: Array
    """Shape (3,), m, in the world."""
    normal: Array
    """Unit vector in the world, shape (3,), from the second collision into the first."""
    depth: float
    """Penetration depth, m; positive if they overlap."""
    force: Array
    """Force on the first collision, N, in world axes, shape (3,)."""
    torque: Array
    """Torque on the first link about its centre of mass, N m, in world axes, shape (3,)."""
