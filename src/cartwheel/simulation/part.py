"""A model's part of the simulation: all that its plugins may touch."""

from __future__ import annotations

import zlib
from collections.abc import Callable, Collection

import numpy as np

from cartwheel.description.model import CameraIntrinsics, RobotDescription
from cartwheel.errors import Diagnostic, Origin, UnknownNameError
from cartwheel.geometry import Pose
from cartwheel.simulation.clock import NANOSECONDS, Task, always
from cartwheel.simulation.contacts import read_contacts
from cartwheel.simulation.engine import Engine
from cartwheel.simulation.handles import (
    CameraHandle,
    Handle,
    JointHandle,
    LinkHandle,
    MotorHandle,
)
from cartwheel.simulation.snapshot import Contact
from cartwheel.world.entry import CameraMount, ModelEntry, Motor, scoped


class Part:
    """What a plugin gets of the simulation; for the simulation's thread alone."""

    def __init__(self, engine: Engine, entry: ModelEntry) -> None:
        self._engine = engine
        self._entry = entry
        self.handles: list[Handle] = []
        self.tasks: list[Task] = []
        self.diagnostics: list[Diagnostic] = []
        self.spawned = False

    @property
    def name(self) -> str:
        """The model's name in this world."""
        return self._entry.name

    @property
    def description(self) -> RobotDescription:
        return self._entry.description

    @property
    def time_ns(self) -> int:
        """Simulation time of the state that is being read or controlled."""
        return self._engine.time_ns

    @property
    def seconds(self) -> float:
        """The same in s."""
        return self._engine.time_ns / NANOSECONDS

    def link(self, name: str, *, origin: Origin | None = None) -> LinkHandle:
        """A link of this model.

        Raises:
            UnknownNameError: There is none; placed at `origin`.
        """
        if self.description.link(name) is None:
            raise UnknownNameError(
                "link", name, [link.name for link in self.description.links], origin=origin
            )
        handle = LinkHandle(self.name, name)
        self.handles.append(handle)
        return handle

    def joint(self, name: str, *, origin: Origin | None = None) -> JointHandle:
        """A joint of this model that moves.

        Raises:
            UnknownNameError: There is none; placed at `origin`.
        """
        movable = [
            joint.name
            for joint in self.description.joints
            if joint.type in ("revolute", "continuous", "prismatic")
        ]
        if name not in movable:
            raise UnknownNameError("movable joint", name, movable, origin=origin)
        handle = JointHandle(self.name, name)
        self.handles.append(handle)
        return handle

    def velocity_motor(
        self, joint: str, *, max_effort: float | None, origin: Origin | None = None
    ) -> MotorHandle:
        """A servo that holds a joint's velocity with at most `max_effort` N m or N.

        Two that ask for the same joint share the motor of the first.
        """
        self.joint(joint, origin=origin)
        motor = self._entry.motors.setdefault(
            joint, Motor(joint=joint, mode="velocity", max_effort=max_effort)
        )
        handle = MotorHandle(self.name, motor)
        self.handles.append(handle)
        return handle

    def camera(
        self, name: str, link: str, pose: Pose, intrinsics: CameraIntrinsics
    ) -> CameraHandle:
        """A camera on a link, looking along the x axis of `pose`."""
        taken = {mount.name for mount in self._entry.cameras}
        unique = name
        count = 1
        while unique in taken:
            count += 1
            unique = f"{name}_{count}"
        self._entry.cameras.append(
            CameraMount(name=unique, link=link, pose=pose, intrinsics=intrinsics)
        )
        handle = CameraHandle(self.name, unique, intrinsics)
        self.handles.append(handle)
        return handle

    def schedule(
        self,
        rate: float,
        *,
        before: Callable[[], None] | None = None,
        after: Callable[[], None] | None = None,
        active: Callable[[], bool] = always,
    ) -> None:
        """Does something at a rate in Hz; 0 is every step. See `Task`."""
        self.tasks.append(self._engine.task(rate, before=before, after=after, active=active))

    def random(self, name: str) -> np.random.Generator:
        """The noise of this moment, a sequence of its own for each named user.

        It depends on the seed, the time and the two names alone: who else draws, who listens
        and since when change nothing. Take a new one for each measurement.
        """
        words = [
            self._engine.seed,
            zlib.crc32(self.name.encode()),
            zlib.crc32(name.encode()),
            self._engine.time_ns,
        ]
        return np.random.default_rng(words)

    def contacts(self, collisions: Collection[str]) -> list[Contact]:
        """Contacts of these collisions (``link::collision``), each the `first` of its contact."""
        names = {scoped(self.name, collision) for collision in collisions}
        return read_contacts(self._engine.model, self._engine.data, names)

    def render(self, camera: CameraHandle) -> np.ndarray[tuple[int, int, int], np.dtype[np.uint8]]:
        """An image through a camera, shape (height, width, 3), RGB.

        Raises:
            SimulationError: No OpenGL; says what to install.
        """
        return self._engine.renderer.render(self._engine.data, camera)

    def report(self, diagnostic: Diagnostic) -> None:
        """Tells the user something about this model; also while it runs."""
        if self.spawned:
            self._engine.report(diagnostic)
        else:
            self.diagnostics.append(diagnostic)
