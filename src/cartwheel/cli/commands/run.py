"""Runs a simulation."""

from __future__ import annotations

import contextlib
import gc
import time
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from cartwheel.cli import interrupts
from cartwheel.cli.commands.bridges import Bridges, bridges_for
from cartwheel.cli.commands.options import Options
from cartwheel.cli.commands.ports import refuse_taken
from cartwheel.cli.commands.recording import check_recording, recorded
from cartwheel.cli.commands.report import Report, world_title
from cartwheel.codes.command import OPTION_INVALID, OPTIONS_CONFLICT
from cartwheel.control import running
from cartwheel.description.reach import run_folders
from cartwheel.errors import CartwheelError
from cartwheel.gate.access import Access

if TYPE_CHECKING:
    from cartwheel.bridges.apart.process import BridgeProcess
    from cartwheel.cli.commands.page import Page
    from cartwheel.control.server import ControlServer
    from cartwheel.description.model import RobotDescription, WorldDescription
    from cartwheel.gazebo.robot_descriptions import RobotDescriptions
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
    if options.record:
        check_recording(options)
    if options.foxglove_port is not None:
        from cartwheel.bridges.foxglove.bridge import require

        require()
    # What is loaded stays: looking through it for garbage costs a tenth of the start, and of
    # the speed later where a reader keeps many messages.
    gc.disable()
    access = Access.of(options.host, options.allow_origin)
    with bridges_for(options) as bridges:
        _simulate(options, access, bridges)


def _simulate(options: Options, access: Access, bridges: Bridges) -> None:
    others = running()
    report = Report(verbose=options.verbose)
    world, robot, remappings = _read(options)
    if not options.headless:
        refuse_taken(options.host, options.port)
    # The engine is imported only after the files have been checked.
    from cartwheel.control.place import placed
    from cartwheel.control.server import ControlServer
    from cartwheel.session import Session

    session = Session(
        world,
        seed=options.seed,
        strict=options.strict,
        lenient=not options.strict,
        bridge=options.bridge,
        allow_path=(*options.allow_path, *run_folders(_files(world, robot))),
    )
    session.simulation.tolerant = not options.strict
    name = None
    if robot is None and options.controllers:
        raise CartwheelError(
            "--controllers requires a robot, but the file describes a world",
            code=OPTIONS_CONFLICT,
            hint="Pass a robot file.",
            values={"option": "--controllers"},
        )
    if robot is not None:
        pose = placed(robot.pose, options.place)
        name = session.spawn(robot, name=options.model, pose=pose, controllers=options.controllers)
    session.report_unbridged()
    where = world_title(world)
    title = f"{name} in {where}" if name else where
    # Ctrl-C is how an endless run is meant to end, so it is no failure; a run that was to
    # last a certain time has failed when it is ended before.
    endless = options.seconds is None and options.steps is None
    # From the time at which other processes can see the simulation.
    with interrupts.handled_by(session.simulation.stop, status=0 if endless else None):
        ros = options.ros1_node is not None
        server = ControlServer(session, title=title, load=_load_robot, ros=ros)
        with interrupts.finally_do(server.close):
            pacer = _pacer(session, options)
            page = _page(session, server, pacer, options, report, access=access)
            if others:
                report.others(others)
            report.loaded(session, name, ros=ros)
            with (
                _joined_to_ros1(
                    session, bridges.ros1, server, options, report, remappings=remappings
                ),
                _described(session, options) as descriptions,
                _joined_to_ros2(session, bridges.ros2, options, descriptions, report),
                _shown_by_foxglove(session, bridges.foxglove, options, access, report),
                recorded(session, bridges.recorders, options, report),
            ):
                _run(session, pacer, page, report)


def _files(*descriptions: WorldDescription | RobotDescription | None) -> Iterator[str]:
    """The files of a simulation."""
    for each in descriptions:
        if each is not None and not each.origin.file.startswith("<"):
            yield each.origin.file


@contextlib.contextmanager
def _joined_to_ros1(
    session: Session,
    process: BridgeProcess | None,
    server: ControlServer,
    options: Options,
    report: Report,
    *,
    remappings: Sequence[str],
) -> Iterator[None]:
    if process is None or options.ros1_node is None:
        yield
        return
    from cartwheel.cli.commands.ros1 import Ros1

    ros1 = Ros1(
        session,
        process,
        node=options.ros1_node,
        arguments=(*options.ros1_arguments, *remappings),
        package_path=options.package_path,
        report=report,
    )
    with interrupts.finally_do(ros1.close):
        ros1.start()
        server.announce_ros(ros1.master_uri)
        yield


@contextlib.contextmanager
def _joined_to_ros2(
    session: Session,
    process: BridgeProcess | None,
    options: Options,
    descriptions: RobotDescriptions | None,
    report: Report,
) -> Iterator[None]:
    if process is None or options.ros2_node is None or descriptions is None:
        yield
        return
    from cartwheel.cli.commands.ros2 import Ros2

    ros2 = Ros2(
        session,
        process,
        node=options.ros2_node,
        rmw=options.rmw,
        package_path=options.package_path,
        descriptions=descriptions,
        report=report,
    )
    with interrupts.finally_do(ros2.close):
        ros2.start()
        yield


@contextlib.contextmanager
def _shown_by_foxglove(
    session: Session,
    process: BridgeProcess | None,
    options: Options,
    access: Access,
    report: Report,
) -> Iterator[None]:
    if process is None or options.foxglove_port is None:
        yield
        return
    from cartwheel.cli.commands.foxglove import shown_by_foxglove

    with shown_by_foxglove(session, process, options, access, report):
        yield


@contextlib.contextmanager
def _described(session: Session, options: Options) -> Iterator[RobotDescriptions | None]:
    """Publishes what the robots are, and where their links, where somebody shows them elsewhere."""
    if not options.record and options.foxglove_port is None and options.ros2_node is None:
        yield None
        return
    from cartwheel.gazebo.robot_descriptions import RobotDescriptions

    descriptions = RobotDescriptions(session.simulation, session.graph)
    if options.ros1_node is None and options.ros2_node is None:
        # In ROS that may be another node's, so it is for those who are a part of it to say.
        from cartwheel.gazebo.robot_states import RobotStates

        RobotStates(session.simulation, session.graph, descriptions)
    yield descriptions


def _read(
    options: Options,
) -> tuple[WorldDescription, RobotDescription | None, tuple[str, ...]]:
    """The world, the robot if there is one, and ROS's remappings among the arguments."""
    from cartwheel.description import load, load_world
    from cartwheel.description.model import WorldDescription

    values = dict(options.values)
    # As in a launch file: world:=arena.world.
    named = options.world or values.pop("world", None)
    file = options.file or ROBOT
    found = load(file, arguments=values, package_path=options.package_path)
    if isinstance(found, WorldDescription):
        if named:
            raise CartwheelError(
                f'two worlds are specified: "{file}" and "{named}"',
                code=OPTIONS_CONFLICT,
                values={"file": str(file), "world": str(named)},
            )
        if options.place or options.model:
            raise CartwheelError(
                f'"{file}" is a world, so options for the name and pose of a robot do not apply',
                code=OPTIONS_CONFLICT,
                hint="Pass a robot file, and the world with --world.",
                values={"file": str(file)},
            )
        remappings: tuple[str, ...] = ()
        if options.ros1_node is not None and values:
            # Without a xacro, they cannot be xacro arguments.
            remappings = tuple(f"{name}:={value}" for name, value in values.items())
            found = load_world(file, package_path=options.package_path)
        return found, None, remappings
    fallback = WORLD if options.file is None else "empty"
    return load_world(named or fallback, package_path=options.package_path), found, ()


def _load_robot(
    path: Path, values: Mapping[str, str], package_path: Sequence[Path]
) -> RobotDescription:
    from cartwheel.description import load_robot

    return load_robot(path, arguments=values, package_path=package_path)


def _pacer(session: Session, options: Options) -> Pacer:
    simulation = session.simulation
    simulation.set_speed(options.speed)
    if options.paused:
        simulation.pause()
    until = None if options.seconds is None else round(options.seconds * 1e9)
    if options.steps is not None:
        until = options.steps * simulation.step_ns
    return session.pacer(until_ns=until)


def _page(
    session: Session,
    server: ControlServer,
    pacer: Pacer,
    options: Options,
    report: Report,
    *,
    access: Access,
) -> Page | None:
    """The web viewer of the run; None if it is started on request."""
    if options.headless:
        from cartwheel.cli.commands.page_on_demand import PageOnDemand

        PageOnDemand(session, server, pacer, report, access=access, port=options.port)
        return None
    from cartwheel.cli.commands.page import Page

    return Page(
        session,
        server,
        report,
        access=access,
        port=options.port,
        open_browser=options.open_browser,
    )


def _run(session: Session, pacer: Pacer, page: Page | None, report: Report) -> None:
    gc.freeze()
    gc.enable()
    began = time.perf_counter()
    if page is not None:
        page.start(pacer)
    pacer.run()
    report.ended(session, time.perf_counter() - began)
    if page is not None:
        page.raise_failure()
    until = pacer.until_ns
    if until is not None and session.simulation.time_ns < until:
        raise interrupts.Interrupted(interrupts.last_signal())
