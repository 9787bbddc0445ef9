"""Runs a simulation."""

from __future__ import annotations

import contextlib
import gc
import time
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

from cartwheel.assembly.assembly import Assembly
from cartwheel.assembly.names import world_title
from cartwheel.assembly.ports import refuse_taken
from cartwheel.cli import interrupts
from cartwheel.cli.commands.desktop import is_desktop
from cartwheel.cli.commands.options import Options
from cartwheel.cli.commands.report import Report
from cartwheel.codes.command import OPTION_INVALID, OPTIONS_CONFLICT
from cartwheel.control import running
from cartwheel.description.files.readable_files import run_folders
from cartwheel.errors import CartwheelError
from cartwheel.gate.access import Access
from cartwheel.messages.store import finding_with

if TYPE_CHECKING:
    from cartwheel.assembly.launched import Launched
    from cartwheel.assembly.viewer import AnnouncedViewer
    from cartwheel.description.model import RobotDescription, WorldDescription
    from cartwheel.session import Session
    from cartwheel.simulation.pacing import Pacer

ROBOT, WORLD = "rosbots.xacro", "post"
"""The default robot and world."""


def simulate(options: Options) -> None:
    """Reads, builds and runs a simulation, and prints messages.

    Raises:
        CartwheelError: A file or an option is invalid.
    """
    if options.seconds is not None and not 0 < options.seconds < 1e9:
        raise CartwheelError(
            f"--for must be positive and below 1e9 s (got {options.seconds:g})",
            code=OPTION_INVALID,
            values={"option": "--for", "value": options.seconds},
        )
    options.plan.check()
    # What is loaded stays: looking through it for garbage costs a tenth of the start, and of
    # the speed later where a reader keeps many messages.
    gc.disable()
    report = Report(verbose=options.verbose)
    assembly = Assembly(
        access=Access.of(options.host, options.allow_origin),
        package_path=options.package_path,
        observer=report,
        at_end=interrupts.finally_do,
    )
    with assembly:
        assembly.prepare(options.plan.bridges)
        _simulate(options, assembly, report)


def _simulate(options: Options, assembly: Assembly, report: Report) -> None:
    others = running()
    launched, remappings = _read(options)
    world, models = launched.world, launched.models
    if not options.headless:
        refuse_taken(options.host, options.port)
    # The engine is imported only after the files have been checked.
    from cartwheel.assembly.launched import spawn_all
    from cartwheel.session import Session

    session = Session(
        world,
        seed=options.seed,
        strict=options.strict,
        lenient=not options.strict,
        bridge=(*options.bridge, *launched.bridges),
        plugins=options.plugins,
        allow_path=(
            *options.allow_path,
            *run_folders(_files(world, *(each.description for each in models))),
        ),
        package_path=options.package_path,
        without=options.without,
    )
    session.simulation.faults.tolerant = not options.strict
    if not models and options.controllers:
        raise CartwheelError(
            "--controllers requires a robot, but the file describes a world",
            code=OPTIONS_CONFLICT,
            hint="Pass a robot file.",
            values={"option": "--controllers"},
        )
    names = spawn_all(session, launched, options.package_path)
    name = names[0] if names else None
    session.report_unbridged()
    where = world_title(world)
    title = f"{name} in {where}" if name else where
    # Ctrl-C is how an endless run is meant to end, so it is no failure; a run that was to
    # last a certain time has failed when it is ended before.
    endless = options.seconds is None and options.steps is None
    ros = options.plan.ros1 is not None
    # From the time at which other processes can see the simulation.
    with (
        interrupts.handled_by(session.simulation.stop, status=0 if endless else None),
        contextlib.closing(assembly),
    ):
        assembly.attach(session, _pacer(session, options))
        assembly.serve_control(title, ros=ros)
        viewer = _viewer(assembly, options)
        if others:
            report.others(others)
        if launched.file is not None:
            report.launched(launched.file, models=bool(models))
        report.loaded(session, name, ros=ros)
        plan = options.plan
        plan = replace(plan, ros1_arguments=(*plan.ros1_arguments, *remappings))
        plan.connect(assembly, end_ns=assembly.pacer.until_ns)
        _run(assembly, viewer, report)


def _viewer(assembly: Assembly, options: Options) -> AnnouncedViewer | None:
    """The web viewer of the run; None if it is started on request."""
    if options.headless:
        assembly.offer_viewer(options.port, until_exit=True)
        return None
    open_browser = is_desktop() if options.open_browser is None else options.open_browser
    return assembly.add_viewer(options.port, open_browser=open_browser)


def _files(*descriptions: WorldDescription | RobotDescription) -> Iterator[str]:
    """The files of a simulation."""
    for each in descriptions:
        if not each.origin.file.startswith("<"):
            yield each.origin.file


def _refuse_place(options: Options, reason: str) -> None:
    """Raises an error if a robot's name or pose is stated, but there is no robot to spawn."""
    if options.place or options.model:
        raise CartwheelError(
            f"{reason}, so options for the name and pose of a robot do not apply",
            code=OPTIONS_CONFLICT,
            hint="Pass a robot file, and the world with --world.",
            values={"file": str(options.file)},
        )


def _read(options: Options) -> tuple[Launched, tuple[str, ...]]:
    """The world, the models, and ROS's remappings among the arguments."""
    from cartwheel.assembly.launched import Launched, Start, open_launch
    from cartwheel.control.place import placed
    from cartwheel.description import load, load_world
    from cartwheel.description.launches import is_launch_file
    from cartwheel.description.model import WorldDescription

    values, path = dict(options.values), options.package_path
    file = options.file or ROBOT
    automatic = options.controllers == (Path("auto"),)
    if is_launch_file(Path(file)):
        launched = open_launch(Path(file), values, world=options.world, package_path=path)
        if not launched.models:
            _refuse_place(options, f'"{file}" spawns no model')
            return launched, ()
        first, *others = launched.models
        first = replace(first, name=options.model or first.name)
        if options.place:
            first = replace(first, pose=placed(first.pose or first.description.pose, options.place))
        if options.controllers and not automatic:
            first = replace(first, controllers=options.controllers)
        return replace(launched, models=(first, *others)), ()
    # As in a launch file: world:=arena.world.
    named = options.world or values.pop("world", None)
    found = load(file, arguments=values, package_path=path)
    if isinstance(found, WorldDescription):
        if named:
            raise CartwheelError(
                f'two worlds are specified: "{file}" and "{named}"',
                code=OPTIONS_CONFLICT,
                values={"file": str(file), "world": str(named)},
            )
        _refuse_place(options, f'"{file}" is a world')
        remappings: tuple[str, ...] = ()
        if options.plan.ros1 is not None and values:
            # Without a xacro, they cannot be xacro arguments.
            remappings = tuple(f"{name}:={value}" for name, value in values.items())
            found = load_world(file, package_path=path)
        return Launched(world=found), remappings
    fallback = WORLD if options.file is None else "empty"
    robot = Start(
        description=found,
        name=options.model,
        pose=placed(found.pose, options.place),
        controllers="auto" if automatic else options.controllers,
    )
    return Launched(world=load_world(named or fallback, package_path=path), models=(robot,)), ()


def _pacer(session: Session, options: Options) -> Pacer:
    simulation = session.simulation
    simulation.set_speed(options.speed)
    if options.paused:
        simulation.pause()
    until = None if options.seconds is None else round(options.seconds * 1e9)
    if options.steps is not None:
        until = options.steps * simulation.step_ns
    return session.pacer(until_ns=until)


def _run(assembly: Assembly, viewer: AnnouncedViewer | None, report: Report) -> None:
    gc.freeze()
    gc.enable()
    session, pacer = assembly.session, assembly.pacer
    began = time.perf_counter()
    if viewer is not None:
        viewer.start(pacer)
    with finding_with(session.types):
        pacer.run()
    report.ended(session, time.perf_counter() - began)
    if viewer is not None:
        viewer.raise_failure()
    until = pacer.until_ns
    if until is not None and session.simulation.time_ns < until:
        raise interrupts.Interrupted(interrupts.last_signal())
