"""Runs cases in this process."""

from __future__ import annotations

import contextlib
import json
import os
import sys
import time
from collections import OrderedDict
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal

from cartwheel.codes.command import LAUNCH_NOT_ALLOWED
from cartwheel.errors import CartwheelError, fault
from cartwheel.scenarios.cases import Case, Scenario, place_of, resolved
from cartwheel.scenarios.outcome import Finding, Outcome
from cartwheel.scenarios.steps import Steps, spawn_options
from cartwheel.scenarios.trial import Trial
from cartwheel.testing.launching import Launched, ros2_domain, ros_master

if TYPE_CHECKING:
    from cartwheel.api import Built, World
    from cartwheel.geometry import Pose

Kept = Literal["failures", "all", "none"]
_MOST_BUILT = 8
"""Maximum number of built worlds that a process keeps."""
PATIENCE = 30.0
"""Wall time for which a case that is shown waits for a browser, s."""
_LARGE = ("Image", "CompressedImage", "PointCloud", "PointCloud2")
"""Messages that recordings omit by default."""
_POSE = ("x", "y", "z", "roll", "pitch", "yaw")
_LOCKSTEP = ("period", "wall_timeout", "start_timeout")


@dataclass(frozen=True, kw_only=True)
class Options:
    """How cases are run."""

    folder: Path
    """Receives pictures and recordings."""
    package_path: tuple[Path, ...] = ()
    plugins: tuple[Path, ...] = ()
    """Python files that define plugins, for all scenarios."""
    record: Kept = "failures"
    pictures: Kept = "failures"
    allow_launch: bool = False
    view: bool = False
    """Show the case in the web interface, in real time."""


class Runner:
    """Runs cases one after the other. Worlds are built once.

    Args:
        scenarios: All scenarios; a case names one by its index.
        options: How cases are run.
        worker: Number of this process among those that run at the same time.
        announce: Receives the address of the web interface.
    """

    def __init__(
        self,
        scenarios: Sequence[Scenario],
        options: Options,
        *,
        worker: int = 0,
        announce: Callable[[str], None] = lambda _: None,
    ) -> None:
        self._scenarios, self._options, self._worker = scenarios, options, worker
        self._announce = announce
        self._built: OrderedDict[str, Built] = OrderedDict()
        self._fixed: dict[str, frozenset[int]] = {}
        """The robots of a scenario that are fixed to the world, by their files."""

    def run(self, case: Case) -> Outcome:
        """Runs a case."""
        scenario = self._scenarios[case.scenario]
        wall, cpu = time.perf_counter(), time.process_time()
        options = self._options
        value = resolved(scenario, case)
        repeatable = not (value.get("lockstep") or value.get("launch"))
        first = options.record == "all" or (options.record == "failures" and not repeatable)
        outcome = self._attempt(
            case, value, record=first, picture=options.pictures == "all" or not repeatable
        )
        failed = outcome.status != "passed"
        wanted = options.record != "none" or options.pictures != "none"
        if failed and repeatable and wanted and not options.view:
            # A case is the same in each run, so only those that fail are recorded, in a second run.
            again = self._attempt(
                case,
                value,
                record=options.record != "none",
                picture=options.pictures != "none",
            )
            outcome.recording, outcome.picture = again.recording, again.picture
        if not failed:
            self._remove(outcome)
        outcome.wall = time.perf_counter() - wall
        outcome.cpu = time.process_time() - cpu
        return outcome

    def _remove(self, outcome: Outcome) -> None:
        """Removes files of a case that passed."""
        if outcome.recording and self._options.record == "failures":
            (self._options.folder / outcome.recording).unlink(missing_ok=True)
            outcome.recording = ""
        if outcome.picture and self._options.pictures == "failures":
            (self._options.folder / outcome.picture).unlink(missing_ok=True)
            outcome.picture = ""

    def _attempt(
        self, case: Case, value: Mapping[str, Any], *, record: bool, picture: bool
    ) -> Outcome:
        scenario = self._scenarios[case.scenario]
        outcome = Outcome(
            id=case.id, scenario=scenario.name, file=str(scenario.file), digest=case.digest,
            parameters=dict(case.parameters), seed=case.seed,
        )  # fmt: skip
        try:
            with contextlib.ExitStack() as stack:
                self._run(stack, case, value, outcome, record=record, picture=picture)
        except CartwheelError as error:
            self._failed(outcome, scenario, error)
        except Exception as error:  # noqa: BLE001 - other cases must still run
            found = fault("unexpected error in Cartwheel", error)
            outcome.diagnostics.append(found.details)
            self._failed(outcome, scenario, CartwheelError(found.message))
        return outcome

    def _failed(self, outcome: Outcome, scenario: Scenario, error: CartwheelError) -> None:
        outcome.status = "error"
        origin = error.origin or scenario.document.origin()
        outcome.findings.append(
            Finding(
                kind="error", expected="", actual=error.message, file=origin.file,
                line=origin.line, time=None, code=error.code.number, hint=error.hint or "",
                values=dict(error.values),
            )
        )  # fmt: skip

    def _run(
        self,
        stack: contextlib.ExitStack,
        case: Case,
        value: Mapping[str, Any],
        outcome: Outcome,
        *,
        record: bool,
        picture: bool,
    ) -> None:
        scenario, options = self._scenarios[case.scenario], self._options
        lock, launch = value.get("lockstep"), value.get("launch")
        connections: dict[str, Any] = {}
        if lock:
            connections = {name: lock[name] for name in ("ros1", "ros2", "rmw") if name in lock}
        if launch:
            if not options.allow_launch:
                raise CartwheelError(
                    f'the scenario starts the program "{launch["command"][0]}"',
                    code=LAUNCH_NOT_ALLOWED,
                    origin=scenario.document.origin(("launch", "command")),
                    hint="If you trust the scenario, add --allow-launch.",
                    values={"command": launch["command"][0]},
                )
            own = self._own_network(stack, launch, connections)
            stack.enter_context(_environment(own))
        if value.get("plugins") and not options.allow_launch:
            raise CartwheelError(
                f'the scenario executes the plugin file "{value["plugins"][0]}"',
                code=LAUNCH_NOT_ALLOWED,
                origin=scenario.document.origin(("plugins",)),
                hint="If you trust the scenario, add --allow-launch.",
                values={"command": value["plugins"][0]},
            )
        world = stack.enter_context(
            self._build(scenario, value).world(seed=case.seed, **connections)
        )
        _place(world, value)
        if options.view:
            self._show(world)
        program = None
        if launch:
            command = [str(place_of(scenario, launch["command"][0])), *launch["command"][1:]]
            environment = {name: str(each) for name, each in launch.get("environment", {}).items()}
            program = stack.enter_context(Launched(command, scenario.file.parent, environment))
        advance = None
        lockstep = None
        if lock:
            from cartwheel.api.exchange.lockstep import Lockstep

            more = {name: lock[name] for name in _LOCKSTEP if name in lock}
            lockstep = Lockstep(
                world, lock["commands"], check=program.check if program else lambda: None, **more
            )
            stack.callback(lockstep.close)
            advance = lockstep.advance
        if record:
            outcome.recording = self._file(case, ".mcap")
            patterns = value.get("record") or _small_topics(world)
            stack.enter_context(
                world.record(options.folder / outcome.recording, topics=patterns, overwrite=True)
            )
        try:
            if lockstep is not None:
                try:
                    lockstep.start()
                except CartwheelError as error:
                    error.origin = error.origin or scenario.document.origin(("lockstep",))
                    raise
            trial = Trial(world, scenario.document, value, outcome, advance=advance)
            trial.run(Steps(lambda name: place_of(scenario, name)).perform)
        finally:
            outcome.diagnostics += [
                each.text for each in world.diagnostics if each.severity != "info"
            ]
            if program is not None:
                outcome.output = program.output
        if lockstep is not None:
            outcome.late = lockstep.late
            if lockstep.late and lock and lock.get("late") == "fail" and lockstep.missing:
                origin = scenario.document.origin(("lockstep",))
                outcome.status = "failed"
                outcome.findings.append(
                    Finding(
                        kind="lockstep", file=origin.file, line=origin.line,
                        expected=f"a message on {', '.join(lockstep.missing)} in each period",
                        actual=f"it was late in {lockstep.late} periods",
                        time=min(lockstep.missing.values()), values={"late": lockstep.late},
                    )
                )  # fmt: skip
        if picture and (options.pictures == "all" or outcome.status != "passed"):
            outcome.picture = self._picture(world, case)

    def _show(self, world: World) -> None:
        """Shows the case in real time, from the beginning if somebody opens the page."""
        self._announce(world.show())
        world.pace = 1.0
        if sys.stderr.isatty():
            world.wait_for_browser(PATIENCE)

    def _own_network(
        self, stack: contextlib.ExitStack, launch: Mapping[str, Any], connections: Mapping[str, Any]
    ) -> dict[str, str]:
        """Environment variables for a ROS network of the case's own."""
        environment: dict[str, str] = {}
        if launch.get("master", bool(connections.get("ros1"))):
            self._options.folder.mkdir(parents=True, exist_ok=True)
            environment |= stack.enter_context(ros_master(self._options.folder))
        if connections.get("ros2"):
            environment |= ros2_domain(self._worker)
        return environment

    def _build(self, scenario: Scenario, value: Mapping[str, Any]) -> Built:
        """The built world of a case. Movable robots are placed later, so that cases that differ
        only in the poses of these robots share it.
        """
        from cartwheel.api import build

        world, robots = value.get("world", "empty"), value.get("robots", ())
        # Those of the command line are the same for all cases.
        plugins = value.get("plugins", ())
        named = [each["robot"] for each in robots]
        files = json.dumps([str(scenario.file), world, named, list(plugins)])

        def built(fixed: frozenset[int]) -> Built:
            given = [
                {name: each for name, each in robot.items() if index in fixed or name not in _POSE}
                for index, robot in enumerate(robots)
            ]
            key = json.dumps([files, given], sort_keys=True, default=str)
            if key not in self._built:
                self._built[key] = build(
                    place_of(scenario, world),
                    [_spawned(scenario, robot) for robot in given],
                    package_path=self._options.package_path,
                    plugins=[
                        *self._options.plugins,
                        *(place_of(scenario, each) for each in plugins),
                    ],
                    lenient=True,
                )
                while len(self._built) > _MOST_BUILT:
                    self._built.popitem(last=False)
            self._built.move_to_end(key)
            return self._built[key]

        if files not in self._fixed:
            made = built(frozenset())
            with made._world(watched=False) as probe:
                names = made.models[len(made.models) - len(robots) :]
                moves = probe.session.simulation.moves
                self._fixed[files] = frozenset(
                    index for index, name in enumerate(names) if not moves(name)
                )
        return built(self._fixed[files])

    def _picture(self, world: World, case: Case) -> str:
        try:
            picture = world.picture(480, 360)
        except CartwheelError:
            return ""  # without OpenGL
        name = self._file(case, ".jpg")
        picture.save(self._options.folder / name)
        return name

    def _file(self, case: Case, suffix: str) -> str:
        (self._options.folder / "files").mkdir(parents=True, exist_ok=True)
        plain = "".join(c if c.isalnum() or c in "-_=." else "_" for c in case.id)[:80]
        return f"files/{plain}-{case.digest[:8]}{suffix}"


def _spawned(scenario: Scenario, robot: Mapping[str, Any]) -> dict[str, Any]:
    options = spawn_options(robot)
    controllers = robot.get("controllers")
    if controllers is not None:
        files = [controllers] if isinstance(controllers, str) else controllers
        found = [each if each == "auto" else place_of(scenario, each) for each in files]
        options["controllers"] = found[0] if len(found) == 1 else found
    return {"robot": place_of(scenario, robot["robot"]), **options}


def _place(world: World, value: Mapping[str, Any]) -> None:
    """Moves the robots that can move to their poses."""
    robots = value.get("robots", ())
    names = world.models[len(world.models) - len(robots) :]
    for name, robot in zip(names, robots, strict=True):
        if any(key in robot for key in _POSE) and world.session.simulation.moves(name):
            world.model(name).pose = _pose(robot)


def _pose(robot: Mapping[str, Any]) -> Pose:
    from cartwheel.geometry import Pose

    x, y, z, roll, pitch, yaw = (float(robot.get(key, 0.0)) for key in _POSE)
    return Pose.from_xyz_rpy((x, y, z), (roll, pitch, yaw))


def _small_topics(world: World) -> list[str]:
    """Patterns that exclude topics with large messages."""
    return [
        f"!{topic.name}"
        for topic in world.graph.topics()
        if topic.type.rpartition("/")[2] in _LARGE
    ]


@contextlib.contextmanager
def _environment(values: Mapping[str, str]) -> Iterator[None]:
    """Sets environment variables within the block, for bridges and launched programs."""
    before = {name: os.environ.get(name) for name in values}
    os.environ.update(values)
    try:
        yield
    finally:
        for name, value in before.items():
            if value is None:
                os.environ.pop(name, None)
            else:
                os.environ[name] = value
