"""The controller manager, which loads, starts, updates and unloads controllers."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from cartwheel.codes import devices, running
from cartwheel.dialects.ros_control.catalogue import find_type
from cartwheel.dialects.ros_control.chaining import Reference, owners
from cartwheel.dialects.ros_control.controller import Controller, Rig
from cartwheel.dialects.ros_control.files import ControllerEntry
from cartwheel.dialects.ros_control.settings import Settings
from cartwheel.errors import CartwheelError, GraphError, Origin


class ControllerManager:
    """The controllers of one robot. Used only on the thread that owns the simulation.

    Args:
        rig: The robot.
    """

    def __init__(self, rig: Rig) -> None:
        self.rig = rig
        self._controllers: dict[str, Controller] = {}
        self._order: list[Controller] = []
        """Controllers in the order of updates: those that command other controllers first."""
        self._begun: set[str] = set()
        """Names of controllers that have been started before."""
        self._starting: list[Controller] = []
        self._stopping: list[Controller] = []
        self._last_ns: int | None = None
        self.writes = True
        """Whether each update applies the commands to the joints; otherwise `write` does."""

    @property
    def controllers(self) -> list[Controller]:
        """The loaded controllers, in the order of loading."""
        return list(self._controllers.values())

    def find(self, name: str) -> Controller | None:
        """Returns the loaded controller with this name, or None."""
        return self._controllers.get(name)

    def state(self, controller: Controller) -> str:
        """Returns ``initialized``, ``running`` or ``stopped``."""
        if controller.running:
            return "running"
        return "stopped" if controller.name in self._begun else "initialized"

    def load(self, name: str, settings: Settings, type_name: str) -> Controller:
        """Creates a controller.

        Raises:
            CartwheelError: The controller is already loaded, its type does not exist, or its
                parameters or joints are invalid. Nothing has changed.
        """
        if name in self._controllers:
            raise wrong_state(name, "is already loaded")
        family = find_type(type_name, ros2=self.rig.ros2)
        controller = family(name, type_name.strip().replace("::", "/"), settings, self.rig)
        settings.ignore("type")
        unread = settings.unread()
        if unread:
            self.rig.report(
                devices.CONTROLLER_PARAMETER_UNKNOWN,
                f'controller "{name}" ignores unknown parameters: {", ".join(unread)}',
                at=Origin(file=settings.source) if settings.source else None,
                values={"controller": name, "parameters": tuple(unread)},
            )
        self._controllers[name] = controller
        self._sort()
        return controller

    def load_entry(self, entry: ControllerEntry) -> Controller:
        """Creates a controller from a file; see `load`."""
        self.rig.remappings[entry.name] = entry.remappings
        return self.load(entry.name, entry.settings(), entry.type)

    def unload(self, name: str) -> None:
        """Closes a controller that is not running.

        Raises:
            GraphError: The controller is not loaded, or is running.
        """
        controller = self._controllers.get(name)
        if controller is None:
            raise wrong_state(name, "is not loaded")
        if controller.running:
            raise wrong_state(name, "is running", hint="Stop it first.")
        del self._controllers[name]
        self._sort()
        self._begun.discard(name)
        controller.close()

    def switch(self, start: Sequence[str], stop: Sequence[str], *, strict: bool = True) -> None:
        """Stops some controllers and starts others at the next update.

        Args:
            start: Names of the controllers to start.
            stop: Names of the controllers to stop.
            strict: Change nothing if one of them cannot be switched; otherwise switch all that can
                be.

        Raises:
            GraphError: With `strict`, if a controller is not loaded, already is in the requested
                state, or would command a joint of another controller.
        """
        stopping = [each for name in stop if (each := self._one(name, True, strict))]
        for name in self.with_leaders(stop)[len(stop) :]:
            led = [each for each in self._led(name) if each in stop]
            if led:
                problem = f'controller "{led[0]}" cannot stop because "{name}" commands it'
                self._refuse(_conflict(led[0], problem, by=name), strict)
            stopping = [each for each in stopping if each.name not in led]
        starting = [each for name in start if (each := self._one(name, False, strict))]
        # A controller that is both stopped and started is restarted.
        for name in start:
            controller = self._controllers.get(name)
            if controller in stopping and controller not in starting and controller is not None:
                starting.append(controller)
        held = {
            joint: each.name
            for each in self._controllers.values()
            if each.running and each not in stopping
            for joint in each.claims
        }
        able = []
        for controller in starting:
            conflict = self._hindrance(controller, starting, stopping, held)
            if conflict is not None:
                self._refuse(conflict, strict)
                continue
            held.update(dict.fromkeys(controller.claims, controller.name))
            able.append(controller)
        for controller in stopping:
            controller.running = False
            if controller in self._starting:
                self._starting.remove(controller)
            self._stopping.append(controller)
        for controller in able:
            controller.running = True
            self._begun.add(controller.name)
            self._starting.append(controller)

    def with_leaders(self, names: Sequence[str]) -> list[str]:
        """Returns the names, and those of all running controllers that command them.

        These must stop together.
        """
        together = list(names)
        for each in reversed(self._order):
            led = self._led(each.name)
            if each.running and each.name not in together and any(name in together for name in led):
                together.append(each.name)
        return together

    def update(self, time_ns: int, nominal: float) -> None:
        """Starts, stops and updates controllers, and commands the joints.

        Args:
            time_ns: Simulation time.
            nominal: Control period in s, which the first update uses as its duration.
        """
        seconds = nominal if self._last_ns is None else (time_ns - self._last_ns) / 1e9
        if self._last_ns is None:
            self.rig.hardware.start()
        self._last_ns = time_ns
        if self._stopping:
            for controller in self._stopping:
                controller.end(time_ns)
                for joint in controller.claims.values():
                    joint.release()
            self._stopping.clear()
        if self._starting:
            for controller in self._starting:
                for name, joint in controller.claims.items():
                    joint.activate(controller.interfaces[name])
                controller.begin(time_ns)
            self._starting.clear()
        for controller in self._order:
            if controller.running:
                controller.update(time_ns, seconds)
            else:
                controller.idle(time_ns)
        if self.writes:
            self.rig.hardware.write(seconds)

    def write(self, time_ns: int, seconds: float) -> None:
        """Applies the commands to the joints between updates.

        Args:
            time_ns: Simulation time.
            seconds: Time since the last call, s.
        """
        if self._last_ns is not None:
            self.rig.hardware.write(seconds, lead=(time_ns - self._last_ns) / 1e9)

    def sense(self, time_ns: int) -> None:
        """Lets controllers publish quantities that are only known after a step."""
        for controller in self._controllers.values():
            if controller.started:
                controller.sense(time_ns)

    @property
    def senses(self) -> bool:
        """Whether a running controller has such quantities to publish."""
        return any(each.running and each.senses for each in self._controllers.values())

    def reset(self) -> None:
        """Restarts the running controllers after a reset of the simulation."""
        self._last_ns = None
        self._stopping.clear()
        self._starting = [each for each in self._controllers.values() if each.running]
        for controller in self._starting:
            controller.started = False

    def close(self) -> None:
        """Unloads all controllers."""
        for controller in self._controllers.values():
            controller.close()
        self._controllers.clear()
        self._order = []

    def _sort(self) -> None:
        def height(name: str) -> int:
            below = (other for other in self._led(name) if other in self._controllers)
            return 1 + max((height(other) for other in below), default=-1)

        names = sorted(self._controllers, key=height, reverse=True)
        self._order = [self._controllers[name] for name in names]

    def _led(self, name: str) -> list[str]:
        """Returns the names of the controllers that this one commands."""
        return owners(self._controllers[name].claims.values())

    def _hindrance(
        self,
        controller: Controller,
        starting: Sequence[Controller],
        stopping: Sequence[Controller],
        held: Mapping[str, str],
    ) -> GraphError | None:
        """Returns why a controller cannot start; None if it can.

        Args:
            controller: The controller.
            starting: Controllers that start at the same time.
            stopping: Controllers that stop at the same time.
            held: The commanding controller of each commanded joint.
        """
        for name, claim in controller.claims.items():
            if name in held:
                by, why = held[name], f'joint "{name}" is commanded by "{held[name]}"'
            elif isinstance(claim, Reference) and not self._offered(claim, starting, stopping):
                by, why = claim.owner, f'it commands "{claim.owner}", which is not running'
            else:
                continue
            message = f'controller "{controller.name}" cannot start: {why}'
            return _conflict(controller.name, message, by=by)
        return None

    def _offered(
        self, claim: Reference, starting: Sequence[Controller], stopping: Sequence[Controller]
    ) -> bool:
        """Whether the reference's controller will run and was not reloaded since the claim."""
        owner = self._controllers.get(claim.owner)
        if owner is None or not any(each is claim for each in owner.references):
            return False
        return owner in starting or (owner.running and owner not in stopping)

    def _refuse(self, conflict: GraphError, strict: bool) -> None:
        """Raises a conflict if `strict`, otherwise reports it."""
        if strict:
            raise conflict
        report_error(self.rig, conflict)

    def _one(self, name: str, runs: bool, strict: bool) -> Controller | None:
        """Returns a controller whose state is to change; None if it cannot or need not change."""
        controller = self._controllers.get(name)
        problem = ""
        if controller is None:
            problem = "is not loaded"
        elif controller.running != runs:
            if not runs and not strict:
                return None
            problem = "is not running" if runs else "is already running"
        if not problem:
            return controller
        if strict and (controller is None or runs):
            raise wrong_state(name, problem)
        return None


def _conflict(name: str, message: str, *, by: str) -> GraphError:
    return GraphError(
        message, code=running.CONTROLLER_CONFLICT, values={"controller": name, "by": by}
    )


def wrong_state(name: str, problem: str, *, hint: str = "") -> GraphError:
    """Returns the error for a request that does not fit the state of a controller.

    Args:
        name: The controller.
        problem: Its state, as it follows the name in the message.
        hint: What to do.
    """
    return GraphError(
        f'controller "{name}" {problem}',
        code=running.CONTROLLER_STATE,
        hint=hint,
        values={"controller": name},
    )


def report_error(rig: Rig, error: CartwheelError) -> None:
    """Reports the error of a service request."""
    rig.report(
        error.code, error.message, at=error.origin, hint=error.hint or "", values=error.values
    )
