"""A model in a world."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from cartwheel.geometry import Pose

if TYPE_CHECKING:
    from cartwheel.api.world import World


class Model:
    """A handle to a model in a world."""

    def __init__(self, world: World, name: str) -> None:
        self._world = world
        self.name = name

    @property
    def pose(self) -> Pose:
        """Pose of the root link in the world frame."""
        with self._world.lock:
            self._world.session.simulation.refresh()
            return self._world.session.simulation.pose(self.name)

    @pose.setter
    def pose(self, pose: Pose) -> None:
        with self._world.used(change=True) as simulation:
            simulation.set_pose(self.name, pose)

    def joint(self, name: str) -> float:
        """Position of a joint, rad or m.

        Raises:
            UnknownNameError: The joint does not exist.
        """
        with self._world.lock:
            return self._world.session.simulation.joint_position(self.name, name)

    def publish(self, topic: str, message: Any = None, **fields: Any) -> None:
        """`World.publish`."""
        self._world.publish(topic, message, **fields)

    def delete(self) -> None:
        """Removes the model from the world."""
        with self._world.used(change=True) as simulation:
            simulation.delete(self.name)
