"""What the web interface and the control server use of a session: a simulation or a recording."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from concurrent.futures import Future
from typing import TYPE_CHECKING, Protocol, TypeVar

if TYPE_CHECKING:
    from cartwheel.description.model import RobotDescription, WorldDescription
    from cartwheel.errors import Diagnostic
    from cartwheel.geometry import Pose, Vec3
    from cartwheel.graph import Graph
    from cartwheel.simulation.models.occupied_space import Space
    from cartwheel.simulation.snapshot import RunState, Scene, Snapshot

T = TypeVar("T")


class SnapshotSource(Protocol):
    """Passes the state to listeners. See `Pacer`."""

    def add_listener(self, listener: Callable[[Snapshot], None], *, rate: float = 30.0) -> None:
        """Calls `listener` with snapshots at `rate` Hz of wall time, on the owner's thread."""


class RunningSimulation(Protocol):
    """See `Simulation`. Only the owner's thread may call these methods, except `post`, `call` and
    `report`.
    """

    @property
    def run_state(self) -> RunState:
        """Whether time advances."""

    @property
    def speed(self) -> float | None:
        """Target real-time factor; None is as fast as possible."""

    @property
    def real_time_factor(self) -> float:
        """Measured real-time factor."""

    @property
    def time_ns(self) -> int:
        """Simulation time."""

    @property
    def step_ns(self) -> int:
        """Length of a step."""

    @property
    def steps_allowed(self) -> int | None:
        """Steps until the run pauses again; None if it is not single-stepping."""

    @property
    def world(self) -> WorldDescription:
        """The world."""

    @property
    def scene(self) -> Scene:
        """The models, links and joints."""

    @property
    def models(self) -> tuple[str, ...]:
        """Names of the models."""

    @property
    def diagnostics(self) -> list[Diagnostic]:
        """Diagnostics reported so far."""

    def post(self, function: Callable[[], None]) -> None:
        """Queues a function for the owner's thread."""

    def call(self, function: Callable[[], T]) -> Future[T]:
        """Like `post`, but returns a future for the result or error."""

    def read(self, function: Callable[[], T]) -> Future[T]:
        """Like `call`, for a function that does not change the simulation. It does not wait for the
        next run.
        """

    def report(self, diagnostic: Diagnostic) -> None:
        """Reports a diagnostic on the owner's thread."""

    def pause(self) -> None:
        """Pauses time."""

    def resume(self) -> None:
        """Resumes time."""

    def stop(self) -> None:
        """Ends the run. Thread-safe."""

    def step(self, count: int = 1) -> None:
        """Makes single steps, and pauses."""

    def reset(self) -> None:
        """Returns to the start."""

    def set_speed(self, speed: float | None) -> None:
        """Sets the target real-time factor."""

    def pose(self, name: str) -> Pose:
        """Pose of a model."""

    def set_pose(self, name: str, pose: Pose) -> None:
        """Moves a model."""

    def delete(self, name: str) -> None:
        """Deletes a model."""

    def occupied(self) -> Space:
        """The space that models occupy."""

    def in_sight(self, name: str, eyes: Sequence[Vec3], target: Vec3) -> list[bool]:
        """Whether a model is visible from each point."""


class RunningPlayback(RunningSimulation, Protocol):
    """See `Player`."""

    @property
    def start_ns(self) -> int:
        """Time of the recording's first message."""

    @property
    def end_ns(self) -> int:
        """Time of its last message."""

    def seek(self, time_ns: int) -> None:
        """Jumps to a time."""


class RunningSession(Protocol):
    """See `Session`."""

    @property
    def graph(self) -> Graph:
        """Topics and services."""

    @property
    def simulation(self) -> RunningSimulation:
        """Time and models."""

    @property
    def diagnostics(self) -> tuple[Diagnostic, ...]:
        """Diagnostics reported so far."""

    def spawn(
        self, description: RobotDescription, *, name: str | None = None, pose: Pose | None = None
    ) -> str:
        """Spawns a model on the owner's thread, and returns its name."""


__all__ = ["RunningPlayback", "RunningSession", "RunningSimulation", "SnapshotSource"]
