"""The web interface's server, the thread that does all of its work, and error notifications."""

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
from cartwheel.forks import AddressSockets
from cartwheel.gate.access import Access
from cartwheel.gate.listening import hidden_host
from cartwheel.viewer import viser_internals
from cartwheel.viewer.every import Every
from cartwheel.viewer.inbox import Inbox

_log = logging.getLogger(__name__)
_FOLDER = Path(__file__).parent
_KEEP_SECONDS = 8.0
_BEAT = 1.0
"""Interval of heartbeats, s; `page.js` disconnects after ten missing ones."""
_SHADOWS: Any = "f9"
"""Key for the command that a browser with a GPU sends itself; viser's types do not include F9."""

T = TypeVar("T")


def _title(code: Code, kind: str = "Error") -> str:
    return kind if code is UNCLASSIFIED else f"{kind} {code.number}"


class Page:
    """Shared services of the viewer's parts.

    viser calls callbacks on a thread pool and the simulation on its own thread. Both only queue
    jobs here, and `run` executes them in order.

    Args:
        listener: The socket for browsers.
        access: Who may connect.
        title: Title of the browser's tab.
        keys: Keys with commands; all other keys count as ``k``.
        refused: Called with the origin of each rejected web page, on any thread.
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
        # The import takes 0.2 s, which must not delay the simulation's first clock message.
        import viser

        from cartwheel.gate.gate import Gate

        self.viser = viser
        viser_internals.open_icons_once()
        # Errors of arbitrary connections, such as port scanners, are not printed in the terminal.
        logging.getLogger("websockets").addHandler(logging.NullHandler())
        host = hidden_host()
        self.server: Any = _quietly(lambda: viser.ViserServer(host, 0, verbose=False))
        hidden = (host, self.server.get_port())
        # viser opens these sockets itself.
        self._parental = AddressSockets(hidden)
        self._gate = Gate(listener, access, hidden, refused=refused)
        self.url = access.url("http", listener.getsockname()[1])
        """URL for browsers."""
        self._jobs: queue.SimpleQueue[tuple[Callable[[], object], int | None] | None]
        self._jobs = queue.SimpleQueue()
        self.inbox = Inbox(self.server, self._jobs.qsize, self._refuse, self._silent)
        self.gui: Any = self.server.gui
        self.scene: Any = self.server.scene
        self.clients: frozenset[int] = frozenset()
        """The connected browsers."""
        self.on_clients: Callable[[], None] = lambda: None
        """Called when `clients` has changed."""
        self.on_silence: Callable[[int], None] = lambda _: None
        """Called with the number of a connected browser that no longer responds."""
        self._client: int | None = None
        self.gui.configure_theme(
            show_logo=False, show_share_button=False, brand_color=(37, 99, 176)
        )
        self.gui.set_panel_label(title)
        viser_internals.run_in_new_browsers(self.gui, _script(title, keys))
        show = self.gui.add_command(
            "Show shadows",
            description="Without a GPU, shadows double the rendering time",
            hotkey=_SHADOWS,
        )
        show.on_trigger(self.on(lambda event: self._show_shadows(event.client, shown=True)))
        hide = self.gui.add_command("Hide shadows")
        hide.on_trigger(self.on(lambda event: self._show_shadows(event.client, shown=False)))
        self._beats = 0
        self._beat_due = Every(1 / _BEAT)
        self._pulses: dict[int, Any] = {}
        self._toggles: dict[int, str] = {}
        self._cookie = f"cartwheel-view-{listener.getsockname()[1]}"
        self.server.on_client_connect(self._arrived)
        self.server.on_client_disconnect(self.on(self._disconnected))
        # On viser's own loop, so that no additional thread competes with the simulation for the
        # GIL.
        self._gate.start(self.server.get_event_loop())

    # -- work

    def run(self, stopped: threading.Event) -> None:
        """Executes posted jobs until `stopped` is set."""
        while not stopped.is_set():
            try:
                job = self._jobs.get(timeout=_BEAT if self.clients else None)
            except queue.Empty:
                job = None
            self._execute(lambda: self._beat(time.monotonic()), None)
            if job is not None:
                self._execute(*job)

    def _execute(self, function: Callable[[], object], client: int | None) -> None:
        """Calls a function for a browser, and shows its errors there."""
        self._client = client
        try:
            function()
        except CartwheelError as error:
            self.show_error(error)
        except Exception as error:  # noqa: BLE001 - a fault here must not take the page away
            _log.exception("the web interface failed")
            self.show(VIEWER_FAULT.because("unexpected error in the web interface", error))

    def wake(self) -> None:
        """Wakes `run` to check whether to stop."""
        self._jobs.put(None)

    def post(self, function: Callable[[], object], *, client: int | None = None) -> None:
        """Queues a function for the page's thread. Thread-safe.

        Args:
            function: The function.
            client: The browser to notify about errors; None for all.
        """
        self._jobs.put((function, client))

    def on(self, function: Callable[[Any], object]) -> Callable[[Any], Coroutine[Any, Any, None]]:
        """A viser callback that runs `function(event)` on the page's thread.

        It does nothing if the control was removed meanwhile because its browser left.
        """

        # viser runs coroutines in the order of their messages. Plain functions run in a pool, where
        # a "stop" may overtake the preceding "go".
        async def callback(event: Any) -> None:
            self.post(
                lambda: _is_removed(event) or function(event),
                client=getattr(event, "client_id", None),
            )

        return callback

    def on_value(
        self,
        function: Callable[[Any, Any], object],
        *,
        read: Callable[[Any], object] = lambda control: control.value,
    ) -> Callable[[Any], Coroutine[Any, Any, None]]:
        """Like `on`, for `function(event, value)` with the control's value at the time of the
        event.

        When the page's thread runs the function, a panel that follows the simulation may have reset
        the control, or the user may have used it again.

        Args:
            function: The function.
            read: Returns the value of a control, or the pose of a gizmo; called on viser's thread.
        """

        async def callback(event: Any) -> None:
            value = read(event.target)
            self.post(
                lambda: _is_removed(event) or function(event, value),
                client=getattr(event, "client_id", None),
            )

        return callback

    def do(
        self, function: Callable[..., object], *arguments: object
    ) -> Callable[[Any], Coroutine[Any, Any, None]]:
        """A viser callback that runs `function(*arguments)` on the page's thread."""
        return self.on(lambda _: function(*arguments))

    def then(self, future: Any, function: Callable[[Any], None] = lambda _: None) -> None:
        """Runs `function(result)` on the page's thread when the simulation's response arrives."""
        client = self._client
        future.add_done_callback(
            lambda done: self.post(lambda: function(done.result()), client=client)
        )

    def _beat(self, now: float) -> None:
        """Sends heartbeats to the browsers, so that they detect a lost connection even if nothing
        changes.
        """
        if self.clients and self._beat_due(now):
            self._beats += 1
            for pulse in self._pulses.values():
                pulse.content = _pulse(self._beats)

    # -- toggles

    def toggles(self, client: int) -> str:
        """The toggles that a browser stored with `keep_toggles`; not validated."""
        return self._toggles.get(client, "")

    def keep_toggles(self, client: Any, text: str) -> None:
        """Stores a browser's toggles across reloads and restarts of the simulation.

        Args:
            client: The viser client handle.
            text: Letters and dots.
        """
        script = f'document.cookie = "{self._cookie}={text}; Path=/; SameSite=Strict"'
        viser_internals.run_in_browser(client, script)

    # -- notes

    def show_error(self, error: CartwheelError) -> None:
        """Shows an error to the browser that caused it."""
        self.notify(_title(error.code), str(error), color="red", seconds=12.0)

    def show(self, diagnostic: Diagnostic) -> None:
        """Shows a diagnostic to the browser that caused it, or to all browsers."""
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
        """Shows a notification in the browser that caused it, or in all browsers."""
        clients = self.server.get_clients()
        asked = clients.get(self._client) if self._client is not None else None
        for client in [asked] if asked is not None else clients.values():
            client.add_notification(title, body, color=color, auto_close_seconds=seconds)

    def _refuse(self, client: int, reason: str) -> None:
        """Shows why a file was rejected; called on viser's thread."""
        self.post(partial(self.show, UPLOAD_REFUSED.diagnostic(reason)), client=client)

    def _silent(self, client: int) -> None:
        self.post(lambda: self.on_silence(client))

    # -- browsers

    async def _arrived(self, client: Any) -> None:
        """Runs before anything else for a browser, on viser's thread, which also handles its
        departure.
        """
        # viser would remove the browser's controls there while the page's thread still writes to
        # them, which raises an error. The page's thread removes them in `_disconnected`.
        viser_internals.keep_controls(client)
        # Writing to a browser that is just disconnecting is not an error.
        viser_internals.allow_late_writes(client)
        connection = viser_internals.websocket(self.server, client.client_id)
        port = connection.remote_address[1]
        toggles = self._gate.cookie(port, self._cookie)
        self.post(lambda: self._connected(client, toggles), client=client.client_id)

    def _connected(self, client: Any, toggles: str) -> None:
        self._toggles[client.client_id] = toggles
        self.clients |= {client.client_id}
        # A browser must not show a control before its callback is set: viser ignores its use until
        # then.
        with client.atomic():
            self._pulses[client.client_id] = client.gui.add_html(_pulse(0))
            self.on_clients()

    def _disconnected(self, client: Any) -> None:
        self.clients -= {client.client_id}
        self._pulses.pop(client.client_id, None)
        self._toggles.pop(client.client_id, None)
        try:
            self.on_clients()
        finally:
            viser_internals.remove_controls(client)

    def _show_shadows(self, client: Any, *, shown: bool) -> None:
        """Only for the requesting browser: others may have no GPU."""
        client.scene.configure_default_lights(enabled=True, cast_shadow=shown)

    def close(self) -> None:
        """Stops the web server."""
        self._gate.close()
        _quietly(self.server.stop)


def _is_removed(event: Any) -> bool:
    """Whether the event's control has been removed."""
    target = getattr(event, "target", None)
    return bool(target is not None and viser_internals.is_removed(target))


def _pulse(beats: int) -> str:
    return f'<i data-beat="{beats}"></i>'


def _script(title: str, keys: tuple[str, ...]) -> str:
    style = (_FOLDER / "page.css").read_text()
    script = (_FOLDER / "page.js").read_text()
    script = script.replace('"__TITLE__"', json.dumps(title))
    script = script.replace('"__STYLE__"', json.dumps(style))
    script = script.replace('"__SHADOWS__"', json.dumps(_SHADOWS))
    return script.replace("__KEYS__", json.dumps([*keys, " "] if keys else [" "]))


def _quietly(function: Callable[[], T]) -> T:
    """Suppresses viser's banner: the command line prints the URL."""
    import rich

    console = rich.get_console()
    before, console.quiet = console.quiet, True
    try:
        return function()
    finally:
        console.quiet = before
