"""Files that browsers upload in parts, with limits during the upload."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

from cartwheel.errors import Pickled
from cartwheel.viewer.viser_internals import discard_upload, end_upload

PART_BYTES = 512 * 1024
"""Size of each part except the last, as viser's client splits a file."""
MOST_BYTES = 20_000_000
"""Maximum file size."""
MOST_AT_ONCE = 4
"""Maximum simultaneous uploads of all browsers; each browser uploads one file at a time."""
SILENCE = 60.0
"""Timeout after which an incomplete upload is discarded, s."""


class UploadError(Pickled, Exception):
    """A rejected file, or a rejected part of a file.

    Args:
        reason: The reason, for the user.
        tell: Whether to show the reason; False if it was already shown.
    """

    def __init__(self, reason: str, *, tell: bool = True) -> None:
        super().__init__(reason)
        self.tell = tell


@dataclass
class _Upload:
    component: str
    transfer: str
    size: int
    parts: int
    seen: set[int] = field(default_factory=set)
    timer: Any = None


class Uploads:
    """The current upload of each browser, with its progress.

    viser stores the parts; it receives only parts of uploads that were announced here.

    Args:
        server: The viser server.
    """

    def __init__(self, server: Any) -> None:
        self._server = server
        self._by_client: dict[int, _Upload] = {}

    def start(self, client: int, component: str, transfer: str, size: int, parts: int) -> None:
        """Accepts a file.

        Args:
            client: The browser's number.
            component: The upload button.
            transfer: Name of the upload.
            size: Announced size, bytes.
            parts: Announced number of parts.

        Raises:
            UploadError: The file cannot be accepted.
        """
        upload = _Upload(component, transfer, size, parts)
        reason = self._refusal(client, upload)
        if reason is not None:
            self._release(client, upload)
            raise UploadError(reason)
        if parts:
            self._by_client[client] = upload
            self._wait(client, upload)

    def add(self, client: int, transfer: str, index: int, length: int) -> None:
        """Accepts a part.

        Raises:
            UploadError: The part was not announced; the whole upload is discarded.
        """
        upload = self._by_client.get(client)
        if upload is None or upload.transfer != transfer:
            # For example a part of a rejected file: the browser sends all parts at once.
            raise UploadError("A part of an unknown or rejected upload was received.", tell=False)
        expected = min(PART_BYTES, upload.size - index * PART_BYTES)
        if index in upload.seen or length != expected:
            self.drop(client)
            raise UploadError(
                "The transfer failed: a part of the file has the wrong size or was sent twice. "
                "Upload the file again."
            )
        upload.seen.add(index)
        upload.timer.cancel()
        if len(upload.seen) == upload.parts:
            del self._by_client[client]
        else:
            self._wait(client, upload)

    def drop(self, client: int) -> None:
        """Discards a browser's upload."""
        upload = self._by_client.pop(client, None)
        if upload is None:
            return
        upload.timer.cancel()
        handles = [self._server.gui]
        connected = self._server.get_clients().get(client)
        if connected is not None:
            handles.append(connected.gui)
        for gui in handles:
            discard_upload(gui, upload.transfer)
        self._release(client, upload)

    def _refusal(self, client: int, upload: _Upload) -> str | None:
        """Why a file cannot be accepted, or None."""
        if upload.size > MOST_BYTES:
            most = MOST_BYTES // 1_000_000
            return f"The file is too large ({upload.size / 1e6:.1f} MB). The limit is {most} MB."
        if upload.parts != -(-upload.size // PART_BYTES):
            return "The transfer failed: the number of parts does not match the size of the file."
        if client in self._by_client:
            return "This browser is already uploading a file."
        if len(self._by_client) >= MOST_AT_ONCE:
            return f"Too many simultaneous uploads; the limit is {MOST_AT_ONCE}. Try again later."
        return None

    def _release(self, client: int, upload: _Upload) -> None:
        """Enables the browser's button again, which waits for the end of the upload."""
        connected = self._server.get_clients().get(client)
        if connected is None:
            return
        end_upload(connected, upload.component, upload.transfer)

    def _wait(self, client: int, upload: _Upload) -> None:
        loop = self._server.get_event_loop()
        upload.timer = loop.call_later(SILENCE, self.drop, client)
