"""A connected browser: its own view and choices."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

from cartwheel.viewer.display import Display
from cartwheel.viewer.page import Page
from cartwheel.viewer.viser_internals import set_clickable


class Seat:
    """A connected browser.

    Shared nodes are sent once for all browsers. Differences are drawn in this browser's own scene,
    where a node hides the shared node with the same name.

    Args:
        page: The page that it shows.
        client: The viser client handle.
    """

    def __init__(self, page: Page, client: Any) -> None:
        self.number: int = client.client_id
        self.client = client
        self.gui: Any = client.gui
        self.scene: Any = client.scene
        self.display = Display.of(page.toggles(self.number))
        self._blanks: dict[str, dict[str, Any]] = {}

    def hide(self, kind: str, nodes: Iterable[str]) -> None:
        """Hides these shared nodes, and shows all others of the same kind.

        Args:
            kind: A name for the set of nodes.
            nodes: Node names.
        """
        blanks = self._blanks.setdefault(kind, {})
        wanted = set(nodes)
        for name in set(blanks) - wanted:
            blanks.pop(name).remove()
        for name in wanted - set(blanks):
            blanks[name] = self.scene.add_frame(name, show_axes=False)

    def set_clickable(self, handles: Iterable[Any], clickable: bool) -> None:
        """Sets whether clicks on shared nodes select them or pass through in this browser.

        Args:
            handles: viser handles of the nodes.
            clickable: Whether they receive clicks.
        """
        for handle in handles:
            set_clickable(self.client, handle, clickable)
