"""Models in a simulation: spawning, deleting, poses, joint positions and drives."""

from __future__ import annotations

import contextlib
from collections.abc import Iterator, Mapping, Sequence

from cartwheel.codes import world as world_codes
from cartwheel.description.model import RobotDescription
from cartwheel.errors import UnknownNameError
from cartwheel.geometry import Pose, Vec3
from cartwheel.simulation.dynamics.separation import STILL, Speeds
from cartwheel.simulation.engine import Engine
from cartwheel.simulation.limits import STRONGEST, check_pose, number, numbers
from cartwheel.simulation.models.attachments import Attachments
from cartwheel.simulation.models.compilations import Compiler
from cartwheel.simulation.models.forces import Forces
from cartwheel.simulation.models.occupied_space import Space, occupied
from cartwheel.simulation.models.placement import place_model, with_mimics
from cartwheel.simulation.models.population import Population
from cartwheel.simulation.models.resident import Attach
from cartwheel.simulation.models.waking import keep_awake
from cartwheel.simulation.run_state import Run
from cartwheel.simulation.sensing.line_of_sight import in_sight
from cartwheel.simulation.snapshot import Scene

_STILL: Vec3 = (0.0, 0.0, 0.0)
_MOST_DELETED = 10_000
"""Maximum number of names of deleted models that are kept for errors."""


class Models(Run):
    """The part of a simulation that reads and changes models by name.

    Args:
        engine: The engine that simulates the models.
        attach: Creates a model's plugins.
        compiler: Compiles the models.
    """

    def __init__(self, engine: Engine, attach: Attach, compiler: Compiler) -> None:
        super().__init__()
        self.engine = engine
        self.forces = Forces(engine)
        self._population = Population(engine, self.forces, attach, compiler)
        self.attachments = Attachments(engine, self._population.house.part)
        """Links that a program has attached to each other."""

    @property
    def population(self) -> Population:
        """The models with their plugins."""
        return self._population

    @property
    def models(self) -> tuple[str, ...]:
        """Names of the models, in spawn order."""
        return tuple(self._population.residents)

    @property
    def scene(self) -> Scene:
        """The models, links and joints in the world."""
        return self._population.observer.scene

    def spawn(
        self,
        description: RobotDescription,
        *,
        name: str | None = None,
        pose: Pose | None = None,
        namespace: str = "",
        frame_prefix: str = "",
    ) -> str:
        """Spawns a model; the rest of the state is unchanged.

        Args:
            description: The model's description.
            name: Name in this world; None for the description's name.
            pose: Pose of the root link in the world; None for the description's pose.
            namespace: Default namespace of topics and services.
            frame_prefix: Prefix of frame names.

        Returns:
            The model's name.

        Raises:
            WorldError: The name is in use or the model cannot be built; nothing has changed.
            PluginError: A plugin's parameters are invalid; nothing has changed.
            CartwheelError: The pose is not finite or too far away; nothing has changed.
        """
        name = name or description.name
        if pose is not None:
            check_pose(pose, f'model "{name}"')
        with self.spawning():
            self._population.enter(description, name, pose, namespace, frame_prefix)
        return name

    @contextlib.contextmanager
    def spawning(self) -> Iterator[None]:
        """Compiles all models that are spawned within the block together, when it ends.

        Until then, these models are not in the world. If the block raises an error, none of them
        is. A block within another one ends with the outer block.

        Raises:
            WorldError: A model cannot be built; nothing has changed.
        """
        with self._population.entering():
            yield

    def withdraw(self, name: str) -> None:
        """Removes a model again within the block of `spawning` in which it was spawned."""
        self._population.withdraw(name)

    def delete(self, *names: str) -> None:
        """Deletes models; the rest of the state is unchanged.

        Raises:
            UnknownNameError: A model does not exist; nothing has changed.
        """
        population = self._population
        removed = {name: population.resident(name) for name in names}
        kept = {key: each for key, each in population.residents.items() if key not in removed}
        population.compile(kept)
        if len(population.deleted) >= _MOST_DELETED:
            population.deleted.clear()
        population.deleted.update(removed)
        for name, resident in removed.items():
            self.forces.drop(name)
            resident.close()

    def pose(self, name: str) -> Pose:
        """Pose of a model's frame in the world; see `Engine.model_pose`."""
        return self.engine.model_pose(self._population.resident(name).entry)

    def moves(self, name: str) -> bool:
        """Whether a model can move in the world: it is neither static nor fixed to the world.

        Raises:
            UnknownNameError: The model does not exist.
        """
        link = self._population.resident(name).entry.description.canonical_link
        return self.engine.is_free(name, link)

    def namespace(self, name: str) -> str:
        """The namespace of a model's topics and services; empty for the root.

        Raises:
            UnknownNameError: The model does not exist.
        """
        return self._population.resident(name).part.namespace

    def topics(self, name: str) -> frozenset[str]:
        """Names of the topics that a model's plugins have advertised or subscribed to.

        Raises:
            UnknownNameError: The model does not exist.
        """
        part = self._population.resident(name).part
        return frozenset(part.published | part.subscribed)

    def services(self, name: str) -> frozenset[str]:
        """Names of the services that a model's plugins have offered.

        Raises:
            UnknownNameError: The model does not exist.
        """
        return frozenset(self._population.resident(name).part.services)

    def actions(self, name: str) -> frozenset[str]:
        """Names of the actions that a model's plugins have offered.

        Raises:
            UnknownNameError: The model does not exist.
        """
        return frozenset(self._population.resident(name).part.actions)

    def frame_prefix(self, name: str) -> str:
        """The prefix of a model's frames, as set at spawn.

        Raises:
            UnknownNameError: The model does not exist.
        """
        return self._population.resident(name).part.frame_prefix

    def driven(self, name: str, joint: str) -> bool:
        """Whether `drive` currently drives a joint."""
        return joint in self._population.resident(name).drives

    def joint_position(self, name: str, joint: str) -> float:
        """Position of a joint with one degree of freedom, rad or m.

        Raises:
            UnknownNameError: The model or joint does not exist.
        """
        self._population.resident(name)
        if (name, joint) not in self.scene.joints:
            known = [other for model, other in self.scene.joints if model == name]
            raise UnknownNameError("joint", joint, known, code=world_codes.UNKNOWN_JOINT)
        return self.engine.joint_position(self.engine.joint_id(name, joint))

    def in_sight(self, name: str, eyes: Sequence[Vec3], target: Vec3) -> list[bool]:
        """For each viewpoint in the world, m, whether the model is visible at the target point."""
        return in_sight(*self.engine.visuals.current(), name, eyes, target)

    def occupied(self) -> Space:
        """The space currently occupied by collision shapes."""
        return occupied(self.engine.model, self.engine.data)

    def set_pose(self, name: str, pose: Pose) -> None:
        """Moves a model's frame, and the model with it, and stops its motion.

        Raises:
            UnknownNameError: The model does not exist.
            CartwheelError: The pose is not finite or too far away.
        """
        entry = self._population.resident(name).entry
        check_pose(pose, f'model "{name}"')
        self.engine.commanded += 1
        joint = self.engine.joint_id(name, entry.description.canonical_link)
        speeds = STILL
        if joint < 0:
            speeds = self._place_fixed(name, pose)
        else:
            keep_awake(self.engine, [joint])
            self.engine.place(joint, pose @ entry.description.canonical_pose)
        self._population.separate(name, speeds)

    def _place_fixed(self, name: str, pose: Pose) -> Speeds:
        """Moves a model that is fixed to the world. Returns its speeds if it follows a path."""
        before = self._population.resident(name).entry.pose
        self._population.place(name, pose)
        separation = self._population.separation
        return separation.along_path(name, self.engine.time_ns, before, pose)

    def set_state(
        self, name: str, pose: Pose, *, linear: Vec3 = _STILL, angular: Vec3 = _STILL
    ) -> None:
        """Moves a model's frame and sets the velocity of the whole model as a rigid body.

        Joints keep their positions and stop. A model fixed to the world moves with its mount and
        gets no velocity.

        Args:
            name: Model name.
            pose: Pose of its frame in the world.
            linear: Velocity of the frame's origin, m/s, in world axes.
            angular: rad/s, in world axes.

        Raises:
            UnknownNameError: The model does not exist.
            CartwheelError: A number is not finite or too large.
        """
        entry = self._population.resident(name).entry
        check_pose(pose, f'model "{name}"')
        numbers((*linear, *angular), f'the velocity of model "{name}"')
        self.engine.commanded += 1
        speeds = STILL
        if self.moves(name):
            place_model(self.engine, entry, pose, linear, angular)
        elif entry.pose != pose:
            speeds = self._place_fixed(name, pose)
        self._population.separate(name, speeds)

    def set_joint_positions(self, name: str, positions: Mapping[str, float]) -> None:
        """Sets the positions of joints with one degree of freedom, rad or m, and stops them.

        Joints that mimic them follow.

        Raises:
            UnknownNameError: The model or a joint does not exist.
            CartwheelError: A position is not finite or too large.
        """
        description = self._population.resident(name).entry.description
        known = [other for model, other in self.scene.joints if model == name]
        for joint, position in positions.items():
            if joint not in known:
                raise UnknownNameError("joint", joint, known, code=world_codes.UNKNOWN_JOINT)
            number(position, f'the position of joint "{joint}"')
        self.engine.commanded += 1
        moved = {
            self.engine.joint_id(name, joint): position
            for joint, position in with_mimics(description, positions).items()
        }
        keep_awake(self.engine, moved)
        for index, position in moved.items():
            self.engine.set_joint(index, position)
        self.engine.forward()
        self._population.separate(name)

    def drive(
        self,
        name: str,
        joint: str,
        *,
        velocity: float | None = None,
        max_effort: float | None = None,
    ) -> None:
        """Drives a joint at a velocity with limited effort, like ODE's joint motors.

        Velocity 0 brakes the joint. For a joint with a drive plugin, it sets the plugin's velocity.

        Args:
            name: Model name.
            joint: A joint with one degree of freedom.
            velocity: rad/s or m/s; None leaves it unchanged. Initially 0.
            max_effort: N m or N; None leaves it unchanged, 0 removes the drive.

        Raises:
            UnknownNameError: The model or joint does not exist.
            WorldError: A plugin drives the joint by effort or position.
            CartwheelError: A number is not finite or too large.
        """
        if velocity is not None:
            number(velocity, f'the velocity of joint "{joint}"')
        if max_effort is not None:
            number(max_effort, f'the effort of joint "{joint}"', most=STRONGEST)
        self.engine.commanded += 1
        if self._population.resident(name).motorise(joint, max_effort):
            self._population.compile()
        drives = self._population.resident(name).drives
        if velocity is not None and joint in drives:
            drives[joint].command(velocity)

    def redescribe(self, name: str, description: RobotDescription) -> None:
        """Changes properties of a model's links or joints, which `reset` keeps.

        The model keeps its state; commands and forces continue. Only changes that `InPlace` does
        not support require a compilation.

        Raises:
            UnknownNameError: The model does not exist.
            WorldError: The model cannot be built; nothing has changed.
        """
        self._population.describe(name, description)
