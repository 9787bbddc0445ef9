"""What a test with the fixture `world` uses: the built world, its robots, and its report."""

from __future__ import annotations

import contextlib
import json
import os
import re
import shlex
import sys
from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

import pytest

from cartwheel.api import Built, Model, build
from cartwheel.codes.command import NO_TEST_ROBOT, OPTION_INVALID
from cartwheel.description.model import RobotDescription
from cartwheel.errors import CartwheelError, RecordingError
from cartwheel.messages.echo import to_yaml
from cartwheel.similar_names import meant, suggestion
from cartwheel.testing.recent import Recent

if TYPE_CHECKING:
    from collections.abc import Iterator

_BUILT: pytest.StashKey[dict[str, Built]] = pytest.StashKey()
_FOLDER = "cartwheel-failures"
_BUILD_OPTIONS = (
    "strict", "ignore", "lenient", "bridge", "plugins", "package_path", "without", "visuals",
    "step_size",
)  # fmt: skip
_MOST_TOPICS = 30
_MOST_LINES = 12
_PATIENCE = 30.0
"""Wall time for which a test waits for a browser, s."""
"""Maximum number of topics, and of lines for each message, in a report."""
_UNINFORMATIVE = ("dynamic_reconfigure/", "rosgraph_msgs/", "sensor_msgs/msg/CameraInfo")
"""Types of messages that the report omits."""
_TEXT = "std_msgs/msg/String"
_LONGEST = 300
"""Characters of a line of a message in a report."""
_MOST_BUILT = 20
_WAIT = 60.0
"""Maximum wall time to wait for a browser, s."""


class Bench:
    """The world of a test.

    Args:
        request: The request of the fixture `world`.

    Raises:
        CartwheelError: A mark, the world or a robot is invalid.
    """

    def __init__(self, request: pytest.FixtureRequest) -> None:
        self._node: pytest.Item = request.node
        self._config = request.config
        marks = _Marks(self._node, self._config)
        self._view = bool(self._config.getoption("--cartwheel-view"))
        built = self._build(marks)
        self.world = built.world(seed=marks.seed, **({"viewer": True} if self._view else {}))
        count = len(marks.robots)
        self._robots = self.world.models[len(self.world.models) - count :] if count else ()
        self._recent: Recent | None = None
        try:
            seconds = self._seconds()
            if seconds != 0:
                self._recent = Recent(self.world, seconds, marks.record)
            if self._view:
                self._show()
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
        if self._recent is not None:
            self._recent.close()
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

    def _seconds(self) -> float | None:
        """How much is recorded, s; None for the whole test."""
        given = self._config.getoption("--cartwheel-record") or self._config.getini(
            "cartwheel_record"
        )
        if given == "off":
            return 0
        if given == "all":
            return None
        with contextlib.suppress(ValueError):
            seconds = float(given)
            if seconds >= 0:
                return seconds
        raise CartwheelError(
            f'--cartwheel-record must be a number of seconds, all or off (got "{given}")',
            code=OPTION_INVALID,
            values={"option": "--cartwheel-record", "value": str(given)},
        )

    def _show(self) -> None:
        """Shows the world in the browser, in real time."""
        url = self.world.show()
        self.world.pace = 1.0
        manager = self._config.pluginmanager.getplugin("capturemanager")
        reporter = self._config.pluginmanager.getplugin("terminalreporter")
        with manager.global_and_fixture_disabled() if manager else contextlib.nullcontext():
            if reporter is not None:
                reporter.ensure_newline()
                reporter.write_line(f"{self._node.nodeid}: {url}")
            if sys.stderr.isatty():
                self.world.wait_for_browser(_PATIENCE)
        if os.environ.get("DISPLAY") or os.environ.get("WAYLAND_DISPLAY"):
            import webbrowser

            webbrowser.open(url)

    # -- the report of a failed test

    def sections(self) -> list[tuple[str, str]]:
        """Titles and texts."""
        made: Iterator[tuple[str, str]] = iter(
            (
                ("cartwheel: world", self._state()),
                ("cartwheel: diagnostics", self._diagnostics()),
                ("cartwheel: last messages", self._messages()),
                ("cartwheel: artifacts", self._artifacts()),
            )
        )
        return [(title, text) for title, text in made if text]

    def _state(self) -> str:
        lines = [f"time: {self.world.time:.3f} s"]
        if self.world.session.simulation.closed:
            return "\n".join([*lines, "the world is closed"])
        for name in self.world.models[:_MOST_TOPICS]:
            if self.world.session.simulation.moves(name) or name in self._robots:
                pose = self.world.model(name).pose
                x, y, z = pose.position
                lines.append(
                    f"{name}: x {x:z.3f}, y {y:z.3f}, z {z:z.3f} m, yaw {pose.yaw:z.3f} rad"
                )
        return "\n".join(lines)

    def _diagnostics(self) -> str:
        return "\n".join(
            f"{each}{f' {each.hint}' if each.hint else ''}"
            for each in self.world.diagnostics
            if each.severity != "info"
        )

    def _messages(self) -> str:
        if self._recent is None:
            return ""
        parts = []
        shown = [
            (topic, *latest)
            for topic, latest in sorted(self._recent.latest.items())
            if not latest[1].__msgtype__.startswith(_UNINFORMATIVE)
            # Texts such as /robot_description are as at the start of the test.
            and not (latest[1].__msgtype__ == _TEXT and self._recent.is_latched(topic))
        ]
        for topic, time_ns, message in shown[:_MOST_TOPICS]:
            lines = _without_header(to_yaml(message, arrays=False).splitlines())
            if len(lines) > _MOST_LINES:
                lines = [*lines[:_MOST_LINES], "…"]
            body = "\n".join(f"  {_shortened(line.rstrip())}" for line in lines)
            parts.append(f"{topic} at {time_ns / 1e9:.3f} s\n{body}")
        return "\n".join(parts)

    def _artifacts(self) -> str:
        folder = artifact_folder(self._config)
        name = re.sub(r"[^\w.=-]+", "_", self._node.nodeid)[-120:].strip("_")
        lines = []
        if self.world.time > 0 and not self.world.session.simulation.closed:
            with contextlib.suppress(OSError):
                _make(folder)
            lines += self._recording(folder / f"{name}.mcap")
            lines += self._picture(folder / f"{name}.png")
        view = shlex.join(["pytest", self._node.nodeid, "--cartwheel-view"])
        return "\n".join([*lines, f"watch:     {view}"])

    def _recording(self, path: Path) -> list[str]:
        if self._recent is None:
            return []
        try:
            self._recent.write(path)
        except (RecordingError, OSError) as error:
            return [f"recording: {error}"]
        return [f"recording: {path}", f"replay:    {shlex.join(['cartwheel', 'play', str(path)])}"]

    def _picture(self, path: Path) -> list[str]:
        try:
            self.world.picture().save(path)
        except (CartwheelError, OSError) as error:
            return [f"picture:   none: {error}"]
        return [f"picture:   {path}"]


class _Marks:
    """World, robots and seed of a test, from its marks and the configuration."""

    def __init__(self, node: pytest.Item, config: pytest.Config) -> None:
        self._folder, self._root = node.path.parent, config.rootpath
        self.options: dict[str, Any] = {}
        self.world: str | Path = self._file(str(config.getini("cartwheel_world")))
        self.seed = 0
        self.record: tuple[str, ...] = ()
        robots: list[Any] = []
        # From the outermost mark to the innermost one, which takes precedence.
        for mark in reversed(list(node.iter_markers("cartwheel"))):
            given = dict(mark.kwargs)
            if "world" in given:
                self.world = self._file(given.pop("world"))
            self.seed = given.pop("seed", self.seed)
            if "record" in given:
                self.record = tuple(_listed(given.pop("record")))
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


def artifact_folder(config: pytest.Config) -> Path:
    """The folder for recordings and pictures of failed tests."""
    given = config.getoption("--cartwheel-artifacts") or config.getini("cartwheel_artifacts")
    folder = Path(given or _FOLDER)
    if folder.is_absolute():
        return folder
    base = (
        config.invocation_params.dir
        if config.getoption("--cartwheel-artifacts")
        else (config.rootpath)
    )
    return base / folder


def _make(folder: Path) -> None:
    """Makes a folder that git ignores."""
    if not folder.exists():
        folder.mkdir(parents=True)
        (folder / ".gitignore").write_text("*\n")


def _listed(value: Any) -> list[Any]:
    return list(value) if isinstance(value, list | tuple) else [value]


def _shortened(line: str) -> str:
    if len(line) <= _LONGEST:
        return line
    return f"{line[:_LONGEST]}… ({len(line)} characters)"


def _without_header(lines: list[str]) -> list[str]:
    """The lines of a message without its header, whose time is shown elsewhere."""
    if lines[:1] != ["header: "]:
        return lines
    return lines[next((i for i, line in enumerate(lines[1:], 1) if line[:1] != " "), len(lines)) :]


def _key(value: Any) -> str:
    """The identity of a value that JSON does not support."""
    return f"{id(value)}" if isinstance(value, RobotDescription) else str(value)
