"""The report of a world in a failed test: state, last messages, a recording and a picture."""

from __future__ import annotations

import contextlib
import re
import shlex
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

import pytest

from cartwheel.codes.command import OPTION_INVALID
from cartwheel.errors import CartwheelError, RecordingError
from cartwheel.testing.recent import Recent
from cartwheel.testing.summary import summary

if TYPE_CHECKING:
    from cartwheel.api import World

_FOLDER = "cartwheel-failures"
_MOST_TOPICS = 30
_MOST_LINES = 12
"""Maximum number of topics, and of lines for each message, in a report."""
_UNINFORMATIVE = ("dynamic_reconfigure/", "rosgraph_msgs/", "sensor_msgs/msg/CameraInfo")
"""Types of messages that the report omits."""
_TEXT = "std_msgs/msg/String"


class Report:
    """What is known about a world when a test fails. The world may be closed.

    Args:
        world: The world.
        recent: Its last messages; None if they are not recorded.
        item: The test.
        robots: Names of models that are shown although they cannot move.
        number: Which world of the test it is, from 1, and the number of worlds.
    """

    def __init__(
        self,
        world: World,
        recent: Recent | None,
        item: pytest.Item,
        *,
        robots: Sequence[str] = (),
        number: tuple[int, int] = (1, 1),
    ) -> None:
        self.world, self._recent, self._item = world, recent, item
        self._robots, (self._number, self._count) = robots, number
        self.files: list[tuple[str, object]] = []
        """The files that `sections` has written, as properties of the test."""

    def sections(self) -> list[tuple[str, str]]:
        """Titles and texts."""
        which = "" if self._count == 1 else f" (world {self._number} of {self._count})"
        made = (
            ("world", self._state()),
            ("diagnostics", self._diagnostics()),
            ("last messages", self._messages()),
            ("artifacts", self._artifacts()),
        )
        return [(f"cartwheel: {title}{which}", text) for title, text in made if text]

    def _state(self) -> str:
        lines = [f"time: {self.world.time:.3f} s"]
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
            lines = summary(message)
            if len(lines) > _MOST_LINES:
                lines = [*lines[:_MOST_LINES], "…"]
            body = "\n".join(f"  {line}" for line in lines)
            parts.append(f"{topic} at {time_ns / 1e9:.3f} s\n{body}")
        return "\n".join(parts)

    def _artifacts(self) -> str:
        folder = artifact_folder(self._item.config)
        name = re.sub(r"[^\w.=-]+", "_", self._item.nodeid)[-120:].strip("_")
        name += f"-{self._number}" if self._number > 1 else ""
        lines = []
        if self.world.time > 0:
            with contextlib.suppress(OSError):
                _make(folder)
            lines += self._recording(folder / f"{name}.mcap")
            lines += self._picture(folder / f"{name}.png")
        view = shlex.join(["pytest", self._item.nodeid, "--cartwheel-view"])
        return "\n".join([*lines, f"watch:     {view}"])

    def _recording(self, path: Path) -> list[str]:
        if self._recent is None:
            return []
        try:
            self._recent.write(path)
        except (RecordingError, OSError) as error:
            return [f"recording: {error}"]
        self.files.append(("cartwheel_recording", str(path)))
        return [f"recording: {path}", f"replay:    {shlex.join(['cartwheel', 'play', str(path)])}"]

    def _picture(self, path: Path) -> list[str]:
        try:
            self.world.picture().save(path)
        except (CartwheelError, OSError) as error:
            return [f"picture:   none: {error}"]
        self.files.append(("cartwheel_picture", str(path)))
        return [f"picture:   {path}"]


def recorded_seconds(config: pytest.Config) -> float | None:
    """How much of each world is recorded, s; 0 for nothing, and None for the whole test.

    Raises:
        CartwheelError: The option is invalid.
    """
    given = config.getoption("--cartwheel-record") or config.getini("cartwheel_record")
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
