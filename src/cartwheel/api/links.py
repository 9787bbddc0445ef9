"""The links of a model."""

from __future__ import annotations

from typing import TYPE_CHECKING

from cartwheel.api.motion import Acceleration, Twist
from cartwheel.api.values import Vector, vector
from cartwheel.geometry import Pose
from cartwheel.simulation.limits import duration_ns

if TYPE_CHECKING:
    from cartwheel.api.contacts import Contact
    from cartwheel.api.world import World

_NONE: Vector = (0.0, 0.0, 0.0)


class Link:
    """A handle to a link of a model in a world. `Model.link` returns it.

    Reading a value does not advance the simulation and changes nothing.
    """

    def __init__(self, world: World, model: str, name: str) -> None:
        self._world = world
        self.model = model
        """Name of the model."""
        self.name = name
        """Name in the model."""

    def __repr__(self) -> str:
        return f"Link({self.scoped_name!r})"

    @property
    def scoped_name(self) -> str:
        """Gazebo's name: ``model::link``."""
        return f"{self.model}::{self.name}"

    # -- motion

    @property
    def pose(self) -> Pose:
        """Pose of the link's frame in the world.

        Raises:
            UnknownNameError: The model or the link does not exist any more.
        """
        with self._world.lock:
            truth = self._world.session.simulation.truth
            handle = truth.link(self.model, self.name)
            truth.locate()
            return handle.pose

    @property
    def velocity(self) -> Twist:
        """Velocity of the link's frame, in world axes.

        Raises:
            UnknownNameError: The model or the link does not exist any more.
        """
        with self._world.lock:
            truth = self._world.session.simulation.truth
            handle = truth.link(self.model, self.name)
            truth.locate()
            return Twist(*handle.motion(local=False))

    @property
    def acceleration(self) -> Acceleration:
        """Acceleration of the link's frame in the current state, in world axes.

        It is the change of the velocity, and not what an accelerometer measures: a resting link
        has an acceleration of 0.

        Raises:
            UnknownNameError: The model or the link does not exist any more.
        """
        with self._world.lock:
            truth = self._world.session.simulation.truth
            return Acceleration(*truth.acceleration(self.model, self.name))

    def push(
        self,
        force: Vector = _NONE,
        torque: Vector = _NONE,
        *,
        at: Vector | None = None,
        seconds: float = 0.0,
    ) -> None:
        """Applies a force and a torque from now on, for an interval of simulation time.

        The impulse is exactly the force times `seconds`, even if `seconds` is not a multiple of the
        time step. `World.reset` ends all pushes.

        Args:
            force: N, shape (3,), in world axes. It does not rotate with the link.
            torque: N m, shape (3,), in world axes.
            at: The point at which the force acts, m, in the world. Its distance from the centre of
                mass remains the same during the push. None is the centre of mass.
            seconds: Duration, s; 0 is one time step, and `math.inf` has no end.

        Raises:
            CartwheelError: A number is not finite or out of range.
            UnknownNameError: The model or the link does not exist any more.
            SimulationError: The link is fixed to the world, or the world is closed.
        """
        wrench = vector(force, "force"), vector(torque, "torque")
        point = None if at is None else vector(at, "at")
        duration = None if seconds == float("inf") else duration_ns(seconds)
        with self._world.used(change=True) as simulation:
            simulation.truth.push(
                self.model,
                self.name,
                force=wrench[0],
                torque=wrench[1],
                at=point,
                duration_ns=duration,
            )

    def contacts(self) -> tuple[Contact, ...]:
        """All contacts of the link, with the link as the first one; see `World.contacts`."""
        return self._world.contacts(self)
