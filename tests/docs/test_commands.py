"""Every command that a page shows is run, on the page's files, and gives what is shown.

A page is read as a person would follow it: `cartwheel run` goes on in a terminal of its own
until the next one, `cartwheel view` is looked at and closed, `cartwheel teleop` gets the keys
that a comment above its block names.
"""

import contextlib
import importlib.metadata
import os
import pty
import re
import shutil
import signal
import subprocess
import sys
import time
from collections.abc import Iterator
from pathlib import Path

import pytest
from tests import launching

from .pages import PAGES, ROOT, Command, blocks, commands

START_SECONDS = 60.0
PATIENCE = 120.0
"""s in which what a simulation says must have become what the page shows."""
_MESSAGE = re.compile(r"\b(?:error|warning|info): ")
_DECIMAL = re.compile(r"-?\d+\.\d+")
_PARTS = re.compile(r"(\.\.\.|(?<![\w.])-?\d+\.\d+(?![\w.]))")

ASKS = ("cartwheel topic ", "cartwheel status", "cartwheel models", "cartwheel service list")
"""Commands that change nothing, so that they may be asked again."""


class Reader:
    """Follows one page."""

    def __init__(self, tmp_path: Path, runtime: Path) -> None:
        self.folder = tmp_path
        self._tmp_path = tmp_path
        self._runtime = runtime
        # pip puts `cartwheel` beside the interpreter that runs the tests.
        path = f"{Path(sys.executable).parent}:{os.environ['PATH']}"
        self._environment = {
            **os.environ,
            "PATH": path,
            "XDG_RUNTIME_DIR": str(self._runtime),
            "COLUMNS": "100",
            "NO_COLOR": "1",
        }
        self._running: subprocess.Popen[str] | None = None

    def close(self) -> None:
        """Ends the simulation of the page."""
        if self._running is not None:
            self._running.send_signal(signal.SIGINT)
            try:
                self._running.communicate(timeout=120)
            except subprocess.TimeoutExpired:
                self._running.kill()
                raise
            finally:
                self._running = None

    def follow(self, command: Command) -> None:
        text = command.text
        if command.status:
            self._ask(command)
        elif text.startswith("cd "):
            self._change_folder(text.removeprefix("cd "))
        elif text.startswith("cartwheel run") and "--for" not in text:
            self._start(command)
        elif text.startswith("cartwheel view"):
            self._view(command)
        elif text.startswith("cartwheel teleop"):
            self._teleop(command)
        else:
            self._ask(command)

    def _change_folder(self, name: str) -> None:
        """Into a copy: commands write files."""
        source = ROOT / name
        assert source.is_dir(), f"{name} is no folder of the repository"
        self.folder = self._tmp_path / Path(name).name
        shutil.copytree(source, self.folder)

    def _popen(self, text: str) -> subprocess.Popen[str]:
        # Of a command in a shell, the shell would get the signals.
        words = launching.shell(text)
        return launching.Popen(
            words if words[0] != "bash" else ["bash", "-c", f"exec {text}"],
            cwd=self.folder,
            env=self._environment,
            stdin=subprocess.DEVNULL,
            stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT,
            text=True,
        )

    def _start(self, command: Command) -> None:
        self.close()
        headless = "" if "--headless" in command.text else " --headless"
        self._running = self._popen(command.text + headless)
        deadline = time.monotonic() + START_SECONDS
        while not list((self._runtime / "cartwheel").glob("*.json")):
            if self._running.poll() is not None:
                pytest.fail(f"{command}\nended with:\n{self._running.communicate()[0]}")
            assert time.monotonic() < deadline, f"{command}: no simulation"
            time.sleep(0.05)

    def _view(self, command: Command) -> None:
        viewer = self._popen(f"{command.text} --port 0")
        assert viewer.stdout is not None
        seen = ""
        for line in viewer.stdout:
            seen += line
            if "http://" in line:
                break
        viewer.send_signal(signal.SIGINT)
        viewer.communicate(timeout=120)
        assert "http://" in seen, f"{command}\n{seen}"

    def _teleop(self, command: Command) -> None:
        keys = command.block.notes.get("keys", "")
        assert keys, f"{command}: which keys? Write <!-- keys: ... --> above the block."
        master, slave = pty.openpty()
        driver = subprocess.Popen(
            ["bash", "-c", f"exec {command.text}"],
            cwd=self.folder,
            env=self._environment,
            stdin=slave,
            stdout=slave,
            stderr=slave,
        )
        os.close(slave)
        os.read(master, 4096)  # It has said how to drive, so it listens.
        for key in keys.split():
            os.write(master, key.encode())
            time.sleep(0.3)
        driver.send_signal(signal.SIGINT)
        deadline = time.monotonic() + 20
        while driver.poll() is None and time.monotonic() < deadline:
            _drain(master)
            time.sleep(0.05)
        driver.kill()
        os.close(master)
        assert driver.returncode in (0, 130), f"{command}: status {driver.returncode}"

    def _ask(self, command: Command) -> None:
        deadline = time.monotonic() + PATIENCE
        while True:
            done = launching.run(
                launching.shell(command.text),
                cwd=self.folder,
                env=self._environment,
                stdin=subprocess.DEVNULL,
                capture_output=True,
                text=True,
                timeout=120,
                check=False,
            )
            output = done.stdout + done.stderr
            fits = done.returncode == command.status and matches(command.expected, output)
            again = command.text.startswith(ASKS) and time.monotonic() < deadline
            if fits or not again:
                break
            time.sleep(0.2)
        status = done.returncode
        assert status == command.status, f"{command}\nended with {status}:\n{output}"
        assert fits, f"{command}\nshown:\n{command.expected}\ngiven:\n{output}"


def _drain(master: int) -> None:
    os.set_blocking(master, False)
    with contextlib.suppress(OSError):
        os.read(master, 65536)


def matches(expected: str, output: str) -> bool:
    """Whether the shown output is that one; no shown output fits any.

    ``...`` stands for anything, a decimal for every number that rounds to it, and spaces for
    spaces.
    """
    if not expected.strip():
        return True
    pattern, shown = "", []
    for part in _PARTS.split(" ".join(expected.split())):
        if part == "...":
            pattern += ".*?"
        elif _DECIMAL.fullmatch(part):
            shown.append(part)
            pattern += r"(-?\d+(?:\.\d+)?(?:e[-+]?\d+)?)"
        else:
            pattern += re.escape(part)
    found = re.fullmatch(pattern, " ".join(output.split()))
    if found is None:
        return False
    return all(
        abs(float(given) - float(number)) <= 0.5001 * 10 ** -len(number.partition(".")[2])
        for number, given in zip(shown, found.groups(), strict=True)
    )


@pytest.fixture
def reader(tmp_path: Path, runtime_folder: Path) -> Iterator[Reader]:
    made = Reader(tmp_path, runtime_folder)
    yield made
    made.close()


WITH_COMMANDS = [page for page in PAGES if page.is_file() and commands(page)]


def _shows_messages(page: Path) -> bool:
    return any(_MESSAGE.search(command.expected) for command in commands(page))


@pytest.mark.parametrize(
    "page",
    [
        pytest.param(
            page,
            id=str(page.relative_to(ROOT)),
            marks=[pytest.mark.wording] if _shows_messages(page) else [],
        )
        for page in WITH_COMMANDS
    ],
)
def test_the_commands_of_a_page_do_what_it_says(page: Path, reader: Reader) -> None:
    for command in commands(page):
        reader.follow(command)


def test_the_extras_that_pages_install_exist() -> None:
    """pip only warns of an extra that does not exist."""
    known = importlib.metadata.metadata("cartwheel").get_all("Provides-Extra") or []
    named = {
        (str(page.relative_to(ROOT)), extra)
        for page in PAGES
        if page.is_file()
        for block in blocks(page, "console")
        for line in block.lines
        if line.startswith("$ pip install")
        for extras in re.findall(r"cartwheel\[([^\]]+)\]", line)
        for extra in extras.split(",")
    }
    assert {extra for _, extra in named} >= {"foxglove", "gym", "ray"}
    assert not {each for each in named if each[1] not in known}


def test_the_pages_show_commands() -> None:
    names = {page.name for page in WITH_COMMANDS}
    assert {"README.md", "07-drive.md"} <= names


@pytest.mark.parametrize(
    ("shown", "given", "fits"),
    [
        ("z: 9.8\n", "z: 9.799999\n", True),
        ("z: 9.8\n", "z: 9.7\n", False),
        ("z: 9.80\n", "z: 9.78\n", False),
        ("z: 9.8\n", "z: none\n", False),
        ("x: 0.0\n", "x: -1.2e-17\n", True),
        ("x: 0.0\n", "x: 1.2e17\n", False),
        ("a: 1\n...\nc: 3\n", "a: 1\nb: 2\nc: 3\n", True),
        ("a: 1\n", "a: 1\nb: 2\n", False),
        ("a  1\n", "a   1\n", True),
        ("", "anything", True),
    ],
)
def test_shown_output_that_differs_is_noticed(shown: str, given: str, fits: bool) -> None:
    assert matches(shown, given) is fits


@pytest.mark.parametrize("page", [page for page in PAGES if page.is_file()], ids=lambda p: p.name)
def test_shell_commands_are_in_console_blocks(page: Path) -> None:
    """So that none escapes being run."""
    for block in blocks(page):
        assert block.language not in ("sh", "bash", "shell", ""), (
            f"{block}: say ```console or ```text"
        )
