"""Whatever comes to the page's port: nothing ends, grows or is printed."""

from __future__ import annotations

import contextlib
import itertools
import os
import random
import socket
import subprocess
from collections.abc import Iterator
from pathlib import Path

import msgspec
import pytest
import viser
from tests.viewer.browsing import CAMERA
from tests.viewer.running import running
from websockets.exceptions import WebSocketException
from websockets.sync.client import connect


@pytest.fixture
def page(tmp_path: Path) -> Iterator[tuple[subprocess.Popen[str], int]]:
    """A simulation with its page, and the port."""
    with running(tmp_path) as started:
        yield started.process, started.port


def memory(process: subprocess.Popen[str]) -> int:
    """Bytes that are resident."""
    pages = int(Path(f"/proc/{process.pid}/statm").read_text().split()[1])
    return pages * os.sysconf("SC_PAGESIZE")


def garbage(dice: random.Random) -> bytes | str:
    """Noise, text, and messages of wrong kinds."""
    values: list[object] = [1, None, "a", [1], [[]], {"a": 1}, {"type": "GuiUpdateMessage"}]
    kinds = ("ViewerCameraMessage", "GuiUpdateMessage", "NoSuchMessage", 5)
    values.append([{"type": dice.choice(kinds), "uuid": "x", "updates": {"value": [1]}}])
    noise = dice.randbytes(dice.randrange(1, 400))
    return dice.choice((noise, "x" * 99, msgspec.msgpack.encode(dice.choice(values))))


def test_garbage_ends_nothing_and_is_not_printed(page: tuple[subprocess.Popen[str], int]) -> None:
    process, port = page
    dice = random.Random(1)
    protocol = f"viser-v{viser.__version__}"

    def attack(rounds: int) -> None:
        for _ in range(rounds):
            with socket.create_connection(("127.0.0.1", port), timeout=60) as raw:
                raw.sendall(dice.randbytes(dice.randrange(600)))
            with (
                contextlib.suppress(WebSocketException, OSError),
                connect(
                    f"ws://127.0.0.1:{port}",
                    subprotocols=[protocol],
                    max_size=None,
                    close_timeout=0.2,
                ) as link,
            ):
                if dice.random() < 0.5:
                    link.send(msgspec.msgpack.encode(CAMERA))
                for _ in range(20):
                    link.send(garbage(dice))

    # What is used for the first time, such as the camera's renderer, comes at any time and once;
    # what leaks grows in each round.
    sizes = [memory(process)]
    for _ in range(4):
        attack(10)
        sizes.append(memory(process))
    growths = [after - before for before, after in itertools.pairwise(sizes)]
    assert min(growths) < 10 << 20, growths
    # One that takes nothing, while another is served.
    with (
        connect(
            f"ws://127.0.0.1:{port}",
            subprotocols=[protocol],
            max_size=None,
            close_timeout=0.2,
            max_queue=1,
        ) as frozen,
        connect(
            f"ws://127.0.0.1:{port}", subprotocols=[protocol], max_size=None, close_timeout=0.2
        ) as link,
    ):
        assert len(link.recv(timeout=60)) > 0
        frozen.socket.close()
    process.terminate()
    out, _ = process.communicate(timeout=60)
    assert process.returncode == 0
    assert "Traceback" not in out, out
