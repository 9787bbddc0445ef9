"""The interface between plugins and the simulation."""

from __future__ import annotations

import contextlib
from collections.abc import Callable, Collection, Iterator
from typing import Any, Protocol, TypeVar

import numpy as np

from cartwheel.codes.devices import CONTACT_COLLISION_UNKNOWN
from cartwheel.description.model import WorldDescription
from cartwheel.errors import Origin, UnknownNameError
from cartwheel.geometry import Pose
from cartwheel.simulation.clock import NANOSECONDS, SLOWEST, Task
from cartwheel.simulation.dynamics.external_servos import BodyDriveHandle, WrenchHandle
from cartwheel.simulation.dynamics.joint_servo import ServoHandle
from cartwheel.simulation.dynamics.moving_surface import SurfaceHandle
from cartwheel.simulation.dynamics.velocity_motor import MotorHandle
from cartwheel.simulation.engine import Engine
from cartwheel.simulation.handles import CameraHandle, Handle
from cartwheel.simulation.motor_requests import MotorRequests
from cartwheel.simulation.random_numbers import RandomNumbers
from cartwheel.simulation.sensing.contacts import contacts_of, geoms_of
from cartwheel.simulation.sensing.rays import RayHandle
from cartwheel.simulation.sensing.views import Depth, Image
from cartwheel.simulation.snapshot import Contact
from cartwheel.world.entry import ModelEntry, scoped

T = TypeVar("T")


class Tuned(Protocol):
    """A PID controller."""

    gains: Any
    """A dataclass with the fields ``p``, ``i``, ``d``, ``i_min`` and ``i_max``."""


class Limited(Protocol):
    """A motor or controller that limits the commands of a joint."""

    limits: Any
    """A dataclass with the fields ``lower``, ``upper``, ``velocity`` and ``effort``."""


class Clock(Protocol):
    """The time of a simulation."""

    time_ns: int
    """Simulation time of the current state."""
    step_ns: int
    """Length of a step."""


class Part(MotorRequests):
    """A plugin's access to its model in the simulation. Use it only on the simulation's thread.

    Args:
        engine: The engine that simulates the model.
        entry: The model.
        namespace: Default namespace of topics and services; "" if not set.
        frame_prefix: Prefix of all frames, as ROS 1's tf_prefix.
    """

    def __init__(
        self, engine: Engine, entry: ModelEntry, *, namespace: str = "", frame_prefix: str = ""
    ) -> None:
        super().__init__(engine, entry)
        self.clock: Clock = engine
        """Simulation time and length of a step, which are read faster here."""
        self.namespace = namespace
        """Default namespace of topics and services; "" if not set."""
        self.frame_prefix = frame_prefix
        """Prefix of all frames, as ROS 1's tf_prefix."""
        self.owned: list[tuple[object, list[Handle | RayHandle]]] = []
        """Plugins and their handles."""
        self.published: set[str] = set()
        """Names of the topics that plugins of the model have advertised."""
        self.transformed: set[str] = set()
        """Names of those topics on which transforms of odometry are published."""
        self.subscribed: set[str] = set()
        """Names of the topics that plugins of the model have subscribed to."""
        self.services: set[str] = set()
        """Names of the services that plugins of the model have offered."""
        self.actions: set[str] = set()
        """Names of the actions that plugins of the model have offered."""
        self.tuned: list[tuple[str, Tuned]] = []
        """Joints and their PID controllers."""
        self.limited: list[tuple[str, Limited]] = []
        """Joints, and what limits their commands."""
        self.on_seed: list[Callable[[], None]] = []
        """Called after a reset with a new seed, to draw random constants again; see `random`."""
        self._random = RandomNumbers(entry.name)
        self.read_sensors: set[str] = set()
        """Sensors that a plugin of the model publishes, so that no default plugin is needed."""
        self._touched: dict[frozenset[str], dict[int, str]] = {}
        """Geoms in the MuJoCo model of the collisions that were passed to `contacts`."""
        self._touched_in: Any = None
        """The MuJoCo model of `_touched`."""

    @property
    def world(self) -> WorldDescription:
        """The description of the world that contains the model."""
        return self._engine.world

    @property
    def driven(self) -> bool:
        """Whether a plugin of this model currently drives a joint."""
        return any(
            handle.turns for handle in self.handles if isinstance(handle, MotorHandle | ServoHandle)
        )

    @property
    def time_ns(self) -> int:
        """Simulation time of the current state."""
        return self._engine.time_ns

    @property
    def seconds(self) -> float:
        """Simulation time of the current state, s."""
        return self._engine.time_ns / NANOSECONDS

    @property
    def served(self) -> bool:
        """Whether the due tasks have run, and the step that starts now has not: a run has ended
        here, and commands of the program between two runs arrive.
        """
        return self._engine.served_ns == self._engine.time_ns

    def models(self) -> dict[str, Pose]:
        """Poses of all models in the world by name, including this one."""
        engine = self._engine
        return {entry.name: engine.model_pose(entry) for entry in engine.entries}

    def locate(self) -> None:
        """Before a step: updates link poses and velocities, which otherwise lag by one step."""
        self._engine.locate()

    def reschedule(self, task: Task, rate: float) -> Task:
        """Replaces a task with one at a different rate; the given task becomes invalid."""
        made = self._engine.task(
            rate, before=task.before, after=task.after, active=task.active, topics=task.topics,
            idle=task.idle,
        )  # fmt: skip
        made.order, made.owner, made.reads_state = task.order, task.owner, task.reads_state
        self.tasks[self.tasks.index(task)] = made
        for callback in self._engine.on_tasks:
            callback()
        return made

    def last_due_ns(self, task: Task) -> int:
        """The last time before the current one at which a task was due, or 0."""
        engine = self._engine
        step_ns, origin_ns = engine.step_ns, engine.origin_ns
        last = task.ticks(step_ns, origin_ns).last(engine.step)
        return max(0, origin_ns + last * step_ns)

    def period_ns(self, rate: float) -> int:
        """The mean period of a task with a rate in Hz; 0 is every step."""
        if rate <= 0:
            return self._engine.step_ns
        return max(self._engine.step_ns, round(NANOSECONDS / max(rate, SLOWEST)))

    def random(self, name: str) -> np.random.Generator:
        """The random generator for the noise at the current time, separate for each `name`.

        It depends only on the seed, the time, the model's name and `name`. Use it at once: the next
        call with this name sets it to its time.
        """
        engine = self._engine
        return self._random.at(name, seed=engine.seed, time_ns=engine.time_ns)

    def random_stream(self, name: str) -> np.random.Generator:
        """A new random generator, which begins at the current time and continues on its own."""
        engine = self._engine
        return self._random.stream(name, seed=engine.seed, time_ns=engine.time_ns)

    def contacts(self, collisions: Collection[str]) -> list[Contact]:
        """Contacts of these collisions, each as `first`; after a forward pass.

        Args:
            collisions: ``link::collision``, with the name of the collision in the URDF or in
                Gazebo, which appends ``_collision`` to names of a URDF.

        Raises:
            UnknownNameError: A collision does not exist.
        """
        model, key = self._engine.model, frozenset(collisions)
        if model is not self._touched_in:
            self._touched_in = model
            self._touched.clear()
        geoms = self._touched.get(key)
        if geoms is None:
            names = {scoped(self.name, self._collision(name)) for name in collisions}
            geoms = self._touched[key] = geoms_of(model, names)
        return contacts_of(model, self._engine.data, geoms)

    def _collision(self, name: str) -> str:
        """The name of a collision in the world, as ``link::collision``."""
        known: dict[str, str] = {}
        for link in self.description.links:
            for each in link.collisions:
                known[scoped(link.name, each.name)] = scoped(link.name, each.name)
            for each in link.collisions:
                for alias in each.aliases:
                    known.setdefault(scoped(link.name, alias), scoped(link.name, each.name))
        if name not in known:
            names = sorted(set(known.values()))
            raise UnknownNameError("collision", name, names, code=CONTACT_COLLISION_UNKNOWN)
        return known[name]

    def surface(self, link: str, *, origin: Origin | None = None) -> SurfaceHandle:
        """The surfaces of a link's collisions, which can move along themselves.

        Raises:
            UnknownNameError: The link does not exist; the error has this `origin`.
        """
        self.link(link, origin=origin)
        # The surface must be able to move a body that rests on it.
        self.feel(link)
        self._entry.tracks.append(link)
        handle = SurfaceHandle(self.name, link)
        self.handles.append(handle)
        return handle

    def tune(self, joint: str, controller: Tuned) -> None:
        """States that a PID controller moves a joint, so that users can change its gains."""
        self.tuned.append((joint, controller))

    def limit(self, joint: str, controller: Limited) -> None:
        """States that the commands of a joint are limited, so that users can change the limits."""
        self.limited.append((joint, controller))

    def made(self, make: Callable[[], T]) -> T:
        """Creates a plugin, which owns everything it requests; all of it is undone if creation
        fails.
        """
        handles, tasks = len(self.handles), len(self.tasks)
        with self._undone_on_error():
            plugin = make()
        self.owned.append((plugin, self.handles[handles:]))
        for task in self.tasks[tasks:]:
            task.owner = plugin
        return plugin

    def disable(self, plugin: object) -> None:
        """Disables a plugin: removes its tasks and stops its motors and forces."""
        for task in self.tasks:
            if task.owner is plugin:
                task.forget()
        self.tasks = [task for task in self.tasks if task.owner is not plugin]
        for owner, handles in self.owned:
            if owner is not plugin:
                continue
            for handle in handles:
                if isinstance(handle, MotorHandle):
                    handle.command(0.0)
                elif isinstance(handle, ServoHandle | BodyDriveHandle):
                    handle.release()
                elif isinstance(handle, WrenchHandle):
                    handle.apply((0.0,) * 3, (0.0,) * 3)
                elif isinstance(handle, SurfaceHandle):
                    handle.stop()

    def fail(self, plugin: object, error: BaseException) -> None:
        """Disables a plugin of this model that failed outside its tasks."""
        self._engine.on_fault(plugin, error)

    @contextlib.contextmanager
    def _undone_on_error(self) -> Iterator[None]:
        """Undoes all requests within a ``with`` block that raises an error."""
        entry = self._entry
        lists: tuple[list[Any], ...] = (
            self.handles,
            self.tasks,
            self.tuned,
            self.limited,
            self.on_seed,
            entry.drives,
            entry.cameras,
            entry.attachments,
            entry.tracks,
            entry.felt,
        )
        tables: tuple[dict[str, Any], ...] = (
            entry.motors,
            entry.mimics,
            entry.slips,
            entry.grips,
        )
        lengths = [len(each) for each in lists]
        copies = [dict(each) for each in tables]
        try:
            yield
        except BaseException:
            for each, length in zip(lists, lengths, strict=True):
                del each[length:]
            for table, copy in zip(tables, copies, strict=True):
                table.clear()
                table.update(copy)
            raise

    def render(self, camera: CameraHandle) -> Image:
        """An image from a camera, shape (height, width, 3), RGB.

        Raises:
            WorldError: A visual cannot be built.
            SimulationError: OpenGL is missing, or was opened before a fork. The hint gives the fix.
        """
        return self._engine.renderer.render(camera)

    def render_with_depth(self, camera: CameraHandle) -> tuple[Image, Depth]:
        """The image, and depths along the camera's axis in m, shape (height, width).

        Raises:
            WorldError: A visual cannot be built.
            SimulationError: OpenGL is missing, or was opened before a fork. The hint gives the fix.
        """
        return self._engine.renderer.render_with_depth(camera)

    def count_command(self) -> None:
        """Counts an external action on the model; see `Simulation.recover`."""
        self._engine.commanded += 1
