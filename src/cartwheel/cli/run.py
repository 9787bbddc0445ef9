"""``cartwheel run``: a robot in a world."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from cartwheel.cli import arguments, help
from cartwheel.cli.control import parse_speed


def add_to(app: typer.Typer) -> None:
    """Adds the command."""
    help.add(app, run, group=help.SIMULATE)


def run(
    *,
    words: arguments.RunNames = None,
    world: Annotated[
        str | None,
        typer.Option(
            metavar="FILE|NAME",
            help="World to simulate: an SDF file, or the name of a bundled world.",
            rich_help_panel=help.WORLD,
        ),
    ] = None,
    seed: Annotated[
        int,
        typer.Option(
            min=0,
            metavar="N",
            help="Random seed for sensor noise.",
            rich_help_panel=help.WORLD,
        ),
    ] = 0,
    strict: Annotated[
        bool,
        typer.Option(
            "--strict", help="Treat every warning as an error.", rich_help_panel=help.WORLD
        ),
    ] = False,
    without: Annotated[
        list[str] | None,
        typer.Option(
            "--without",
            metavar="NAME|all",
            help="Omit physics that Cartwheel adds to descriptions, such as chain-drag; "
            "--verbose shows the names. Can be repeated.",
            rich_help_panel=help.WORLD,
        ),
    ] = None,
    x: arguments.X = None,
    y: arguments.Y = None,
    z: arguments.Z = None,
    roll: arguments.Roll = None,
    pitch: arguments.Pitch = None,
    yaw: arguments.Yaw = None,
    model: arguments.Model = None,
    controllers: Annotated[
        list[Path] | None,
        typer.Option(
            "--controllers",
            metavar="FILE",
            help="Start the controllers in this ros_control or ros2_control YAML file. Can be "
            "repeated.",
            rich_help_panel=help.ROBOT,
        ),
    ] = None,
    plugin: Annotated[
        list[Path] | None,
        typer.Option(
            "--plugin",
            metavar="FILE",
            help="Execute this Python file and use the plugins that it defines. Can be repeated.",
            rich_help_panel=help.ROBOT,
        ),
    ] = None,
    speed: Annotated[
        str,
        typer.Option(
            metavar="FACTOR|max",
            help="Real-time factor: 1 is real time, max is as fast as possible.",
            rich_help_panel=help.TIME,
        ),
    ] = "1",
    seconds: Annotated[
        float | None,
        typer.Option(
            "--for",
            metavar="SECONDS",
            help="Stop after this much simulated time.",
            rich_help_panel=help.TIME,
        ),
    ] = None,
    paused: arguments.Paused = False,
    headless: arguments.Headless = False,
    host: arguments.RunHost = "127.0.0.1",
    port: arguments.Port = 8080,
    allow_origin: arguments.AllowOrigin = None,
    open_browser: arguments.OpenBrowser = None,
    ros1: Annotated[
        bool,
        typer.Option(
            "--ros1",
            help="Run as a ROS 1 node, with Gazebo's topics and services.",
            rich_help_panel=help.WIRES,
        ),
    ] = False,
    ros1_node: Annotated[
        str,
        typer.Option(
            "--ros1-node",
            metavar="NAME",
            help="Name of the ROS 1 node. Can also be set with __name:=NAME.",
            rich_help_panel=help.WIRES,
        ),
    ] = "gazebo",
    ros2: Annotated[
        bool,
        typer.Option(
            "--ros2",
            help="Run as a ROS 2 node, with Gazebo's topics and services.",
            rich_help_panel=help.WIRES,
        ),
    ] = False,
    ros2_node: Annotated[
        str,
        typer.Option(
            "--ros2-node",
            metavar="NAME",
            help="Name of the ROS 2 node.",
            rich_help_panel=help.WIRES,
        ),
    ] = "gazebo",
    rmw: Annotated[
        str,
        typer.Option(
            "--rmw",
            metavar="dds|zenoh",
            help="Middleware of the ROS 2 node.",
            rich_help_panel=help.WIRES,
        ),
    ] = "dds",
    bridge: Annotated[
        list[Path] | None,
        typer.Option(
            "--bridge",
            metavar="FILE",
            help="Rename topics as configured in this ros_gz_bridge YAML file. Can be repeated.",
            rich_help_panel=help.WIRES,
        ),
    ] = None,
    foxglove: Annotated[
        bool,
        typer.Option(
            "--foxglove",
            help="Start a server for Foxglove and Lichtblick on the address of --host.",
            rich_help_panel=help.WIRES,
        ),
    ] = False,
    foxglove_port: Annotated[
        int,
        typer.Option(
            "--foxglove-port",
            min=0,
            max=65535,
            metavar="PORT",
            help="Port of the Foxglove server; 0 selects a free port.",
            rich_help_panel=help.WIRES,
        ),
    ] = 8765,
    record: Annotated[
        list[Path] | None,
        typer.Option(
            "--record",
            metavar="FILE",
            help="Record to a .mcap, .bag or .db3 file, or to a rosbag2 folder. Can be repeated.",
            rich_help_panel=help.RECORDING,
        ),
    ] = None,
    record_topics: Annotated[
        list[str] | None,
        typer.Option(
            "--record-topics",
            metavar="PATTERN",
            help="Record only topics that match a name such as /camera/*, or a regular expression "
            "such as re:/imu/.*. With ! in front, as in !/camera/*, exclude topics. Can be "
            "repeated. Default: all topics, including images.",
            rich_help_panel=help.RECORDING,
        ),
    ] = None,
    record_encoding: Annotated[
        str | None,
        typer.Option(
            "--record-encoding",
            metavar="ros1|ros2",
            help="Message encoding in a .mcap file. Default: ros2.",
            rich_help_panel=help.RECORDING,
        ),
    ] = None,
    overwrite: Annotated[
        bool,
        typer.Option(
            "--overwrite",
            help="Replace a recording that already exists.",
            rich_help_panel=help.RECORDING,
        ),
    ] = False,
    package_path: arguments.PackagePath = None,
    allow_path: arguments.AllowPath = None,
    verbose: Annotated[
        bool, typer.Option("--verbose", help="Show informational messages.")
    ] = False,
) -> None:
    """Simulate a robot, by default the bundled example cart.

    FILE can also be a world, which is then simulated without a robot. NAME:=VALUE sets a xacro
    argument; world:=FILE is the same as --world.

    With --ros1, arguments of a ROS 1 node are also accepted: __name:=NAME, _PARAMETER:=VALUE and
    /TOPIC:=NEW_NAME. If FILE is a world, TOPIC:=NEW_NAME is accepted, too.
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
            without=tuple(without or ()),
            host=host,
            allow_origin=tuple(allow_origin or ()),
            port=port,
            open_browser=open_browser,
            place=arguments.place(x=x, y=y, z=z, roll=roll, pitch=pitch, yaw=yaw),
            model=model,
            package_path=tuple(package_path or ()),
            allow_path=tuple(allow_path or ()),
            controllers=tuple(controllers or ()),
            plugins=tuple(plugin or ()),
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
