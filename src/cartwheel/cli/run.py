"""``cartwheel run``: a robot in a world."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from cartwheel.cli import arguments
from cartwheel.cli.control import parse_speed


def add_to(app: typer.Typer) -> None:
    """Adds the command."""
    app.command()(run)


def run(
    *,
    words: arguments.Names = None,
    world: Annotated[
        str | None, typer.Option(metavar="FILE|NAME", help="A world's file, or a shipped one.")
    ] = None,
    headless: arguments.Headless = False,
    speed: Annotated[
        str, typer.Option(metavar="FACTOR|max", help="1 is real time; max as fast as it can.")
    ] = "1",
    seconds: Annotated[
        float | None, typer.Option("--for", metavar="SECONDS", help="Of simulated time, then end.")
    ] = None,
    paused: arguments.Paused = False,
    seed: Annotated[int, typer.Option(min=0, help="Of all noise.")] = 0,
    strict: Annotated[bool, typer.Option("--strict", help="Make every warning an error.")] = False,
    host: arguments.Host = "127.0.0.1",
    allow_origin: arguments.AllowOrigin = None,
    port: arguments.Port = 8080,
    open_browser: arguments.OpenBrowser = None,
    x: arguments.X = None,
    y: arguments.Y = None,
    z: arguments.Z = None,
    roll: arguments.Roll = None,
    pitch: arguments.Pitch = None,
    yaw: arguments.Yaw = None,
    model: arguments.Model = None,
    package_path: arguments.PackagePath = None,
    allow_path: arguments.AllowPath = None,
    controllers: Annotated[
        list[Path] | None,
        typer.Option(
            "--controllers",
            metavar="FILE",
            help="YAML of ros_control or ros2_control, whose controllers start; may be repeated.",
        ),
    ] = None,
    bridge: Annotated[
        list[Path] | None,
        typer.Option(
            "--bridge",
            metavar="FILE",
            help="YAML of ros_gz_bridge, whose names topics have; may be repeated.",
        ),
    ] = None,
    ros1: Annotated[
        bool,
        typer.Option("--ros1", help="Be a node of ROS 1, with Gazebo's topics and services."),
    ] = False,
    ros1_node: Annotated[
        str, typer.Option("--ros1-node", metavar="NAME", help="Its name; also __name:=NAME.")
    ] = "gazebo",
    ros2: Annotated[
        bool,
        typer.Option("--ros2", help="Be a node of ROS 2, with Gazebo's topics and services."),
    ] = False,
    ros2_node: Annotated[
        str, typer.Option("--ros2-node", metavar="NAME", help="Its name.")
    ] = "gazebo",
    rmw: Annotated[
        str, typer.Option("--rmw", metavar="dds|zenoh", help="Which middleware ROS 2 uses.")
    ] = "dds",
    record: Annotated[
        list[Path] | None,
        typer.Option(
            "--record",
            metavar="FILE",
            help="Record: .mcap, .bag, .db3 or a folder. May be given again.",
        ),
    ] = None,
    record_topics: Annotated[
        list[str] | None,
        typer.Option(
            "--record-topics",
            metavar="PATTERN",
            help="What to record: /camera/*, re:EXPRESSION, !PATTERN to leave out. May be"
            " given again; all topics without it, images too.",
        ),
    ] = None,
    record_encoding: Annotated[
        str | None,
        typer.Option("--record-encoding", metavar="ros1|ros2", help="Of a .mcap's messages."),
    ] = None,
    overwrite: Annotated[
        bool, typer.Option("--overwrite", help="Replace a recording of that name.")
    ] = False,
    foxglove: Annotated[
        bool, typer.Option("--foxglove", help="Serve Foxglove and Lichtblick, on --host.")
    ] = False,
    foxglove_port: Annotated[
        int, typer.Option("--foxglove-port", min=0, max=65535, help="0 takes any.")
    ] = 8765,
    verbose: Annotated[
        bool, typer.Option("--verbose", help="Also say what is merely worth knowing.")
    ] = False,
) -> None:
    """Simulate a robot: FILE is a xacro, URDF or SDF; the shipped cart where none is given.

    FILE may also be a world, which then stands alone. NAME:=VALUE sets an argument of the
    xacro file; world:=FILE is the same as --world. With --ros1, what ROS's nodes take is
    taken as well: __name:=NAME, _PARAMETER:=VALUE, /TOPIC:=OTHER, and TOPIC:=OTHER beside a
    world.
    """
    from cartwheel.cli.commands.options import Options
    from cartwheel.cli.commands.run import simulate

    ros1_arguments: list[str] = []
    if ros1:
        words, ros1_arguments = arguments.split_ros1(words)
    file, values = arguments.split(words)
    simulate(
        Options(
            file=file,
            values=values,
            world=world,
            headless=headless,
            speed=parse_speed(speed),
            seconds=seconds,
            paused=paused,
            seed=seed,
            strict=strict,
            host=host,
            allow_origin=tuple(allow_origin or ()),
            port=port,
            open_browser=open_browser,
            place=arguments.place(x=x, y=y, z=z, roll=roll, pitch=pitch, yaw=yaw),
            model=model,
            package_path=tuple(package_path or ()),
            allow_path=tuple(allow_path or ()),
            controllers=tuple(controllers or ()),
            bridge=tuple(bridge or ()),
            ros1_node=ros1_node if ros1 else None,
            ros2_node=ros2_node if ros2 else None,
            rmw=arguments.rmw(rmw),
            ros1_arguments=tuple(ros1_arguments),
            record=tuple(record or ()),
            record_topics=tuple(word for text in record_topics or () for word in text.split()),
            record_encoding=record_encoding,
            overwrite=overwrite,
            foxglove_port=foxglove_port if foxglove else None,
            verbose=verbose,
        )
    )
