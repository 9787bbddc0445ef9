"""Worlds that are read and compiled once and made many times."""

from __future__ import annotations

import inspect
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from cartwheel import description as descriptions
from cartwheel.api.arguments import (
    check_xacro_arguments,
    paths,
    refused,
    several,
    source,
    xacro_arguments,
)
from cartwheel.api.basis import Basis
from cartwheel.api.world import World
from cartwheel.codes import codes_matching
from cartwheel.codes.command import OPTION_INVALID, OPTIONS_CONFLICT
from cartwheel.description.files.readings import Readings
from cartwheel.description.model import RobotDescription, WorldDescription
from cartwheel.errors import CartwheelError, Code, Diagnostic
from cartwheel.similar_names import meant, suggestion
from cartwheel.simulation.models.compilations import SharedCompiler

Robot = str | Path | RobotDescription | Mapping[str, Any]
"""A file, a description, or the arguments of `World.spawn`, of which ``robot`` is required."""


class Built:
    """A world with its robots, read and compiled once; `build` makes it.

    It can be pickled, for example for the processes of `multiprocessing`. With the same seed and
    commands, its worlds give identical results in each process.
    """

    def __init__(
        self,
        description: WorldDescription,
        robots: Sequence[Mapping[str, Any]],
        options: Mapping[str, Any],
    ) -> None:
        self._description = description
        self._robots = tuple(robots)
        self._options = dict(options)
        self._compiler = SharedCompiler()
        self._readings = Readings()
        self._models: tuple[str, ...] = ()
        self._diagnostics: tuple[Diagnostic, ...] = ()
        self._visuals = False

    def __repr__(self) -> str:
        return f"<Built world {self._description.name!r}: {', '.join(self._models)}>"

    @property
    def models(self) -> tuple[str, ...]:
        """Names of the models in each world."""
        return self._models

    @property
    def diagnostics(self) -> tuple[Diagnostic, ...]:
        """Diagnostics that each world reports at its start."""
        return self._diagnostics

    def world(self, *, seed: int = 0, **options: Any) -> World:
        """Makes a world with the robots.

        Args:
            seed: Seed for all noise.
            options: Options of `World` for connections and recordings, such as ``viewer=True``.

        Raises:
            CartwheelError: An option is one of those of `build`, or a connection cannot be opened.
                Nothing remains open.
            TypeError: `World` does not have an option.
        """
        for name in ("world", *self._options):
            if name in options:
                raise CartwheelError(
                    f'"{name}" is an option of build, and applies to all of its worlds',
                    code=OPTIONS_CONFLICT,
                    hint=f"Pass it to build: cartwheel.build(…, {name}=…).",
                    values={"name": name},
                )
        return self._world(seed=seed, **options)

    def _world(self, *, seed: int = 0, watched: bool = True, **options: Any) -> World:
        """`world`, also without showing it in reports of tests."""
        basis = Basis(compiler=self._compiler, readings=self._readings, watched=watched)
        made = World._based(basis, self._description, seed=seed, **self._options, **options)
        try:
            with made.spawning():
                for robot in self._robots:
                    made.spawn(**robot)
        except BaseException:
            made.close()
            raise
        return made

    def compile_visuals(self) -> None:
        """Compiles the visuals, as `build` does with ``visuals=True``.

        Afterwards, its worlds need no files of their robots, also on another computer. Without
        effect on results.

        Raises:
            WorldError: A visual cannot be built.
        """
        if not self._visuals:
            self._compile(visuals=True)

    def _compile(self, *, visuals: bool) -> None:
        with self._world(watched=False) as world:
            self._models, self._diagnostics = world.models, world.diagnostics
            if visuals:
                world.session.simulation.engine.visuals.current()
        self._visuals = visuals
        self._compiler.complete = self._readings.complete = True


def build(
    world: str | Path | WorldDescription = "empty",
    robots: Robot | Sequence[Robot] = (),
    *,
    visuals: bool = False,
    strict: bool = False,
    ignore: str | Sequence[str] = (),
    lenient: bool = False,
    bridge: str | Path | Sequence[str | Path] = (),
    plugins: str | Path | Sequence[str | Path] = (),
    package_path: str | Path | Sequence[str | Path] = (),
    without: str | Sequence[str] = (),
    step_size: float | None = None,
) -> Built:
    """Reads and compiles a world and its robots once, to make many worlds of them.

    Each world of the result is as if made by `World` and `World.spawn`, but without reading and
    compiling files. Later changes of the files have no effect.

    Args:
        world: As for `World`.
        robots: Robots to spawn: each is a file, a description, or a mapping with the arguments of
            `World.spawn`, such as ``{"robot": "rosbots.xacro", "x": 1.0}``.
        visuals: Also compile the visuals. Otherwise, the first image of a camera compiles them, in
            each process.
        strict: As for `World`.
        ignore: As for `World`.
        lenient: As for `World`.
        bridge: As for `World`.
        plugins: As for `World`.
        package_path: As for `World`, and for all robots without a ``package_path`` of their own.
        without: As for `World`.
        step_size: As for `World`.

    Raises:
        DescriptionError: A file cannot be used.
        WorldError: A name is used twice, or a model cannot be built.
        PluginError: A plugin cannot be used.
        CartwheelError: A name in `without` or a code is unknown, or `World.spawn` does not have an
            argument of a robot.
    """
    source(world, "world")
    if not isinstance(world, WorldDescription):
        world = descriptions.load_world(world)
    ignored = frozenset[Code]().union(*map(codes_matching, several(ignore, "ignore")))
    built = Built(
        world,
        [_read(robot, package_path, ignored) for robot in _listed(robots)],
        {
            "strict": strict,
            "ignore": ignore,
            "lenient": lenient,
            "bridge": bridge,
            "plugins": plugins,
            "package_path": package_path,
            "without": without,
            "step_size": step_size,
        },
    )
    built._compile(visuals=visuals)
    return built


_SPAWN_OPTIONS = tuple(inspect.signature(World.spawn).parameters)[1:]


def _listed(robots: Robot | Sequence[Robot]) -> Sequence[Robot]:
    if isinstance(robots, str | Path | RobotDescription | Mapping):
        return [robots]
    if not isinstance(robots, Sequence):
        raise refused("robots", "a robot or a sequence of robots", robots)
    return robots


def _read(
    robot: Robot, package_path: str | Path | Sequence[str | Path], ignored: frozenset[Code]
) -> dict[str, Any]:
    """The arguments of `World.spawn` for a robot, with its description instead of its file."""
    given: dict[str, Any] = dict(robot) if isinstance(robot, Mapping) else {"robot": robot}
    given.setdefault("package_path", package_path)
    if unknown := [name for name in given if name not in _SPAWN_OPTIONS]:
        raise CartwheelError(
            f'World.spawn has no argument "{unknown[0]}"',
            code=OPTION_INVALID,
            hint=suggestion(unknown[0], _SPAWN_OPTIONS),
            values={"name": unknown[0], "meant": meant(unknown[0], _SPAWN_OPTIONS)},
        )
    if "robot" not in given:
        raise refused("robots", 'robots with the key "robot"', robot)
    file = given["robot"]
    source(file, "robot")
    if isinstance(file, str | Path):
        given["robot"] = descriptions.load_robot(
            file,
            arguments=xacro_arguments(given.pop("arguments", None)),
            package_path=paths(given["package_path"], "package_path"),
        )
        check_xacro_arguments(given["robot"], ignored)
    return given
