"""One browser at the page: what it alone sees, and what it alone has chosen."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

from cartwheel.viewer.display import Display
from cartwheel.viewer.page import Page


class Seat:
    """A browser that is connected.

    What all browsers share is sent once for all of them. What differs from it is made in this
    browser's own scene, where a node hides that of the same name that all have.

    Args:
        page: That it shows.
        client: viser's handle.
    """

    def __init__(self, page: Page, client: Any) -> None:
        self.number: int = client.client_id
        self.client = client
        self.gui: Any = client.gui
        self.scene: Any = client.scene
        self.display = Display.of(page.toggles(self.number))
        self._blanks: dict[str, dict[str, Any]] = {}

    def hide(self, kind: str, nodes: Iterable[str]) -> None:
        """Hides these of the nodes that all have, and no others of their kind.

        Args:
            kind: A name for the nodes that are given together.
            nodes: Their names.
        """
        blanks = self._blanks.setdefault(kind, {})
        wanted = set(nodes)
        for name in set(blanks) - wanted:
            blanks.pop(name).remove()
        for name in wanted - set(blanks):
            blanks[name] = self.scene.add_frame(name, show_axes=False)

    def set_clickable(self, handles: Iterable[Any], clickable: bool) -> None:
        """Lets clicks on nodes that all have pass through them in this browser.

        Args:
            handles: viser's, of the nodes.
            clickable: Whether they take clicks.
        """
        # viser has no method for it: bindings are of a node, and nodes here are of all browsers.
        from viser import _messages

        for handle in handles:
            bindings = handle._impl._last_published_click_bindings or ()
            self.client._websock_connection.queue_message(
                _messages.SetSceneNodeClickBindingsMessage(
                    handle.name, bindings if clickable else ()
                )
            )
