"""A model in a world."""

from __future__ import annotations

from typing import TYPE_CHECKING

from cartwheel.api.arguments import text
from cartwheel.api.exchange.model_messages import MessagingModel
from cartwheel.api.joints import Joints
from cartwheel.api.links import Link
from cartwheel.api.motion import Twist
from cartwheel.api.values import Vector, instance, vector
from cartwheel.geometry import Pose

if TYPE_CHECKING:
    from cartwheel.api.world import World

_NONE: Vector = (0.0, 0.0, 0.0)


class Model(MessagingModel):
    """A handle to a model in a world.

    Two handles are equal if they belong to the same world and have the same name.
    """

    __slots__ = ("_world", "name")
    _world: World
    name: str

    def __init__(self, world: World, name: str) -> None:
        # Programs create one for each read: without the check of `Handle`, it takes a third of the
        # time.
        object.__setattr__(self, "_world", world)
        object.__setattr__(self, "name", name)

    def __repr__(self) -> str:
        return f"Model({self.name!r})"

    @property
    def _identity(self) -> tuple[World, str]:
        return self._world, self.name

    @property
    def scoped_name(self) -> str:
        """The name, for `World.contacts`."""
        return self.name

    # -- motion

    @property
    def pose(self) -> Pose:
        """Pose of the model's frame in the world: for a URDF, the frame of the root link.

        Setting it moves the whole model and stops its motion; its joints keep their positions. A
        model that is fixed to the world moves, too.

        Raises:
            UnknownNameError: The model does not exist any more.
            CartwheelError: A number is not finite or too large.
        """
        with self._world.lock:
            return Pose(*self._world.session.simulation.truth.place(self.name))

    @pose.setter
    def pose(self, pose: Pose) -> None:
        pose = instance(pose, Pose, "pose", "cartwheel.Pose((x, y, z))")
        with self._world._used(change=True) as simulation:
            simulation.set_pose(self.name, pose)

    @property
    def velocity(self) -> Twist:
        """Velocity of the model's frame, in world axes.

        Setting it gives the whole model this velocity, as a rigid body; its joints stop. To give
        joints a velocity, set `joints.velocities` afterwards.

        A model that is fixed to the world keeps the velocity, whatever it meets, until the velocity
        or the pose is set again. It carries by friction what lies on it. `World.reset` ends the
        motion and returns the model to its first pose.

        Raises:
            UnknownNameError: The model does not exist any more.
            SimulationError: The model is fixed to the world and joints depend on its links, such as
                those of an arm, or the world is closed.
            CartwheelError: A number is not finite or too large.
        """
        with self._world.lock:
            return Twist(*self._world.session.simulation.truth.velocity(self.name))

    @velocity.setter
    def velocity(self, velocity: Twist) -> None:
        velocity = instance(velocity, Twist, "velocity", "cartwheel.Twist(linear=(x, y, z))")
        linear = vector(velocity.linear, "velocity.linear")
        angular = vector(velocity.angular, "velocity.angular")
        with self._world._used(change=True) as simulation:
            simulation.truth.set_velocity(self.name, linear, angular)

    def push(
        self,
        force: Vector = _NONE,
        torque: Vector = _NONE,
        *,
        at: Vector | None = None,
        seconds: float = 0.0,
    ) -> None:
        """Pushes the root link; see `Link.push`."""
        with self._world.lock:
            self._root.push(force, torque, at=at, seconds=seconds)

    def end_pushes(self) -> None:
        """Ends all pushes on the root link; see `Link.end_pushes`."""
        with self._world.lock:
            self._root.end_pushes()

    @property
    def _root(self) -> Link:
        return self.link(self._world.session.simulation.truth.description(self.name).canonical_link)

    # -- parts

    @property
    def mass(self) -> float:
        """Total mass of all links, kg.

        Raises:
            UnknownNameError: The model does not exist any more.
        """
        with self._world.lock:
            return self._world.session.simulation.truth.description(self.name).mass

    @property
    def links(self) -> tuple[str, ...]:
        """Names of the links, in the order of the description.

        Raises:
            UnknownNameError: The model does not exist any more.
        """
        with self._world.lock:
            description = self._world.session.simulation.truth.description(self.name)
            return tuple(link.name for link in description.links)

    def link(self, name: str) -> Link:
        """A handle to a link.

        Args:
            name: Name of the link in the model.

        Raises:
            UnknownNameError: The link does not exist, or the model does not exist any more.
        """
        with self._world.lock:
            self._world.session.simulation.truth.link(self.name, text(name, "name"))
        return Link(self._world, self.name, name)

    @property
    def joints(self) -> Joints:
        """The joints with one degree of freedom.

        ``model.joints.positions["elbow"]`` is a position, and
        ``numpy.asarray(model.joints.positions)`` an array of all.
        """
        return Joints(self._world, self.name)

    @property
    def cameras(self) -> tuple[str, ...]:
        """Names of the cameras of the model's sensors, such as ``rosbots::camera1``.

        `cartwheel.dataset.Dataset` accepts them.

        Raises:
            UnknownNameError: The model does not exist any more.
        """
        with self._world.lock:
            mounts = self._world.session.simulation.truth.cameras(self.name)
            return tuple(f"{self.name}::{mount.name}" for mount in mounts)

    def joint(self, name: str) -> float:
        """Position of a joint, rad or m. For its other values, use ``joints[name]``.

        Raises:
            UnknownNameError: The joint does not exist.
        """
        with self._world.lock:
            return self._world.session.simulation.joint_position(self.name, text(name, "name"))

    # -- the end

    def delete(self) -> None:
        """Removes the model from the world."""
        with self._world._used(change=True) as simulation:
            simulation.delete(self.name)
