"""Controllers loaded, started, run and unloaded: what ros_control calls a controller manager."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from cartwheel.codes import devices, running
from cartwheel.errors import CartwheelError, GraphError, Origin
from cartwheel.plugins.control.catalogue import find_type
from cartwheel.plugins.control.chaining import Reference, owners
from cartwheel.plugins.control.controller import Controller, Rig
from cartwheel.plugins.control.files import ControllerEntry
from cartwheel.plugins.control.settings import Settings


class ControllerManager:
    """The controllers of one robot; for the simulation's thread alone.

    Args:
        rig: The robot.
    """

    def __init__(self, rig: Rig) -> None:
        self.rig = rig
        self._controllers: dict[str, Controller] = {}
        self._order: list[Controller] = []
        """As they are updated: those that command others first."""
        self._begun: set[str] = set()
        """Controllers that were started once."""
        self._starting: list[Controller] = []
        self._stopping: list[Controller] = []
        self._last_ns: int | None = None
        self.writes = True
        """Whether each update brings the commands to the joints; else `write` does."""

    @property
    def controllers(self) -> list[Controller]:
        """All that are loaded, in that order."""
        return list(self._controllers.values())

    def find(self, name: str) -> Controller | None:
        """The controller of that name, if it is loaded."""
        return self._controllers.get(name)

    def state(self, controller: Controller) -> str:
        """``initialized``, ``running`` or ``stopped``."""
        if controller.running:
            return "running"
        return "stopped" if controller.name in self._begun else "initialized"

    def load(self, name: str, settings: Settings, type_name: str) -> Controller:
        """Makes a controller.

        Raises:
            CartwheelError: It is loaded already, there is no such type, or its parameters or
                joints do not fit; nothing has changed.
        """
        if name in self._controllers:
            raise wrong_state(name, "is already loaded")
        family = find_type(type_name, ros2=self.rig.ros2)
        made = family(name, type_name.strip().replace("::", "/"), settings, self.rig)
        settings.ignore("type")
        unread = settings.unread()
        if unread:
            self.rig.report(
                devices.CONTROLLER_PARAMETER_UNKNOWN,
                f'controller "{name}" does not read these parameters: {", ".join(unread)}',
                at=Origin(file=settings.source) if settings.source else None,
                values={"controller": name, "parameters": tuple(unread)},
            )
        self._controllers[name] = made
        self._sort()
        return made

    def load_entry(self, entry: ControllerEntry) -> Controller:
        """Makes a controller as its file describes it; see `load`."""
        self.rig.remappings[entry.name] = entry.remappings
        return self.load(entry.name, entry.settings(), entry.type)

    def unload(self, name: str) -> None:
        """Takes a controller away that does not run.

        Raises:
            GraphError: There is none of that name, or it runs.
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
        """Stops some controllers and starts others, at the next time of control.

        Args:
            start: Names.
            stop: Names.
            strict: All of it or nothing; else what is possible.

        Raises:
            GraphError: A name is not loaded, is running or not running already, or commands a
                joint that another one does; while strict.
        """
        stopping = [each for name in stop if (each := self._one(name, True, strict))]
        for name in self.with_leaders(stop)[len(stop) :]:
            led = [each for each in self._led(name) if each in stop]
            if led:
                problem = f'controller "{led[0]}" cannot stop because "{name}" commands it'
                self._refuse(led[0], problem, strict)
            stopping = [each for each in stopping if each.name not in led]
        starting = [each for name in start if (each := self._one(name, False, strict))]
        # What is stopped and started at once begins anew.
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
            problem = self._hindrance(controller, starting, stopping, held)
            if problem:
                self._refuse(controller.name, problem, strict)
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
        """Some controllers and all that run and command one of them: what must stop with them."""
        found = list(names)
        for each in reversed(self._order):
            led = self._led(each.name)
            if each.running and each.name not in found and any(name in found for name in led):
                found.append(each.name)
        return found

    def update(self, time_ns: int, nominal: float) -> None:
        """Starts, stops and updates controllers, and commands the joints.

        Args:
            time_ns: Simulation time.
            nominal: Of control, s: what the first update counts for.
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
        """Brings the commands to the joints, between updates as well.

        Args:
            time_ns: Simulation time.
            seconds: Since the last time, s.
        """
        if self._last_ns is not None:
            self.rig.hardware.write(seconds, lead=(time_ns - self._last_ns) / 1e9)

    def sense(self, time_ns: int) -> None:
        """Lets controllers tell what only a settled state shows: accelerations and forces."""
        for controller in self._controllers.values():
            if controller.started:
                controller.sense(time_ns)

    @property
    def senses(self) -> bool:
        """Whether `sense` has anything to do."""
        return any(each.running and each.senses for each in self._controllers.values())

    def reset(self) -> None:
        """Everything stands where it was spawned: running controllers begin anew."""
        self._last_ns = None
        self._stopping.clear()
        self._starting = [each for each in self._controllers.values() if each.running]
        for controller in self._starting:
            controller.started = False

    def close(self) -> None:
        """Unloads everything."""
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
        """The controllers that one commands."""
        return owners(self._controllers[name].claims.values())

    def _hindrance(
        self,
        controller: Controller,
        starting: Sequence[Controller],
        stopping: Sequence[Controller],
        held: Mapping[str, str],
    ) -> str:
        """Why a controller cannot start; nothing where it can.

        Args:
            controller: That shall start.
            starting: What starts as well.
            stopping: What stops.
            held: Joints that are commanded, and by whom.
        """
        for name, claim in controller.claims.items():
            if name in held:
                why = f'joint "{name}" is commanded by "{held[name]}"'
            elif isinstance(claim, Reference) and not self._offered(claim, starting, stopping):
                why = f'it commands "{claim.owner}", which is not running'
            else:
                continue
            return f'controller "{controller.name}" cannot start: {why}'
        return ""

    def _offered(
        self, claim: Reference, starting: Sequence[Controller], stopping: Sequence[Controller]
    ) -> bool:
        """Whether its controller runs then, and was not loaded anew since it was claimed."""
        owner = self._controllers.get(claim.owner)
        if owner is None or not any(each is claim for each in owner.references):
            return False
        return owner in starting or (owner.running and owner not in stopping)

    def _refuse(self, name: str, message: str, strict: bool) -> None:
        """Raises the conflict of a controller while strict; else reports it."""
        values = {"controller": name}
        if strict:
            raise GraphError(message, code=running.CONTROLLER_CONFLICT, values=values)
        self.rig.report(running.CONTROLLER_CONFLICT, message, values=values)

    def _one(self, name: str, runs: bool, strict: bool) -> Controller | None:
        """A controller that is to change its state; None where it cannot and need not."""
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


def wrong_state(name: str, problem: str, *, hint: str = "") -> GraphError:
    """The error for a request that does not fit the state of a controller.

    Args:
        name: The controller.
        problem: Its state, behind its name.
        hint: What to do.
    """
    return GraphError(
        f'controller "{name}" {problem}',
        code=running.CONTROLLER_STATE,
        hint=hint,
        values={"controller": name},
    )


def tell(rig: Rig, error: CartwheelError) -> None:
    """Reports the error of a request that came over a wire."""
    rig.report(
        error.code, error.message, at=error.origin, hint=error.hint or "", values=error.values
    )
