"""Validates messages from browsers before viser: types, values, sizes and permissions.

viser sets any property in a message, uses assertions for other checks, buffers parts of files
without limit and opens a public tunnel on request. Only messages that this web interface can send
are passed on. Others are dropped and counted, with one warning.
"""

from __future__ import annotations

import asyncio
import contextlib
import logging
import math
from collections.abc import Callable
from functools import partial
from typing import Annotated, Any

import msgspec
from websockets.exceptions import WebSocketException

from cartwheel.codes.wires import MALFORMED_MESSAGE
from cartwheel.viewer.uploads import PART_BYTES, UploadError, Uploads
from cartwheel.viewer.viser_internals import control, watch_connections
from cartwheel.viewer.viser_internals import websocket as websocket_of

MOST_BYTES = PART_BYTES + 4096
"""Maximum message size: a part of a file is the largest message."""
MOST_WAITING = 500
"""Maximum queued jobs of the page's thread; above it, no messages are read from browsers."""
_PATIENCE = 0.02
"""Interval of the checks whether the queue is shorter, s."""

SILENCE = 10.0
"""s; a browser that does not respond for this time counts as gone, and its robot is stopped."""
_ASKED_EVERY = 2.0
"""Interval of pings, s."""

_log = logging.getLogger(__name__)

_Name = Annotated[str, msgspec.Meta(max_length=1000)]
_Number = Annotated[float, msgspec.Meta(ge=-1e6, le=1e6)]
_Part = Annotated[float, msgspec.Meta(ge=-1.001, le=1.001)]
_Place = tuple[_Number, _Number, _Number]
_Turn = tuple[_Part, _Part, _Part, _Part]
_Count = Annotated[int, msgspec.Meta(ge=0, le=1 << 40)]


class Incoming(msgspec.Struct, tag_field="type", forbid_unknown_fields=True):
    """A message from a browser."""


class Camera(Incoming, tag="ViewerCameraMessage"):
    """The browser's camera has moved."""

    wxyz: _Turn
    position: _Place
    fov: Annotated[float, msgspec.Meta(gt=0, lt=math.pi)]
    near: Annotated[float, msgspec.Meta(gt=0, le=1e6)]
    far: Annotated[float, msgspec.Meta(gt=0, le=1e6)]
    image_height: Annotated[float, msgspec.Meta(ge=0, le=1e5)]
    image_width: Annotated[float, msgspec.Meta(ge=0, le=1e5)]
    look_at: _Place
    up_direction: _Place


class Change(Incoming, tag="GuiUpdateMessage"):
    """A control was used."""

    uuid: _Name
    updates: dict[_Name, bool | int | float | _Name]


class Command(Incoming, tag="CommandTriggerMessage"):
    """A key or an entry in the command list was used."""

    uuid: _Name


class Click(Incoming, tag="SceneNodeClickMessage"):
    """A click in the scene."""

    name: _Name
    instance_index: int | None
    ray_origin: _Place
    ray_direction: _Place
    screen_pos: tuple[_Number, _Number]
    modifier: _Name | None
    owner: _Name = ""


class Drag(Incoming, tag="TransformControlsUpdateMessage"):
    """A gizmo was moved."""

    name: _Name
    wxyz: _Turn
    position: _Place
    owner: _Name = ""


class DragStart(Incoming, tag="TransformControlsDragStartMessage"):
    """A gizmo drag has started."""

    name: _Name
    owner: _Name = ""


class DragEnd(Incoming, tag="TransformControlsDragEndMessage"):
    """A gizmo drag has ended."""

    name: _Name
    owner: _Name = ""


class UploadStart(Incoming, tag="FileTransferStartUpload"):
    """A file upload has started."""

    source_component_uuid: _Name
    transfer_uuid: _Name
    filename: _Name
    mime_type: _Name
    part_count: _Count
    size_bytes: _Count


class UploadPart(Incoming, tag="FileTransferPart"):
    """A part of a file."""

    source_component_uuid: _Name
    transfer_uuid: _Name
    part_index: _Count
    content: bytes


_DECODER = msgspec.msgpack.Decoder(
    Camera | Change | Command | Click | Drag | DragStart | DragEnd | UploadStart | UploadPart
)


class MalformedError(Exception):
    """A message that this web interface cannot have sent."""


class Inbox:
    """Filters the messages between a server's connections and viser.

    Args:
        server: The viser server.
        waiting: Returns the number of queued jobs of the page's thread.
        refused: Called with a browser's number and a message for its user.
        silent: Called with the number of a browser that did not respond for `SILENCE` s.
    """

    def __init__(
        self,
        server: Any,
        waiting: Callable[[], int],
        refused: Callable[[int, str], None],
        silent: Callable[[int], None],
    ) -> None:
        self.dropped = 0
        """Number of dropped messages."""
        self._server = server
        self._waiting = waiting
        self._refused = refused
        self._uploads = Uploads(server)
        self._silent = silent
        self._known: set[int] = set()
        self._watches: dict[int, asyncio.Task[None]] = {}
        # Remaining errors concern only the sender and are not printed in the terminal.
        watch_connections(server, self._attach, self._detach, self._failed)

    def check(self, client: int, raw: object) -> None:
        """Validates a message.

        Args:
            client: The browser's number.
            raw: The received data.

        Raises:
            MalformedError: The web interface cannot have sent the message.
            UploadError: The message belongs to a file that cannot be accepted.
        """
        if not isinstance(raw, bytes):
            raise MalformedError("text")
        try:
            message = _DECODER.decode(raw)
        except (msgspec.DecodeError, RecursionError, ValueError) as error:
            raise MalformedError(str(error)) from error
        if isinstance(message, Camera):
            if not any(message.wxyz):
                raise MalformedError("the quaternion of the browser's camera is zero")
            # viser treats a browser as connected only from here on, and cleans up after it.
            self._known.add(client)
            return
        if client not in self._known:
            raise MalformedError(f"{type(message).__name__} before the first camera")
        if isinstance(message, Change):
            self._check_change(client, message)
        if isinstance(message, UploadStart):
            self._uploads.start(
                client,
                message.source_component_uuid,
                message.transfer_uuid,
                message.size_bytes,
                message.part_count,
            )
        elif isinstance(message, UploadPart):
            self._uploads.add(
                client, message.transfer_uuid, message.part_index, len(message.content)
            )

    def _check_change(self, client: int, message: Change) -> None:
        if list(message.updates) != ["value"]:
            raise MalformedError("browsers may not set this property")
        handle = self._control(client, message.uuid)
        if handle is None:
            return  # the control was just removed; viser ignores the message
        value, now = message.updates["value"], handle.value
        options = getattr(handle, "options", None)
        if options is not None:
            fits = value in options
        elif isinstance(now, bool):
            fits = isinstance(value, bool)
        elif isinstance(now, int | float) and isinstance(value, int | float):
            low, high = getattr(handle, "min", -1e6), getattr(handle, "max", 1e6)
            slack = 1e-6 * (1 + high - low)
            fits = not isinstance(value, bool) and low - slack <= value <= high + slack
        else:
            fits = False
        if not fits:
            raise MalformedError("the value does not fit this control element of the page")

    def _control(self, client: int, uuid: str) -> Any:
        """A control that a browser may use: shared ones and its own."""
        shared = control(self._server.gui, uuid)
        own = self._server.get_clients().get(client)
        if shared is not None or own is None:
            return shared
        return control(own.gui, uuid)

    async def _attach(self, connection: Any) -> None:
        client = connection.client_id
        websocket = websocket_of(self._server, client)
        websocket.protocol.max_message_size = MOST_BYTES
        websocket.recv = partial(self._receive, client, websocket.recv)
        self._watches[client] = asyncio.create_task(self._watch(client, websocket))

    async def _detach(self, connection: Any) -> None:
        self._watches.pop(connection.client_id).cancel()
        self._known.discard(connection.client_id)
        self._uploads.drop(connection.client_id)

    async def _receive(self, client: int, receive: Callable[[], Any]) -> bytes:
        """The next valid message."""
        while True:
            while self._waiting() > MOST_WAITING:
                await asyncio.sleep(_PATIENCE)
            raw: bytes = await receive()
            try:
                self.check(client, raw)
            except UploadError as error:
                if error.tell:
                    self._refused(client, str(error))
            except MalformedError as error:
                self._drop(str(error))
            else:
                return raw

    async def _watch(self, client: int, websocket: Any) -> None:
        """Pings the browser itself, not a script in the page, to check the connection."""
        with contextlib.suppress(WebSocketException):
            while True:
                pong = await websocket.ping()
                try:
                    await asyncio.wait_for(asyncio.shield(pong), SILENCE)
                except TimeoutError:
                    self._silent(client)
                    await pong
                await asyncio.sleep(_ASKED_EVERY)

    def _failed(self, _loop: object, context: dict[str, Any]) -> None:
        _log.debug("viser failed: %s", context.get("message"), exc_info=context.get("exception"))
        self._drop(f"viser failed: {context.get('exception') or context.get('message')!r}")

    def _drop(self, reason: str) -> None:
        self.dropped += 1
        if self.dropped == 1:
            shown = reason[:200].replace("\n", " ")
            ignored = MALFORMED_MESSAGE.diagnostic(
                f"the web interface ignored a malformed message ({shown}); from now on, malformed "
                "messages are ignored without a warning",
                values={"reason": shown},
            )
            _log.warning("%s", ignored.text)
