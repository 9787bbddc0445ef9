"""What a launch file says about one robot."""

from __future__ import annotations

from collections.abc import Collection, Iterable, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Literal

from cartwheel.description.model import Simulator
from cartwheel.errors import Diagnostic, Origin

Missing = Literal["world", "gz world", "launch file", "parameters", "file"]
"""What a missing file is: a world of Gazebo Classic or of gz-sim, an included launch file,
parameters that ROS 1 loads, or another file that is read while the launch file is."""


@dataclass(frozen=True, kw_only=True, slots=True)
class Unfound:
    """A YAML file with the parameters of controllers of ROS 1 that does not exist."""

    controller: str
    """The name of the controller: the end of the namespace into which the file is loaded; empty for
    a file in a home folder, whose controllers are unknown."""
    file: Path
    origin: Origin
    """The ``<rosparam>``."""


@dataclass(frozen=True, kw_only=True, slots=True)
class MissingFile:
    """A file that a launch file needs to start, and that does not exist."""

    what: Missing
    name: str
    """The file as it is stated, after all substitutions."""
    origin: Origin
    at_home: bool = False
    """Whether it is in a home folder, so that it may exist on one computer."""


@dataclass(frozen=True, kw_only=True, slots=True)
class LaunchUse:
    """A robot description in a launch file, including what the launch file includes."""

    file: Path
    """The launch file."""
    description: Path | None
    """The description; None if the launch file only starts controllers."""
    arguments: Mapping[str, str]
    """Arguments of the xacro whose values are known."""
    switched: tuple[tuple[str, str], ...] = ()
    """The arguments of the launch file itself that have another value than their default, because
    it only then starts Gazebo."""
    plain: Origin | None = None
    """Where it passes the text of the description without expanding it; None if it does not."""
    raw: bool = False
    """Whether this text is that of the spawned model: the spawner reads the file."""
    unknown: int = 0
    """Number of arguments whose values are unknown."""
    controllers: tuple[Path, ...] = ()
    """YAML files that it loads, and launch files that contain parameters of controllers. A file
    with a single controller, which a launch file loads into the namespace NAME, is
    ``NAME=FILE``."""
    spawned: tuple[str, ...] = ()
    """Names of the controllers that it starts."""
    loaded: tuple[str, ...] = ()
    """Names of those that it loads, but does not start."""
    undecided: frozenset[str] = frozenset()
    """Those of them for which it may be a mistake: it does not state that they are inactive."""
    unsure: bool = False
    """Whether it starts or loads further controllers whose names are unknown."""
    typed: frozenset[str] = field(default=frozenset(), compare=False)
    """Names of controllers whose type it states itself, or in a file that is unknown."""
    node_arguments: tuple[tuple[str, tuple[str, ...]], ...] = ()
    """Names of controllers whose nodes it gives ROS arguments, such as ``-r from:=to``, with these.
    """
    absent: tuple[Path, ...] = ()
    """YAML files that it loads and that do not exist."""
    unfound: tuple[Unfound, ...] = ()
    """Those of them that certainly do not exist: their packages were found."""
    foreign: tuple[Path, ...] = field(default=(), compare=False)
    """Those of them that ROS 1 loads from a package that was not found."""
    stopped: tuple[MissingFile, ...] = ()
    """The files that certainly do not exist, and without which ROS does not start the launch file,
    or Gazebo does not start."""
    sought: tuple[tuple[str, str], ...] = ()
    """The controllers that spawners of ROS 1 start: the namespace of the manager, and the name in
    it. Those whose namespace is uncertain are left out."""
    sought_in_ros2: tuple[tuple[str, str], ...] = ()
    """The same for spawners of ROS 2."""
    programs: tuple[tuple[str, str], ...] = field(default=(), compare=False)
    """The namespaces of its nodes, each with the package of the program; `UNKNOWN` for an uncertain
    namespace."""
    managers: frozenset[str] = field(default=frozenset(), compare=False)
    """The namespaces in which it starts controller managers of ROS 2 outside of Gazebo; `UNKNOWN`
    is among them if one is uncertain."""
    sure_managers: frozenset[str] = field(default=frozenset(), compare=False)
    """Those about which no unknown condition decides, and whose name is that of the program."""
    several: bool = field(default=False, compare=False)
    """Whether it spawns several models, or names several descriptions. Its controllers may be those
    of another one."""
    alone: bool = False
    """Whether it spawns a single model, names no other description, starts no program that may be a
    controller manager by its name, and includes no launch file that was not found, apart from those
    of Gazebo."""
    places: tuple[tuple[str, Path], ...] = ()
    """The files of `controllers`, each with the namespace into which ROS 1 loads it; `UNKNOWN` if
    it is uncertain."""
    incomplete: bool = False
    """Whether its files may lack controllers, because it writes a YAML file when it is executed."""
    lacking: bool = False
    """Whether an argument has neither a default nor a value. ROS does not start it without one."""
    simulated: bool = False
    """Whether it starts Gazebo or spawns a model."""
    guessed: bool = False
    """Whether an argument is the whole name of the description, which is not its default. It may
    then be any file, also one that is not a robot."""
    world: str = ""
    """The world that it starts, as it is stated; empty if there is none."""
    gazebos: frozenset[Simulator] = frozenset()
    """The versions of Gazebo that it starts, or in which it spawns models, if they are known."""
    gz_worlds: tuple[str, ...] = ()
    """The worlds that it starts in gz-sim, as they are stated; `UNKNOWN` is in unknown ones."""
    models: tuple[str, ...] = ()
    """The names that it gives to the models that it spawns."""
    spaces: frozenset[str] = frozenset()
    """The namespaces in which it spawns models; `UNKNOWN` is among them if one is uncertain."""
    left_out: Diagnostic | None = None
    """Why not all of the launch file, or of the launch files in the folder `file`, was read. There
    is then nothing else in it."""


def unread(launches: Iterable[LaunchUse]) -> tuple[Diagnostic, ...]:
    """Why some launch files, or parts of them, were not read."""
    return tuple(each.left_out for each in launches if each.left_out is not None)


def only_loaded(loaded: Iterable[str], spawned: Collection[str]) -> tuple[str, ...]:
    """The loaded controllers that no other command starts."""
    return tuple(dict.fromkeys(name for name in loaded if name not in spawned))
