"""What is measured: robots, worlds, recordings, examples and the commands of the documentation."""

from __future__ import annotations

import json
import os
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

from .adapter import robots_in

ROOT = Path(__file__).resolve().parents[2]
HERE = Path(__file__).resolve().parent
CORPUS = Path(os.environ.get("CARTWHEEL_CORPUS", ROOT.parent / "shared" / "corpus"))
ROBOTS = HERE / "robots"
"""A robot for each plugin and sensor: the example on the plugin's page as it was when the golden
results were first taken, once with its defaults and once with all switches set."""
SHIPPED = ("robots", "models", "docs", "benchmarks/bases")
CART = ROOT / "robots/rosbots_description/urdf/rosbots.xacro"
LIMIT = 120.0
"""CPU time of a robot or a world, s."""


@dataclass(frozen=True, kw_only=True, slots=True)
class Subject:
    """One measurement, in a process of its own."""

    key: str
    kind: str
    """``robot``, ``world``, ``plugin name``, ``example``, ``recordings`` or ``commands``."""
    robot: Path | None = None
    world: Path | None = None
    folder: Path = ROOT
    """Paths are given relative to it."""
    filename: str = ""
    """Replaces the plugin's file name in the robot."""
    seconds: float = 5.0
    limit: float = LIMIT
    alone: str = ""
    """Subjects with the same word here are never measured at once."""


def all_subjects(folders: Sequence[Path] = ()) -> list[Subject]:
    """Everything, the slow ones first.

    Args:
        folders: Further folders with robots.
    """
    found = [
        *_commands(),
        Subject(key="recordings", kind="recordings"),
        *_examples(),
        *(each for folder in folders for each in _folder(folder.resolve(), folder.name)),
        *(_folder(CORPUS, "corpus") if CORPUS.is_dir() else ()),
        *repository_subjects(),
        *_aliases(),
    ]
    return list({each.key: each for each in found}.values())


def repository_subjects() -> Iterator[Subject]:
    """The robots and worlds of this repository."""
    for name in SHIPPED:
        for robot in robots_in(ROOT / name):
            yield Subject(key=str(robot.relative_to(ROOT)), kind="robot", robot=robot)
    for world in sorted((ROOT / "worlds").glob("*.world")):
        key = str(world.relative_to(ROOT))
        yield Subject(key=key, kind="world", world=world)
        if world.stem != "empty":
            yield Subject(key=f"{key} with the cart", kind="world", world=world, robot=CART)
    yield from _folder(ROBOTS, "plugins")


def _folder(folder: Path, title: str) -> Iterator[Subject]:
    for robot in robots_in(folder):
        key = f"{title}/{robot.relative_to(folder)}" if robot != folder else title
        yield Subject(key=key, kind="robot", robot=robot, folder=folder)
    for world in sorted(folder.rglob("*.world")):
        key = f"{title}/{world.relative_to(folder)}"
        yield Subject(key=key, kind="world", world=world, folder=folder)


def _aliases() -> Iterator[Subject]:
    """The other file names under which a plugin is found."""
    for slug, names in json.loads((HERE / "filenames.json").read_text()).items():
        path = next(ROBOTS.glob(f"{slug}.*"))
        for name in names:
            world = path if path.suffix == ".world" else None
            yield Subject(
                key=f"file name {name}", kind="plugin name", filename=name, seconds=0.5,
                world=world, robot=None if world else path, folder=ROBOTS,
            )  # fmt: skip


def _examples() -> Iterator[Subject]:
    for script in sorted((ROOT / "examples").glob("[0-9]*.py")):
        yield Subject(key=f"examples/{script.name}", kind="example", robot=script)


def _commands() -> Iterator[Subject]:
    from tests.docs.pages import PAGES, commands

    for page in PAGES:
        if page.is_file() and commands(page):
            yield Subject(
                key=f"commands of {page.relative_to(ROOT)}", kind="commands", robot=page,
                alone="commands", limit=400.0,
            )  # fmt: skip
