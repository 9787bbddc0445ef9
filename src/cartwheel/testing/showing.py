"""Shows the world of a test in the browser."""

from __future__ import annotations

import contextlib
import os
import sys
from typing import TYPE_CHECKING

import pytest

if TYPE_CHECKING:
    from cartwheel.api import World

_PATIENCE = 30.0
"""Wall time for which a test waits for a browser, s."""


def show(world: World, item: pytest.Item) -> None:
    """Shows a world in the browser, in real time.

    Raises:
        ControlError: The web interface cannot start.
    """
    url = world.show()
    world.pace = 1.0
    plugins = item.config.pluginmanager
    manager, reporter = plugins.getplugin("capturemanager"), plugins.getplugin("terminalreporter")
    with manager.global_and_fixture_disabled() if manager else contextlib.nullcontext():
        if reporter is not None:
            reporter.ensure_newline()
            reporter.write_line(f"{item.nodeid}: {url}")
        if sys.stderr.isatty():
            world.wait_for_browser(_PATIENCE)
    if os.environ.get("DISPLAY") or os.environ.get("WAYLAND_DISPLAY"):
        import webbrowser

        webbrowser.open(url)
