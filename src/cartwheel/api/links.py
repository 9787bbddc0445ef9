"""The links of a model."""

from __future__ import annotations

from typing import TYPE_CHECKING

from cartwheel.api.motion import Acceleration, Twist
from cartwheel.api.properties.of_links import LinkProperties
from cartwheel.api.values import Vector, instance, invalid, vector
from cartwheel.geometry import Pose
from cartwheel.simulation.limits import duration_ns

if TYPE_CHECKING:
    from cartwheel.api.model import Model
    from cartwheel.api.surroundings.contacts import Contact
    from cartwheel.api.world import World
    from cartwheel.simulation import Simulation

_NONE: Vector = (0.0, 0.0, 0.0)


class Link(LinkProperties):
    """A handle to a link of a model in a world. `Model.link` returns it.

    Reading a value does not advance the simulation and changes nothing. Two handles are equal if
    they belong to the same world and have the same names.
    """

    __slots__ = ("_world", "model", "name")

    def __init__(self, world: World, model: str, name: str) -> None:
        self._world = world
        self.model = model
        """Name of the model."""
        self.name = name
        """Name in the model."""

    def __repr__(self) -> str:
        return f"Link({self.scoped_name!r})"

    @property
    def _identity(self) -> tuple[World, str, str]:
        return self._world, self.model, self.name

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
            truth.locate(velocities=False)
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

    # -- forces

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
        time step. `end_pushes` and `World.reset` end it earlier.

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
        with self._world._used(change=True) as simulation:
            simulation.truth.push(
                self.model,
                self.name,
                force=wrench[0],
                torque=wrench[1],
                at=point,
                duration_ns=duration,
            )

    def end_pushes(self) -> None:
        """Ends all pushes on the link, also those of Gazebo's services.

        Raises:
            UnknownNameError: The model or the link does not exist any more.
            SimulationError: The world is closed.
        """
        with self._world._used(change=True) as simulation:
            simulation.truth.end_pushes(self.model, self.name)

    # -- attached links

    def attach(self, other: Link) -> None:
        """Fixes another link to this one in their current relative pose, as a fixed joint does.

        If one of the links cannot move, it holds the other one. Attached links still collide. Two
        links that are attached already keep their pose of now. The attachment ends with `detach`,
        `World.reset`, or when one of the models is deleted. A link can be attached to any number of
        others.

        The first attachments compile the models again, which takes some milliseconds.

        Args:
            other: A link of the same world, of any model.

        Raises:
            CartwheelError: `other` is this link, or not a link of this world, or neither link can
                move.
            UnknownNameError: A model or a link does not exist any more.
            SimulationError: The world is closed.
        """
        with self._world._used(change=True) as simulation:
            one, two = self._place(simulation), self._other(other)._place(simulation)
            attachments = simulation.attachments
            if one == two or not (attachments.movable(one) or attachments.movable(two)):
                rule = "must be another link, and one of the two must be movable"
                raise invalid("other", rule, other)
            attachments.attach(one, two)

    def detach(self, other: Link | None = None) -> None:
        """Releases links that `attach` has fixed. Does nothing if they are not attached.

        Args:
            other: The other link; None for all links that are attached to this one.

        Raises:
            CartwheelError: `other` is not a link of this world.
            UnknownNameError: A model or a link does not exist any more.
            SimulationError: The world is closed.
        """
        with self._world._used(change=True) as simulation:
            one = self._place(simulation)
            if other is not None:
                simulation.attachments.detach(one, self._other(other)._place(simulation))
                return
            for name in tuple(simulation.attachments.attached(one)):
                model, _, link = name.partition("::")
                simulation.attachments.detach(one, (model, link))

    @property
    def attached(self) -> tuple[Link, ...]:
        """The links that `attach` has fixed to this one.

        Raises:
            UnknownNameError: The model or the link does not exist any more.
        """
        with self._world.lock:
            simulation = self._world.session.simulation
            names = simulation.attachments.attached(self._place(simulation))
            places = (name.partition("::") for name in names)
            return tuple(Link(self._world, model, link) for model, _, link in places)

    def _other(self, other: Link) -> Link:
        other = instance(other, Link, "other", 'model.link("base_link")')
        if other._world is not self._world:
            raise invalid("other", "must be a link of the same world", other)
        return other

    def _place(self, simulation: Simulation) -> tuple[str, str]:
        simulation.truth.link(self.model, self.name)
        return self.model, self.name

    def contacts(self, other: str | Model | Link | None = None) -> tuple[Contact, ...]:
        """The contacts of the link, with the link as the first one; see `World.contacts`.

        Args:
            other: Another model or link, by name or as an object; None for all.

        Raises:
            UnknownNameError: The other model or link does not exist.
        """
        return self._world.contacts(self if other is None else (self, other))
