"""A browser without a screen: what viser's page says and hears, over its websocket."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Any

import msgspec
import viser
import zstandard
from websockets.sync.client import ClientConnection, connect

CAMERA: dict[str, Any] = {
    "type": "ViewerCameraMessage",
    "wxyz": [1.0, 0.0, 0.0, 0.0],
    "position": [1, 2.0, 3.0],
    "fov": 0.8,
    "near": 0.01,
    "far": 1000,
    "image_height": 480,
    "image_width": 640,
    "look_at": [0.0, 0.0, 0.0],
    "up_direction": [0.0, 0.0, 1.0],
}


class Browser:
    """One connection; it keeps the page's controls as they come."""

    def __init__(self, link: ClientConnection) -> None:
        self.link = link
        self.messages: list[dict[str, Any]] = []

    def send(self, message: object) -> None:
        self.link.send(msgspec.msgpack.encode(message))

    def look(self) -> None:
        """Says from where it looks: only then it counts as connected."""
        self.send(CAMERA)

    def hear(self, wanted: Callable[[dict[str, Any]], bool], seconds: float = 60) -> dict[str, Any]:
        """The first message of a kind, of those that came and those that come."""
        for message in self.messages:
            if wanted(message):
                return message
        deadline = time.monotonic() + seconds
        while True:
            assert time.monotonic() < deadline, "it did not come"
            data = self.link.recv(timeout=seconds)
            assert isinstance(data, bytes)
            size = int.from_bytes(data[8:16], "little")
            inner = zstandard.ZstdDecompressor().decompress(data[16 : 16 + size])
            new = msgspec.msgpack.decode(inner)["messages"]
            self.messages += new
            for message in new:
                if wanted(message):
                    return message

    def control(self, label: str) -> str:
        """The name by which messages mean a control."""
        found = self.hear(lambda m: "uuid" in m and (m.get("props") or {}).get("label") == label)
        return str(found["uuid"])


@contextmanager
def browsing(port: int, **options: Any) -> Iterator[Browser]:
    """Connects as a browser does."""
    with connect(
        f"ws://127.0.0.1:{port}",
        subprotocols=[f"viser-v{viser.__version__}"],  # type: ignore[list-item]
        max_size=None,
        # Tests read late: neither frames that wait nor a silent moment end a connection.
        max_queue=None,
        ping_interval=None,
        close_timeout=0.2,
        open_timeout=60,
        **options,
    ) as link:
        yield Browser(link)
