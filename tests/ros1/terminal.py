"""A terminal that commands are typed into, as a learner does."""

from __future__ import annotations

import codecs
import os
import pty
import re
import signal
import subprocess
import threading
import time
import uuid
from collections.abc import Mapping
from pathlib import Path

ESCAPES = re.compile(r"\x1b(\[[0-9;?]*[A-Za-z]|\][^\x07]*\x07|[=>])|\r")


class Terminal:
    """An interactive bash behind a pseudo-terminal.

    What is shown is read at all times, as by a real terminal: a program whose terminal is full
    waits.

    Args:
        environment: Of the shell.
        folder: Where it starts.
    """

    def __init__(self, environment: Mapping[str, str], folder: Path) -> None:
        self.said = ""
        """All that it has shown so far, without colours."""
        self._mark_text = f"TEST_TERMINAL={uuid.uuid4().hex}"
        name, _, value = self._mark_text.partition("=")
        self._master, slave = pty.openpty()
        self._process = subprocess.Popen(
            ["bash", "--norc", "--noprofile", "-i"],
            stdin=slave,
            stdout=slave,
            stderr=slave,
            env={**environment, "PS1": "$ ", "TERM": "xterm", name: value},
            cwd=folder,
            start_new_session=True,
        )
        os.close(slave)
        self._mark = 0
        self._arrived = threading.Condition()
        self._reader = threading.Thread(target=self._keep_reading, daemon=True)
        self._reader.start()

    def _keep_reading(self) -> None:
        decoder = codecs.getincrementaldecoder("utf-8")("replace")
        while True:
            try:
                data = os.read(self._master, 65536)
            except OSError:  # nobody writes any more
                return
            if not data:
                return
            with self._arrived:
                self.said += ESCAPES.sub("", decoder.decode(data))
                self._arrived.notify_all()

    def type(self, command: str) -> None:
        """Types a line and the return key."""
        self.forget()
        os.write(self._master, command.encode() + b"\n")

    def forget(self) -> None:
        """Lets `read` and `wait_for` look only at what is shown from now on."""
        with self._arrived:
            self._mark = len(self.said)

    def press(self, keys: str) -> None:
        """Presses keys, without return."""
        os.write(self._master, keys.encode())

    def interrupt(self) -> None:
        """Presses Ctrl-C."""
        os.write(self._master, b"\x03")

    def close_command(self) -> None:
        """Interrupts what runs and waits until it has ended."""
        self.interrupt()
        self._until_idle(15.0)

    def read(self, seconds: float) -> str:
        """What was shown since the last command; waits at most `seconds` for anything new."""
        with self._arrived:
            if seconds:
                self._arrived.wait(seconds)
            return self.said[self._mark :]

    def wait_for(self, pattern: str, seconds: float = 120.0) -> re.Match[str]:
        """Waits until a regular expression is shown after the last command.

        Raises:
            AssertionError: It did not come; with all that came.
        """
        until = time.monotonic() + seconds
        while True:
            match = re.search(pattern, self.read(0.05))
            if match:
                return match
            shown = self.said[self._mark :]
            assert time.monotonic() < until, f"no {pattern!r} in {seconds} s, but:\n{shown}"

    def run(self, command: str, seconds: float = 120.0) -> str:
        """Types a command, waits for it to end, and returns what it showed.

        Raises:
            AssertionError: It failed or did not end.
        """
        # The marks are written in two parts: the shell shows the line it was given, too.
        self.type(f"echo be''gins; {command}; echo en''ded-with-$?")
        match = self.wait_for(r"(?s)\nbegins\n(.*)ended-with-(\d+)\n", seconds)
        assert match[2] == "0", f"{command} ended with {match[2]}:\n{match[1]}"
        return match[1]

    def close(self) -> None:
        """Ends what runs in it, politely and then not."""
        for number in (signal.SIGINT, signal.SIGTERM, signal.SIGKILL):
            self._signal(number)
            if number is signal.SIGINT:
                self._until_idle(15.0)
        self._process.wait()
        self._reader.join(15.0)
        os.close(self._master)

    def children(self) -> list[int]:
        """Process ids of all that was started here and still runs, but for the shell."""
        return [pid for pid in _marked(self._mark_text) if pid != self._process.pid]

    def _until_idle(self, seconds: float) -> None:
        until = time.monotonic() + seconds
        while self.children() and time.monotonic() < until:
            self.read(0.1)

    def _signal(self, number: signal.Signals) -> None:
        if number is signal.SIGINT and self._process.poll() is None:
            self.interrupt()
            return
        for pid in _marked(self._mark_text):
            try:
                os.kill(pid, number)
            except ProcessLookupError:
                continue


def _marked(mark: str) -> list[int]:
    """Processes that were started with this mark in their environment, wherever they went."""
    found = []
    for folder in Path("/proc").glob("[0-9]*"):
        try:
            if mark.encode() in (folder / "environ").read_bytes():
                found.append(int(folder.name))
        except OSError:
            continue
    return sorted(found)
