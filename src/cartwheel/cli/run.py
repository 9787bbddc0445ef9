"""``cartwheel run``: a robot in a world."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

from cartwheel.cli import arguments, help
from cartwheel.cli.control import parse_speed


def run(
    *,
    words: arguments.RunNames = None,
    world: Annotated[
        str | None,
        help.option(
            "--world FILE|NAME",
            "World to simulate: an SDF file, or the name of a bundled world.",
            help.WORLD,
        ),
    ] = None,
    seed: Annotated[
        int, help.option("--seed N", "Random seed for sensor noise.", help.WORLD, min=0)
    ] = 0,
    strict: Annotated[
        bool, help.option("--strict", "Treat every warning as an error.", help.WORLD)
    ] = False,
    without: Annotated[
        list[str] | None,
        help.option(
            "--without NAME|all",
            "Omit physics that Cartwheel adds to descriptions, such as chain-drag; "
            "--verbose shows the names. Can be repeated.",
            help.WORLD,
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
        help.option(
            "--controllers FILE",
            "Start the controllers in this ros_control or ros2_control YAML file. Can be repeated. "
            "auto selects the controllers that the launch files of the robot's package start.",
            help.ROBOT,
        ),
    ] = None,
    plugin: arguments.Plugin = None,
    speed: Annotated[
        str,
        help.option(
            "--speed FACTOR|max",
            "Real-time factor: 1 is real time, max is as fast as possible.",
            help.TIME,
        ),
    ] = "1",
    seconds: Annotated[
        float | None,
        help.option("--for SECONDS", "Stop after this much simulated time.", help.TIME),
    ] = None,
    paused: arguments.Paused = False,
    headless: arguments.Headless = False,
    host: arguments.RunHost = "127.0.0.1",
    port: arguments.Port = 8080,
    allow_origin: arguments.AllowOrigin = None,
    open_browser: arguments.OpenBrowser = None,
    ros1: Annotated[
        bool,
        help.option(
            "--ros1", "Run as a ROS 1 node, with Gazebo's topics and services.", help.WIRES
        ),
    ] = False,
    ros1_node: Annotated[
        str,
        help.option(
            "--ros1-node NAME",
            "Name of the ROS 1 node. Can also be set with __name:=NAME.",
            help.WIRES,
        ),
    ] = "gazebo",
    ros2: Annotated[
        bool,
        help.option(
            "--ros2", "Run as a ROS 2 node, with Gazebo's topics and services.", help.WIRES
        ),
    ] = False,
    ros2_node: Annotated[
        str, help.option("--ros2-node NAME", "Name of the ROS 2 node.", help.WIRES)
    ] = "gazebo",
    rmw: Annotated[
        str, help.option("--rmw dds|zenoh", "Middleware of the ROS 2 node.", help.WIRES)
    ] = "dds",
    bridge: Annotated[
        list[Path] | None,
        help.option(
            "--bridge FILE",
            "Rename topics as configured in this ros_gz_bridge YAML file. Can be repeated.",
            help.WIRES,
        ),
    ] = None,
    foxglove: Annotated[
        bool,
        help.option(
            "--foxglove",
            "Start a server for Foxglove and Lichtblick on the address of --host.",
            help.WIRES,
        ),
    ] = False,
    foxglove_port: Annotated[
        int,
        help.option(
            "--foxglove-port PORT",
            "Port of the Foxglove server; 0 selects a free port.",
            help.WIRES,
            min=0,
            max=65535,
        ),
    ] = 8765,
    record: Annotated[
        list[Path] | None,
        help.option(
            "--record FILE",
            "Record to a .mcap, .bag or .db3 file, or to a rosbag2 folder. Can be repeated.",
            help.RECORDING,
        ),
    ] = None,
    record_topics: Annotated[
        list[str] | None,
        help.option(
            "--record-topics PATTERN",
            "Record only topics that match a name such as /camera/*, or a regular expression "
            "such as re:/imu/.*. With ! in front, as in !/camera/*, exclude topics. Can be "
            "repeated. Default: all topics, including images.",
            help.RECORDING,
        ),
    ] = None,
    record_encoding: Annotated[
        str | None,
        help.option(
            "--record-encoding ros1|ros2",
            "Message encoding in a .mcap file. Default: ros2.",
            help.RECORDING,
        ),
    ] = None,
    overwrite: Annotated[
        bool, help.option("--overwrite", "Replace a recording that already exists.", help.RECORDING)
    ] = False,
    package_path: arguments.PackagePath = None,
    allow_path: arguments.AllowPath = None,
    verbose: Annotated[bool, help.option("--verbose", "Show informational messages.")] = False,
) -> None:
    """Simulate a robot, by default the bundled example cart.

    FILE can also be a world, which is then simulated without a robot. NAME:=VALUE sets a xacro
    argument; world:=FILE is the same as --world.

    Of a launch file, the models, their controllers and the world are started, without ROS.
    NAME:=VALUE sets its arguments. The file is read, but not executed.

    With --ros1, arguments of a ROS 1 node are also accepted: __name:=NAME, _PARAMETER:=VALUE and
    /TOPIC:=NEW_NAME. If FILE is a world, TOPIC:=NEW_NAME is accepted, too.
    """
    from cartwheel.assembly.plan import Plan
    from cartwheel.assembly.recording import RecordingOptions
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
            plan=Plan(
                ros1=ros1_node if ros1 else None,
                ros1_arguments=tuple(ros1_arguments),
                ros2=ros2_node if ros2 else None,
                rmw=arguments.rmw(rmw),
                foxglove=foxglove_port if foxglove else None,
                recordings=tuple(record or ()),
                recording=RecordingOptions(
                    topics=tuple(word for text in record_topics or () for word in text.split()),
                    encoding=record_encoding,
                    overwrite=overwrite,
                ),
            ),
            verbose=verbose,
        )
    )
