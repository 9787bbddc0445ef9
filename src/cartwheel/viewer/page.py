"""The page: one web server, one thread that does all of the viewer's work, errors as notes."""

from __future__ import annotations

import json
import logging
import queue
import socket
import threading
import time
from collections.abc import Callable, Coroutine
from functools import partial
from pathlib import Path
from typing import Any, TypeVar

from cartwheel.codes.recording import UPLOAD_REFUSED, VIEWER_FAULT
from cartwheel.errors import UNCLASSIFIED, CartwheelError, Code, Diagnostic
from cartwheel.gate.access import Access
from cartwheel.gate.listening import hidden_host
from cartwheel.viewer.every import Every
from cartwheel.viewer.inbox import Inbox

_log = logging.getLogger(__name__)
_FOLDER = Path(__file__).parent
_KEEP_SECONDS = 8.0
_BEAT = 1.0
"""s between two signs of life; `page.js` waits for ten of them."""
_LIGHTLY: Any = "f9"
"""Key of the command that a browser without a GPU gives by itself; viser's types know no F9."""

T = TypeVar("T")


def _title(code: Code, kind: str = "Error") -> str:
    return kind if code is UNCLASSIFIED else f"{kind} {code.number}"


class Page:
    """What the parts of the viewer share.

    viser calls back on a pool of threads and the simulation on its own; both only leave a
    note here, and `run` does what they say, one after the other, in order.

    Args:
        listener: Where browsers come.
        access: Who of them may.
        title: Of the browser's tab.
        keys: That are commands; every other key counts as ``k``.
        refused: Takes the origin of each web page that is refused, from any thread.
    """

    def __init__(
        self,
        listener: socket.socket,
        access: Access,
        *,
        title: str,
        keys: tuple[str, ...] = (),
        refused: Callable[[str], None] = lambda _: None,
    ) -> None:
        # 0.2 s that must not come before the simulation's first clock.
        import viser
        from viser import _messages

        from cartwheel.gate.gate import Gate

        self.viser = viser
        # Whatever knocks at the port, a scanner say: its errors are not for the terminal.
        logging.getLogger("websockets").addHandler(logging.NullHandler())
        host = hidden_host()
        self.server: Any = _quietly(lambda: viser.ViserServer(host, 0, verbose=False))
        self._gate = Gate(listener, access, (host, self.server.get_port()), refused=refused)
        self.url = access.url("http", listener.getsockname()[1])
        """Where browsers find it."""
        self._jobs: queue.SimpleQueue[tuple[Callable[[], object], int | None] | None]
        self._jobs = queue.SimpleQueue()
        self.inbox = Inbox(self.server, self._jobs.qsize, self._refuse, self._silent)
        self.gui: Any = self.server.gui
        self.scene: Any = self.server.scene
        self.clients: frozenset[int] = frozenset()
        """Browsers that are connected now."""
        self.on_clients: Callable[[], None] = lambda: None
        """Called when `clients` has changed."""
        self.on_silence: Callable[[int], None] = lambda _: None
        """Called with a browser's number when it does not answer any more, though connected."""
        self._client: int | None = None
        self.gui.configure_theme(
            show_logo=False, show_share_button=False, brand_color=(37, 99, 176)
        )
        self.gui.set_panel_label(title)
        # viser has a message to run a script of one's own in every browser that comes, though
        # no method for it; its plots are loaded that way.
        self.gui._websock_interface.queue_message(
            _messages.RunJavascriptMessage(source=_script(title, keys))
        )
        self._lightly: set[int] = set()
        lightly = self.gui.add_command(
            "Toggle shadows",
            description="Without a GPU, shadows double the rendering time",
            hotkey=_LIGHTLY,
        )
        lightly.on_trigger(self.on(self._draw_lightly))
        self._beats = 0
        self._beat_due = Every(1 / _BEAT)
        self._pulses: dict[int, Any] = {}
        self._toggles: dict[int, str] = {}
        self._cookie = f"cartwheel-view-{listener.getsockname()[1]}"
        self.server.on_client_connect(self._arrived)
        self.server.on_client_disconnect(self.on(self._disconnected))
        # On viser's own loop: no other thread takes Python's lock from the simulation.
        self._gate.start(self.server.get_event_loop())

    # -- work

    def run(self, stopped: threading.Event) -> None:
        """Does what was posted, until `stopped`."""
        while not stopped.is_set():
            try:
                job = self._jobs.get(timeout=_BEAT if self.clients else None)
            except queue.Empty:
                job = None
            self._beat(time.monotonic())
            if job is None:
                continue
            function, self._client = job
            try:
                function()
            except CartwheelError as error:
                self.show_error(error)
            except Exception as error:  # noqa: BLE001 - a fault here must not take the page away
                _log.exception("the viewer failed")
                self.show(VIEWER_FAULT.because("unexpected error in the viewer", error))

    def wake(self) -> None:
        """Lets `run` look whether it is to stop."""
        self._jobs.put(None)

    def post(self, function: Callable[[], object], *, client: int | None = None) -> None:
        """Runs a function on the page's thread, soon; from any thread.

        Args:
            function: What to do.
            client: The browser that asked for it, and that is told when it fails; None is all.
        """
        self._jobs.put((function, client))

    def on(self, function: Callable[[Any], object]) -> Callable[[Any], Coroutine[Any, Any, None]]:
        """A callback for viser that runs `function(event)` on the page's thread.

        It does nothing for a control that has been removed by then, as its browser left.
        """

        # A coroutine, as viser runs those in the order of their messages; plain functions go
        # to a pool, where a quick "stop" may overtake the "go" before it.
        async def callback(event: Any) -> None:
            self.post(
                lambda: _is_removed(event) or function(event),
                client=getattr(event, "client_id", None),
            )

        return callback

    def on_value(
        self, function: Callable[[Any, Any], object]
    ) -> Callable[[Any], Coroutine[Any, Any, None]]:
        """Like `on`, for `function(event, value)`: the value that the control had just been given.

        By the time the page's thread comes to it, a panel that follows the simulation may have
        set the control back.
        """

        async def callback(event: Any) -> None:
            value = event.target.value
            self.post(
                lambda: _is_removed(event) or function(event, value),
                client=getattr(event, "client_id", None),
            )

        return callback

    def do(
        self, function: Callable[..., object], *arguments: object
    ) -> Callable[[Any], Coroutine[Any, Any, None]]:
        """A callback for viser that runs `function(*arguments)` on the page's thread."""
        return self.on(lambda _: function(*arguments))

    def then(self, future: Any, function: Callable[[Any], None] = lambda _: None) -> None:
        """Runs `function(result)` on the page's thread when a simulation's answer is there."""
        client = self._client
        future.add_done_callback(
            lambda done: self.post(lambda: function(done.result()), client=client)
        )

    def _beat(self, now: float) -> None:
        """Lets the browsers know that they are still connected, also while nothing changes."""
        if self.clients and self._beat_due(now):
            self._beats += 1
            for pulse in self._pulses.values():
                pulse.content = _pulse(self._beats)

    # -- toggles

    def toggles(self, client: int) -> str:
        """What a browser has kept since `keep_toggles`; not checked."""
        return self._toggles.get(client, "")

    def keep_toggles(self, client: Any, text: str) -> None:
        """Lets a browser keep its toggles, over reloads and restarts of the simulation.

        Args:
            client: viser's handle.
            text: Letters and dots.
        """
        from viser import _messages

        script = f'document.cookie = "{self._cookie}={text}; Path=/; SameSite=Strict"'
        client._websock_connection.queue_message(_messages.RunJavascriptMessage(source=script))

    # -- notes

    def show_error(self, error: CartwheelError) -> None:
        """Tells whoever asked what went wrong."""
        self.notify(_title(error.code), str(error), color="red", seconds=12.0)

    def show(self, diagnostic: Diagnostic) -> None:
        """Shows an error, or a warning, to the browser that asked, or else to all."""
        is_error = diagnostic.severity == "error"
        hint = f"\n{diagnostic.hint}" if diagnostic.hint else ""
        self.notify(
            _title(diagnostic.code, "Error" if is_error else "Warning"),
            diagnostic.message + hint,
            color="red" if is_error else None,
        )

    def notify(
        self,
        title: str,
        body: str,
        *,
        color: str | None = None,
        seconds: float = _KEEP_SECONDS,
    ) -> None:
        """A note in the corner: for the browser that asked, else for all."""
        clients = self.server.get_clients()
        asked = clients.get(self._client) if self._client is not None else None
        for client in [asked] if asked is not None else clients.values():
            client.add_notification(title, body, color=color, auto_close_seconds=seconds)

    def _refuse(self, client: int, reason: str) -> None:
        """Says, from viser's thread, why a file was not taken."""
        self.post(partial(self.show, UPLOAD_REFUSED.diagnostic(reason)), client=client)

    def _silent(self, client: int) -> None:
        self.post(lambda: self.on_silence(client))

    # -- browsers

    async def _arrived(self, client: Any) -> None:
        """Comes before all else of a browser, on viser's thread, which also sees it leave."""
        # There viser would remove the browser's controls while the page's thread still writes to
        # them, which raises: that thread lets go of them itself, in `_disconnected`.
        client.gui._release_cross_scope_nesting = lambda: None
        # What is still written to a browser that is just leaving is no fault.
        client._websock_connection.get_message_buffer()._warned_push_after_done = True
        port = self.server._websock_server._live_connections[client.client_id].remote_address[1]
        toggles = self._gate.cookie(port, self._cookie)
        self.post(lambda: self._connected(client, toggles), client=client.client_id)

    def _connected(self, client: Any, toggles: str) -> None:
        self._toggles[client.client_id] = toggles
        self.clients |= {client.client_id}
        self._pulses[client.client_id] = client.gui.add_html(_pulse(0))
        self.on_clients()

    def _disconnected(self, client: Any) -> None:
        self.clients -= {client.client_id}
        self._lightly.discard(client.client_id)
        self._pulses.pop(client.client_id, None)
        self._toggles.pop(client.client_id, None)
        try:
            self.on_clients()
        finally:
            del client.gui._release_cross_scope_nesting
            client.gui._release_cross_scope_nesting()

    def _draw_lightly(self, event: Any) -> None:
        """For the browser that asks: the others may have a GPU."""
        self._lightly ^= {event.client_id}
        lightly = event.client_id in self._lightly
        event.client.scene.configure_default_lights(enabled=True, cast_shadow=not lightly)

    def close(self) -> None:
        """Ends the web server."""
        self._gate.close()
        _quietly(self.server.stop)


def _is_removed(event: Any) -> bool:
    """Whether the control that an event is about is no more."""
    target = getattr(event, "target", None)
    return bool(target is not None and target._impl.removed)


def _pulse(beats: int) -> str:
    return f'<i data-beat="{beats}"></i>'


def _script(title: str, keys: tuple[str, ...]) -> str:
    style = (_FOLDER / "page.css").read_text()
    script = (_FOLDER / "page.js").read_text()
    script = script.replace('"__TITLE__"', json.dumps(title))
    script = script.replace('"__STYLE__"', json.dumps(style))
    script = script.replace('"__LIGHTLY__"', json.dumps(_LIGHTLY))
    return script.replace("__KEYS__", json.dumps([*keys, " "] if keys else [" "]))


def _quietly(function: Callable[[], T]) -> T:
    """Without viser's own banner: the command line says where the page is."""
    import rich

    console = rich.get_console()
    before, console.quiet = console.quiet, True
    try:
        return function()
    finally:
        console.quiet = before
