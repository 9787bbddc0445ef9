"""A learner's desk: terminals that share a master, and a screen."""

from __future__ import annotations

import contextlib
import os
import shutil
import subprocess
import tempfile
from collections.abc import Iterator
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from PIL import ImageGrab
from tests.reserved import free_port
from tests.ros1.conftest import ROOT
from tests.ros1.terminal import Terminal

Pixels = NDArray[np.uint8]


class Desk:
    """A learner's desk: terminals that share a master, and a screen."""

    def __init__(self, folder: Path, display: str) -> None:
        self.folder = folder
        self.display = display
        self._open = contextlib.ExitStack()
        # Sockets have short paths.
        runtime = self._open.enter_context(tempfile.TemporaryDirectory(prefix="cw", dir="/tmp"))
        self.environment = {
            **{key: os.environ[key] for key in ("PATH", "LANG") if key in os.environ},
            "PATH": f"/usr/bin:/bin:{os.environ['PATH']}",
            "HOME": str(folder),
            "ROS_MASTER_URI": f"http://127.0.0.1:{free_port()}",
            "ROS_HOSTNAME": "127.0.0.1",
            "LIBGL_ALWAYS_SOFTWARE": "1",
            "XDG_RUNTIME_DIR": runtime,
        }

    def terminal(self, *, display: bool = False) -> Terminal:
        """A new one in the workspace, with its setup sourced."""
        screen = {"DISPLAY": self.display} if display else {}
        terminal = Terminal({**self.environment, **screen}, ROOT / "ros1")
        self._open.callback(terminal.close)
        terminal.run("source devel/setup.bash")
        return terminal

    def look(self) -> Pixels:
        """The screen, shape (height, width, 3)."""
        image = ImageGrab.grab(xdisplay=self.display).convert("RGB")
        image.save(self.folder / "screen.png")
        return np.asarray(image)

    def close(self) -> None:
        self._open.close()


@contextlib.contextmanager
def open_desk(folder: Path) -> Iterator[Desk]:
    """A desk with a screen in memory where Xvfb is installed."""
    display = ""
    screen = None
    if shutil.which("Xvfb"):
        # It takes a number that nobody has, and writes it once it can be used.
        screen = subprocess.Popen(
            ["Xvfb", "-displayfd", "1", "-screen", "0", "1280x900x24", "-nolisten", "tcp"],
            stdout=subprocess.PIPE,
            stderr=subprocess.DEVNULL,
            text=True,
        )
        assert screen.stdout is not None
        display = f":{screen.stdout.readline().strip()}"
    desk = Desk(folder, display)
    try:
        yield desk
    finally:
        desk.close()
        if screen is not None:
            screen.terminate()
            screen.wait()
