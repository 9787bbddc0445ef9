"""A model in a simulation, with its plugins."""

from __future__ import annotations

from collections.abc import Callable, Container, Iterable
from dataclasses import replace
from typing import Protocol

from cartwheel.calls import raise_exit
from cartwheel.codes import running
from cartwheel.codes import world as world_codes
from cartwheel.description.model import RobotDescription
from cartwheel.errors import Origin, UnknownNameError, WorldError, fault
from cartwheel.geometry import Pose
from cartwheel.simulation.dynamics.external_servos import WrenchHandle
from cartwheel.simulation.dynamics.joint_servo import ServoHandle
from cartwheel.simulation.dynamics.velocity_motor import MotorHandle
from cartwheel.simulation.engine import Engine
from cartwheel.simulation.part import Part
from cartwheel.world.entry import ModelEntry

_WEAKEST = 1e-9
"""Effort limit of a motor with no effort, N m or N."""


class Behaviour(Protocol):
    """The simulation's interface to a plugin."""

    def reset(self) -> None:
        """The simulation was reset to its initial state; time may continue or restart."""

    def close(self) -> None:
        """The model is removed from the world."""

    def drop_references(self) -> None:
        """After `close`: the world ends, and all references between plugins and parts with it."""


Attach = Callable[[Part], list[Behaviour]]
"""Creates the plugins of a model that is about to be spawned."""


def unknown_model(name: str, known: Iterable[str], deleted: Container[str]) -> UnknownNameError:
    """The error for a model that does not exist, or not any more.

    Args:
        name: Name of the model.
        known: Names of the models in the world.
        deleted: Names of models that were deleted.
    """
    error = UnknownNameError("model", name, known, code=world_codes.UNKNOWN_MODEL)
    if name in deleted:
        error.hint = f"It was deleted. {error.hint or ''}".strip()
        error.values = {**error.values, "deleted": True}
    return error


def title(behaviour: object) -> str:
    """A plugin's name for messages."""
    found = getattr(behaviour, "title", None)
    return found if isinstance(found, str) else f"plugin {type(behaviour).__name__}"


def place(behaviour: object) -> Origin | None:
    """The origin of a plugin's tag."""
    return getattr(getattr(behaviour, "tag", None), "origin", None)


class Resident:
    """A model with its part and plugins."""

    def __init__(self, entry: ModelEntry, part: Part) -> None:
        self.entry = entry
        self.part = part
        self.behaviours: list[Behaviour] = []
        self.created: tuple[Behaviour, ...] = ()
        """All plugins that were created, also those that were disabled since."""
        self.drives: dict[str, MotorHandle] = {}
        """Motorised joints that no plugin drives."""
        self.start: Pose = entry.pose
        """The pose after a reset."""

    def motorise(self, joint: str, max_effort: float | None) -> bool:
        """Adds a motor to a joint, or changes its motor's limit.

        Args:
            joint: A joint with one degree of freedom.
            max_effort: N m or N. None keeps an existing limit; 0 removes a motor that no plugin
                created.

        Returns:
            Whether the model must be recompiled.

        Raises:
            UnknownNameError: The joint does not exist.
            WorldError: A plugin drives it by effort or position.
        """
        motors = self.entry.motors
        motor = motors.get(joint)
        if motor is not None and motor.mode != "velocity":
            raise WorldError(
                f'a plugin drives joint "{joint}" by effort or position',
                code=world_codes.JOINT_DRIVEN_BY_PLUGIN,
                values={"joint": joint},
            )
        if max_effort is None or max_effort == (motor.max_effort if motor else 0.0):
            return False
        if motor is None:
            self.drives[joint] = self.part.velocity_motor(joint, max_effort=max_effort)
        elif joint in self.drives and max_effort == 0:
            self.part.handles.remove(self.drives.pop(joint))
            del motors[joint]
        else:
            motors[joint] = replace(motor, max_effort=max(max_effort, _WEAKEST))
        return True

    def attach(self, attach: Attach) -> None:
        """Creates the plugins."""
        self.behaviours = attach(self.part)
        self.created = tuple(self.behaviours)

    def close(self) -> None:
        """Closes all plugins."""
        for behaviour in self.behaviours:
            self._close(behaviour)

    def rewind_servos(self) -> None:
        """Returns all servos to the commands that they had when the model was spawned."""
        for handle in self.part.handles:
            if isinstance(handle, ServoHandle):
                handle.rewind()

    def forget_wrenches(self) -> None:
        """Clears the forces and torques of all plugins, after a reset has removed them."""
        for handle in self.part.handles:
            if isinstance(handle, WrenchHandle):
                handle.forget()

    def end(self, plugin: object) -> None:
        """Closes a plugin; does nothing if it does not belong to this model."""
        for behaviour in self.behaviours:
            if behaviour is plugin:
                self.behaviours.remove(behaviour)
                self.part.disable(behaviour)
                self._close(behaviour)
                return

    def _close(self, behaviour: Behaviour) -> None:
        try:
            behaviour.close()
        except (Exception, SystemExit) as error:  # noqa: BLE001 - a plugin's own
            raise_exit(error)
            text = f"{title(behaviour)} failed while it was closed"
            self.part.report(fault(text, error, place(behaviour), code=running.PLUGIN_FAILED))

    def forget(self) -> None:
        """After `close`: clears all references between plugins and parts.

        Plugins and their parts refer to each other, and these cycles would keep the engine's memory
        allocated until Python's garbage collector runs.
        """
        for behaviour in self.behaviours:
            behaviour.drop_references()
        self.behaviours = []
        self.created = ()
        self.drives.clear()
        self.part.handles.clear()
        self.part.limited.clear()
        for task in self.part.tasks:
            task.forget()  # A handle refers to its task, to wake it.
        self.part.tasks.clear()
        self.part.on_seed.clear()
        self.part.owned.clear()


def reseed(engine: Engine, residents: Iterable[Resident], seed: int) -> None:
    """Sets the seed for all noise, and draws random constants again."""
    engine.seed = seed
    for resident in residents:
        for draw in resident.part.on_seed:
            draw()


def world_resident(engine: Engine) -> Resident:
    """The world's own resident: no links, but plugins and their handles."""
    nothing = RobotDescription(
        name="", links=(), static=True, canonical_link="", origin=Origin(file=engine.world.name)
    )
    entry = ModelEntry(name="", description=nothing, pose=Pose())
    return Resident(entry, Part(engine, entry))
