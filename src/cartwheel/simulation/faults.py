"""Errors in plugins, subscribers and posted functions while a simulation advances."""

from __future__ import annotations

from cartwheel.calls import raise_exit
from cartwheel.codes import running
from cartwheel.codes import world as world_codes
from cartwheel.errors import Code, Diagnostic, PluginError, SimulationError, fault
from cartwheel.options import STRICT
from cartwheel.reporting import Once
from cartwheel.simulation.clock import Task
from cartwheel.simulation.engine import Engine
from cartwheel.simulation.models.population import Population
from cartwheel.simulation.models.resident import place, title

_FAULTS = 100
"""Maximum number of reported errors in subscribers and commands."""


class Faults:
    """Attributes each error to its plugin, subscriber or command, and reports or raises it.

    Args:
        engine: Reports the diagnostics.
        population: The models with their plugins.
    """

    def __init__(self, engine: Engine, population: Population) -> None:
        self._engine = engine
        self._population = population
        self.tolerant = False
        """Whether errors in subscribers and posted functions are reported instead of raised."""
        self.strict = False
        """Whether a failing plugin stops `Simulation.advance`."""
        self.ignore: frozenset[Code] = frozenset()
        """Codes with which it does not."""
        self.pending: BaseException | None = None
        """The error that `Simulation.advance` raises after the current step."""
        self._reported = Once(_FAULTS)

    def defer(self, error: BaseException) -> None:
        """Makes `Simulation.advance` raise an error after the current step.

        Time has then advanced, and the next call continues from there. If an error is already
        pending, the new one is discarded.
        """
        if self.pending is None:
            self.pending = error

    def raise_pending(self) -> None:
        """Raises the deferred error, if there is one."""
        if self.pending is not None:
            error, self.pending = self.pending, None
            raise error

    def fail(self, what: str, error: BaseException) -> None:
        """Handles an error in an external function: a subscriber or a posted function.

        It stops `Simulation.advance`. If `tolerant`, it is only reported, and only once.

        Args:
            what: The function, such as "a command", for the message.
            error: The error that it raised.
        """
        raise_exit(error)
        if not self.tolerant:
            self.defer(error)
        elif self._reported.allows(f"{what} {error!r} {getattr(error, 'values', '')}"):
            self._engine.report(fault(f"{what} failed", error, code=world_codes.CALLBACK_FAILED))

    def task_failed(self, task: Task, error: BaseException) -> None:
        """Handles an error in a task: disables the plugin that owns the task.

        Raises:
            DivergedError: The state is no longer finite, which may have caused the error.
        """
        raise_exit(error)
        # Code that reads a diverged state may fail in any way: report the divergence instead.
        self._population.watch.check(self._population.origin_of)
        if isinstance(error, SimulationError):
            # The simulation itself cannot continue; the plugin is not at fault.
            self.defer(error)
        elif task.owner is not None:
            self.disable(task.owner, error)
        else:
            name = getattr(task.after or task.before, "__qualname__", "a task of the simulation")
            task.forget()
            text = f"{name} failed and is disabled"
            self._report(fault(text, error, code=world_codes.CALLBACK_FAILED), error)

    def disable(self, plugin: object, error: BaseException) -> None:
        """Disables a plugin that raised an error, and reports it; the simulation continues.

        Does nothing if the plugin was already disabled or deleted.
        """
        raise_exit(error)
        resident = self._population.owner_of(plugin)
        if resident is None:
            return
        text = f"{title(plugin)} failed and is disabled"
        values = {"plugin": title(plugin)}
        diagnostic = fault(text, error, place(plugin), code=running.PLUGIN_FAILED, values=values)
        resident.end(plugin)
        self._population.gather_tasks()
        self._report(diagnostic, error)

    def _report(self, diagnostic: Diagnostic, cause: BaseException) -> None:
        self._engine.report(diagnostic)
        if self.strict and diagnostic.code not in self.ignore:
            raised = PluginError(
                diagnostic.message,
                code=diagnostic.code,
                origin=diagnostic.origin,
                hint=f"{STRICT.given()} stops the run at the first error.",
                values=diagnostic.values,
            )
            raised.__cause__ = cause
            self.defer(raised)
