"""A simulation from its files to its end."""

from __future__ import annotations

import gc
import time
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from cartwheel.cli import interrupts
from cartwheel.cli.commands.ports import refuse_taken
from cartwheel.cli.commands.report import Report, world_title
from cartwheel.control import running
from cartwheel.errors import CartwheelError

if TYPE_CHECKING:
    from cartwheel.control.server import ControlServer
    from cartwheel.description.model import RobotDescription, WorldDescription
    from cartwheel.session import Session

ROBOT, WORLD = "rosbots.xacro", "post"
"""What is run where nothing is named."""


@dataclass(frozen=True, kw_only=True, slots=True)
class Options:
    """What the user asked for."""

    file: str | None = None
    values: Mapping[str, str]
    """Of ``name:=value``."""
    world: str | None = None
    headless: bool = False
    speed: float | None = 1.0
    """Real-time factor; None is as fast as it can."""
    seconds: float | None = None
    """Of simulated time; None is endless."""
    paused: bool = False
    seed: int = 0
    strict: bool = False
    host: str = "127.0.0.1"
    port: int = 8080
    open_browser: bool | None = None
    place: Mapping[str, float] | None = None
    """Some of x, y, z, roll, pitch, yaw."""
    model: str | None = None
    package_path: tuple[Path, ...] = ()
    verbose: bool = False


def simulate(options: Options) -> None:
    """Reads, builds, runs, and says so.

    Raises:
        CartwheelError: Whatever is wrong with the files or the options.
    """
    if options.seconds is not None and not 0 < options.seconds < 1e9:
        raise CartwheelError(f"--for {options.seconds:g} is no time to run")
    # What is loaded stays: looking through it for garbage costs a tenth of the start, and of
    # the speed later where a reader keeps many messages.
    gc.disable()
    others = running()
    if not options.headless:
        refuse_taken(options.host, options.port)
    report = Report(verbose=options.verbose)
    world, robot = _read(options)
    # The engine is imported while the files are known to be right, and not before.
    from cartwheel.control.place import placed
    from cartwheel.control.server import ControlServer
    from cartwheel.session import Session

    session = Session(world, seed=options.seed, strict=options.strict)
    name = None
    if robot is not None:
        pose = placed(robot.pose, options.place or {})
        name = session.spawn(robot, name=options.model, pose=pose)
    where = world_title(world)
    title = f"{name} in {where}" if name else where
    server = ControlServer(session, title=title, load=_load_robot)
    with interrupts.finally_do(server.close):
        if others:
            report.others(others)
        report.loaded(session, name)
        _run(session, server, options, report)


def _read(options: Options) -> tuple[WorldDescription, RobotDescription | None]:
    from cartwheel.description import load, load_world
    from cartwheel.description.model import WorldDescription

    values = dict(options.values)
    # As with a launch file: world:=arena.world.
    named = options.world or values.pop("world", None)
    file = options.file or ROBOT
    found = load(file, arguments=values, package_path=options.package_path)
    if isinstance(found, WorldDescription):
        if named:
            raise CartwheelError(f'"{file}" is a world, and so is "{named}"')
        if options.place or options.model:
            raise CartwheelError(
                f'"{file}" is a world, which has no place and no name',
                hint="Name a robot, and the world with --world.",
            )
        return found, None
    fallback = WORLD if options.file is None else "empty"
    return load_world(named or fallback, package_path=options.package_path), found


def _load_robot(
    path: Path, values: Mapping[str, str], package_path: Sequence[Path]
) -> RobotDescription:
    from cartwheel.description import load_robot

    return load_robot(path, arguments=values, package_path=package_path)


def _run(session: Session, server: ControlServer, options: Options, report: Report) -> None:
    simulation = session.simulation
    simulation.set_speed(options.speed)
    if options.paused:
        simulation.pause()
    until = None if options.seconds is None else round(options.seconds * 1e9)
    pacer = session.pacer(until_ns=until)
    page = None
    if not options.headless:
        from cartwheel.cli.commands.page import Page

        page = Page(
            session,
            server,
            report,
            host=options.host,
            port=options.port,
            open_browser=options.open_browser,
        )

    def stop() -> None:
        simulation.stop()
        # Wakes it where it sleeps until the next step.
        simulation.post(lambda: None)

    gc.freeze()
    gc.enable()
    began = time.perf_counter()
    # Ctrl-C is how an endless run is meant to end, so it is no failure; a run that was to
    # last a certain time has failed when it is ended before.
    endless = options.seconds is None
    with interrupts.handled_by(stop, status=0 if endless else None):
        if page is not None:
            page.start(pacer)
        pacer.run()
    report.ended(session, time.perf_counter() - began)
    if page is not None:
        page.raise_failure()
    if not endless and until is not None and simulation.time_ns < until:
        raise interrupts.Interrupted(interrupts.last_signal())
