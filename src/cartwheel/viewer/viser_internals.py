"""All uses of viser's internals. Other modules of the viewer use its public interface.

viser has no public way to run a script in a browser, to see messages before it handles them, or to
finish an upload. pyproject.toml limits viser to the minor version that these functions were written
for.
"""

from __future__ import annotations

import asyncio
import contextlib
import functools
import io
import threading
import types
import zipfile
from collections.abc import Callable, Coroutine
from typing import Any


@functools.cache
def open_icons_once() -> None:
    """Lets viser open its archive of icons once, instead of once for each icon.

    Opening it takes 17 ms, because it has 4,300 entries. It is read from memory, because processes
    that are forked share the position in a file.
    """
    from viser import _icons

    icons: Any = _icons
    # Without the archive, viser reports the error.
    with contextlib.suppress(OSError, zipfile.BadZipFile):
        data = (icons.ICONS_DIR / "tabler-icons.zip").read_bytes()
        archive = contextlib.nullcontext(zipfile.ZipFile(io.BytesIO(data)))
        icons.zipfile = types.SimpleNamespace(ZipFile=lambda _file: archive)


def run_in_new_browsers(gui: Any, source: str) -> None:
    """Runs JavaScript in each browser that connects from now on."""
    from viser import _messages

    # viser loads its plots in this way.
    gui._websock_interface.queue_message(_messages.RunJavascriptMessage(source=source))


def run_in_browser(client: Any, source: str) -> None:
    """Runs JavaScript in one browser."""
    from viser import _messages

    client._websock_connection.queue_message(_messages.RunJavascriptMessage(source=source))


def set_clickable(client: Any, handle: Any, clickable: bool) -> None:
    """Sets whether one browser reports clicks on a scene node. viser has this only for all."""
    from viser import _messages

    bindings = handle._impl._last_published_click_bindings or ()
    client._websock_connection.queue_message(
        _messages.SetSceneNodeClickBindingsMessage(handle.name, bindings if clickable else ())
    )


def end_upload(client: Any, component: str, transfer: str) -> None:
    """Enables the upload button of a browser again, and removes the progress notification."""
    from viser import _messages

    queue = client._websock_connection.queue_message
    queue(_messages.FileTransferPartAck(component, transfer, 0, 0))
    queue(_messages.RemoveNotificationMessage(f"upload-{transfer}"))


def discard_upload(gui: Any, transfer: str) -> None:
    """Discards the received parts of a file."""
    gui._current_file_upload_states.pop(transfer, None)


def allow_late_writes(client: Any) -> None:
    """Suppresses viser's warning about messages to a browser that is disconnecting."""
    client._websock_connection.get_message_buffer()._warned_push_after_done = True


def keep_controls(client: Any) -> None:
    """Keeps viser from removing a browser's controls, until `remove_controls`."""
    client.gui._release_cross_scope_nesting = lambda: None


def remove_controls(client: Any) -> None:
    """Removes the controls of a browser that has disconnected."""
    del client.gui._release_cross_scope_nesting
    client.gui._release_cross_scope_nesting()


def is_removed(handle: Any) -> bool:
    """Whether a control has been removed."""
    return bool(handle._impl.removed)


def control(gui: Any, uuid: str) -> Any:
    """The control with this identifier, or None."""
    return gui._gui_input_handle_from_uuid.get(uuid)


def websocket(server: Any, client: int) -> Any:
    """The connection of a browser, an object of the package websockets."""
    return server._websock_server._live_connections[client]


def watch_connections(
    server: Any,
    attach: Callable[[Any], Coroutine[Any, Any, None]],
    detach: Callable[[Any], Coroutine[Any, Any, None]],
    failed: Callable[[asyncio.AbstractEventLoop, dict[str, Any]], None],
) -> None:
    """Calls functions for each connection, before viser handles its messages.

    Any thread can send messages to these connections.

    Args:
        server: The viser server.
        attach: Called with a new connection.
        detach: Called with a closed connection.
        failed: Handles exceptions in the server's event loop.
    """
    websockets = server._websock_server
    _wake_on(websockets._server_thread, websockets)
    # Before viser waits for messages to the new browser.
    websockets.on_client_connect(lambda made: _wake_on(websockets._server_thread, made))
    websockets.on_client_connect(attach)
    websockets.on_client_disconnect(detach)
    websockets._background_event_loop.set_exception_handler(failed)
    # Browsers that connected before this point must reconnect.
    websockets.disconnect_all_clients()


class _ThreadEvent(asyncio.Event):
    """An event that takes effect only if its loop's thread sets it.

    viser's `AsyncMessageBuffer.push` sets its event on the calling thread, and then posts the same
    call to the loop. The first call would wake the waiting tasks from the wrong thread: while it
    iterates over them, the loop removes and adds tasks, and the call raises a RuntimeError. The
    posted call is sufficient.
    """

    def __init__(self, thread: threading.Thread) -> None:
        super().__init__()
        self._thread = thread.ident

    def set(self) -> None:
        if threading.get_ident() == self._thread:
            super().set()


def _wake_on(thread: threading.Thread, receiver: Any) -> None:
    """Lets only the event loop's thread wake the tasks that send messages to browsers."""
    receiver.get_message_buffer().message_event = _ThreadEvent(thread)
