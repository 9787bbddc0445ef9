"""Worlds with the models of a launch file."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from cartwheel.api.arguments import paths, refuse_unknown_arguments, source, xacro_arguments
from cartwheel.api.world import World


def launch(
    file: str | Path,
    arguments: Mapping[str, str | float | Path] | None = None,
    *,
    world: str | Path | None = None,
    package_path: str | Path | Sequence[str | Path] = (),
    **options: Any,
) -> World:
    """Makes the world of a launch file with the robots that it spawns and their controllers.

    The launch file is read, but not executed, and ROS is not needed. Its other nodes are not
    started. The configuration files of its ros_gz_bridge rename topics as `World`'s ``bridge``.
    What only its execution determines is reported (CW164).

    >>> import cartwheel as cw
    >>> world = cw.launch("bot/launch/sim.launch.py", {"camera": False})  # doctest: +SKIP
    >>> world.models  # doctest: +SKIP
    ('ground_plane', 'bot')

    Args:
        file: A launch file of ROS 1 or ROS 2, in XML or Python.
        arguments: Arguments of the launch file.
        world: A world instead of that of the launch file.
        package_path: Folders to search for packages first.
        options: Those of `World`, such as ``seed``.

    Raises:
        DescriptionError: A description cannot be used, the launch file names neither one that
            exists nor only a world, or it does not declare an argument (CW123).
        WorldError: A model cannot be built.
        CartwheelError: An option is invalid.
    """
    from cartwheel.assembly.launched import open_launch, spawn_all

    source(file, "file")
    folders = paths(package_path, "package_path")
    launched = open_launch(
        Path(file),
        xacro_arguments(arguments) or {},
        world=None if world is None else str(world),
        package_path=folders,
    )
    refuse_unknown_arguments(launched.diagnostics)
    options["bridge"] = [*paths(options.get("bridge", ()), "bridge"), *launched.bridges]
    made = World(launched.world, package_path=folders, **options)
    try:
        with made._used(change=True):
            spawn_all(made.session, launched, folders)
    except BaseException:
        made.close()
        raise
    return made
