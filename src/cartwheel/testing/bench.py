"""What a test with the fixture `world` uses: the built world and its robots."""

from __future__ import annotations

import json
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import pytest

from cartwheel.api import Built, Model, build
from cartwheel.codes.command import NO_TEST_ROBOT, OPTION_INVALID
from cartwheel.description.model import RobotDescription
from cartwheel.errors import CartwheelError
from cartwheel.similar_names import meant, suggestion
from cartwheel.testing.witnesses import Witnesses

_BUILT: pytest.StashKey[dict[str, Built]] = pytest.StashKey()
_BUILD_OPTIONS = (
    "strict", "ignore", "lenient", "bridge", "plugins", "package_path", "without", "visuals",
    "step_size",
)  # fmt: skip
_MOST_BUILT = 20


class Bench:
    """The world of a test.

    Args:
        request: The request of the fixture `world`.
        witnesses: Record it.

    Raises:
        CartwheelError: A mark, the world or a robot is invalid.
    """

    def __init__(self, request: pytest.FixtureRequest, witnesses: Witnesses) -> None:
        self._node: pytest.Item = request.node
        self._config = request.config
        marks = _Marks(self._node, self._config)
        # Its robots are in the world when it is recorded and shown.
        self.world = self._build(marks)._world(seed=marks.seed, watched=False)
        count = len(marks.robots)
        self._robots = self.world.models[len(self.world.models) - count :] if count else ()
        try:
            witnesses.add(self.world, self._robots)
        except BaseException:
            self.world.close()
            raise

    @property
    def missing_robot(self) -> CartwheelError | None:
        """The error of a test that names no robot; None if it does."""
        if self._robots:
            return None
        return CartwheelError(
            "the test uses the fixture robot, but names no robot",
            code=NO_TEST_ROBOT,
            hint='Add @pytest.mark.robot("FILE"), or set cartwheel_robot in the ini file.',
            values={"test": self._node.nodeid},
        )

    @property
    def robot(self) -> Model:
        """The first robot; see `missing_robot`."""
        return self.world.model(self._robots[0])

    def close(self) -> None:
        """Closes the world, also after a failed test."""
        self.world.close()

    def _build(self, marks: _Marks) -> Built:
        cache = self._config.stash.setdefault(_BUILT, {})
        key = json.dumps(
            [str(marks.world), marks.robots, marks.options], default=_key, sort_keys=True
        )
        if key not in cache:
            if len(cache) >= _MOST_BUILT:
                del cache[next(iter(cache))]
            cache[key] = build(marks.world, marks.robots, **marks.options)
        return cache[key]


class _Marks:
    """World, robots and seed of a test, from its marks and the configuration."""

    def __init__(self, node: pytest.Item, config: pytest.Config) -> None:
        self._folder, self._root = node.path.parent, config.rootpath
        self.options: dict[str, Any] = {}
        self.world: str | Path = self._file(str(config.getini("cartwheel_world")))
        self.seed = _parameter(node, "seed")
        robots: list[Any] = []
        # From the outermost mark to the innermost one, which takes precedence.
        for mark in reversed(list(node.iter_markers("cartwheel"))):
            given = dict(mark.kwargs)
            if "world" in given:
                self.world = self._file(given.pop("world"))
            self.seed = given.pop("seed", self.seed)
            given.pop("record", None)
            for name in ("robot", "robots"):
                if name in given:
                    robots = _listed(given.pop(name))
            self._add_options(given, mark.name, ("world", "robot", "seed", "record"))
        for mark in reversed(list(node.iter_markers("world"))):
            if mark.args:
                self.world = self._file(mark.args[0])
            self._add_options(mark.kwargs, mark.name)
        for mark in reversed(list(node.iter_markers("seed"))):
            self.seed = mark.args[0] if mark.args else self.seed
        marked = [
            {"robot": mark.args[0], **mark.kwargs}
            for mark in reversed(list(node.iter_markers("robot")))
        ]
        default = config.getoption("--cartwheel-robot") or config.getini("cartwheel_robot")
        chosen = robots + marked or ([default] if default else [])
        self.robots = [self._robot(each) for each in chosen]

    def _add_options(
        self, given: Mapping[str, Any], mark: str, others: tuple[str, ...] = ()
    ) -> None:
        for name in given:
            if name not in _BUILD_OPTIONS:
                raise CartwheelError(
                    f'the mark {mark} has no option "{name}"',
                    code=OPTION_INVALID,
                    hint=suggestion(name, (*others, *_BUILD_OPTIONS)),
                    values={
                        "option": name,
                        "mark": mark,
                        "meant": meant(name, (*others, *_BUILD_OPTIONS)),
                    },
                )
        self.options |= given

    def _robot(self, given: Any) -> dict[str, Any]:
        options = dict(given) if isinstance(given, Mapping) else {"robot": given}
        return {**options, "robot": self._file(options["robot"])}

    def _file(self, name: Any) -> Any:
        """A file beside the test, below the root folder, the name of a bundled file, or XML."""
        if not isinstance(name, str | Path) or str(name).lstrip().startswith("<"):
            return name
        for folder in (self._folder, self._root):
            if (folder / name).is_file():
                return folder / name
        return name


def _parameter(node: pytest.Item, name: str) -> int:
    """A whole number among the parameters of a test; 0 without one."""
    call = getattr(node, "callspec", None)
    value = None if call is None else call.params.get(name)
    return value if isinstance(value, int) and not isinstance(value, bool) else 0


def _listed(value: Any) -> list[Any]:
    return list(value) if isinstance(value, list | tuple) else [value]


def _key(value: Any) -> str:
    """The identity of a value that JSON does not support."""
    return f"{id(value)}" if isinstance(value, RobotDescription) else str(value)
