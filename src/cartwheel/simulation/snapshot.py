"""What other threads may see of a simulation: immutable copies."""

from __future__ import annotations

import enum
from dataclasses import dataclass

from cartwheel.description.model import RobotDescription, WorldDescription
from cartwheel.geometry import Array, Pose


class RunState(enum.Enum):
    """Whether simulated time goes on."""

    RUNNING = "running"
    PAUSED = "paused"
    STOPPED = "stopped"


@dataclass(frozen=True, kw_only=True, slots=True)
class PlacedModel:
    """A model as it was spawned."""

    name: str
    description: RobotDescription
    pose: Pose


@dataclass(frozen=True, kw_only=True, slots=True)
class Scene:
    """What stands in the world, from one spawn or delete to the next."""

    version: int
    world: WorldDescription
    models: tuple[PlacedModel, ...]
    links: tuple[tuple[str, str], ...]
    """Model and link of each row of a snapshot's poses."""
    joints: tuple[tuple[str, str], ...]
    """Model and joint of each of a snapshot's joint positions; those of one degree of freedom."""


@dataclass(frozen=True, kw_only=True, slots=True)
class Snapshot:
    """The state at one time."""

    scene: Scene
    time_ns: int
    run_state: RunState
    speed: float | None
    """The wanted real-time factor; None is as fast as it can."""
    real_time_factor: float
    """Measured over the last second or so; 0 while paused."""
    positions: Array
    """Shape (links, 3), m, in the world."""
    quaternions: Array
    """Shape (links, 4), MuJoCo's and viser's order (w, x, y, z), in the world."""
    joint_positions: Array
    """Shape (joints,), rad or m."""


@dataclass(frozen=True, kw_only=True, slots=True)
class Contact:
    """A touching pair at one point."""

    first: str
    """``model::link::collision``."""
    second: str
    position: Array
    """Shape (3,), m, in the world."""
    normal: Array
    """Shape (3,), unit, in the world, from the second into the first."""
    depth: float
    """m, positive when they overlap."""
    force: Array
    """Shape (3,), N, in the world, that the second exerts on the first."""
    torque: Array
    """Shape (3,), N m, in the world, on the first about the centre of mass of its link."""
