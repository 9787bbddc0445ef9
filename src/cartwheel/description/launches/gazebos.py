"""Which Gazebo a launch file starts, and gz-sim's worlds."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path

from cartwheel.description.elements.simulator import simulators_of
from cartwheel.description.launches.effort import UNKNOWN
from cartwheel.description.launches.launch_use import LaunchUse
from cartwheel.description.launches.spawning import split, world_in
from cartwheel.description.model import RobotDescription, Simulator

_PACKAGES: Mapping[str, Simulator] = {
    "gazebo_ros": "classic",
    "ros_gz_sim": "gz",
    "ros_ign_gazebo": "gz",
    "ros_gz": "gz",
}
_PROGRAMS: Mapping[str, Simulator] = {
    "gazebo": "classic",
    "gzserver": "classic",
    "gz": "gz",
    "ign": "gz",
}
_LAUNCH_FILES: Mapping[str, Simulator] = {
    "empty_world.launch": "classic",
    "gazebo.launch.py": "classic",
    "gzserver.launch.py": "classic",
    "gz_sim.launch.py": "gz",
    "gz_server.launch.py": "gz",
    "gz_spawn_model.launch.py": "gz",
    "ign_gazebo.launch.py": "gz",
    "ros_gz_sim.launch.py": "gz",
    "ros_gz_spawn_model.launch.py": "gz",
}
"""Launch files of these packages, by which others start Gazebo."""
_COMMON = "gazebo.launch.py"
"""A name that launch files of other packages also have, which may start gz-sim."""
_SUBCOMMANDS: Mapping[str, str] = {"gz": "sim", "ign": "gazebo"}
"""What follows these programs if they start gz-sim. Gazebo Classic also has a program ``gz``."""
_ARGUMENTS = ("gz_args", "ign_args")
_WORLD = "world_sdf_file"
"""The argument and parameter of ros_gz_sim's server that names its world."""


@dataclass(kw_only=True)
class Gazebos:
    """What is known of the Gazebo that a launch file starts."""

    kinds: set[Simulator] = field(default_factory=set)
    """The versions of Gazebo that it starts, or in which it spawns models."""
    worlds: list[str] = field(default_factory=list)
    """The worlds that it starts in gz-sim, as they are stated; `UNKNOWN` is in unknown ones."""

    def add_node(self, package: str, words: Sequence[str], values: Mapping[str, str]) -> None:
        """Adds what a node of a package starts, with its arguments and parameters."""
        self._add(_PACKAGES.get(package, ""), [*words, values.get(_WORLD, "")])

    def add_command(self, words: Sequence[str]) -> None:
        """Adds what a command starts."""
        program, *rest = [*" ".join(words[:1]).split(), *words[1:]] or [""]
        name = program.rsplit("/", 1)[-1]
        if name not in _SUBCOMMANDS or rest[:1] == [_SUBCOMMANDS[name]]:
            self._add(_PROGRAMS.get(name, ""), rest)

    def add_launch_file(
        self, name: str, arguments: Mapping[str, str], *, is_own: bool, is_sure: bool = True
    ) -> None:
        """Adds what an included launch file starts.

        Args:
            name: The end of its path.
            arguments: The arguments that it receives.
            is_own: Whether it exists here and is read itself.
            is_sure: Whether it can only be in a package of Gazebo.
        """
        if is_own:
            return
        kind = _LAUNCH_FILES.get(name, "") if is_sure or name != _COMMON else ""
        stated = [arguments[each] for each in _ARGUMENTS if arguments.get(each)]
        if stated:
            kind = "gz"
        words = [word for each in stated for word in split(each)]
        self._add(kind, [*words, arguments.get(_WORLD, "")])

    def _add(self, kind: Simulator, words: Sequence[str]) -> None:
        if kind:
            self.kinds.add(kind)
        if kind == "gz":
            world = world_in(words) or (UNKNOWN if any(UNKNOWN in each for each in words) else "")
            self.worlds += [world] if world else []


def in_simulator(
    robot: RobotDescription, file: Path, launches: Iterable[LaunchUse]
) -> RobotDescription:
    """A robot with the Gazebo in which launch files start it.

    If none is known to start it, and the robot has plugins for both, it is the Gazebo that the
    other launch files start.

    Args:
        robot: The robot.
        file: Its file.
        launches: The launch files of its author.
    """
    path, launches = file.resolve(), list(launches)
    own = [each for each in launches if each.description and each.description.resolve() == path]
    kinds = {kind for each in own for kind in each.gazebos}
    if not kinds and len(simulators_of(tag.filename for tag in robot.all_plugins)) > 1:
        kinds = {kind for each in launches for kind in each.gazebos}
    return replace(robot, simulator=kinds.pop()) if len(kinds) == 1 else robot
