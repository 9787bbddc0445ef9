"""Whether there is a desktop, on which a browser shows up before the user."""

from __future__ import annotations

import os
import sys


def is_desktop() -> bool:
    """Whether a browser can be expected to show up before the user."""
    return sys.stdout.isatty() and has_display()


def has_display() -> bool:
    """Whether windows that this process opens are before its user."""
    if "SSH_CONNECTION" in os.environ:
        return False
    return sys.platform == "darwin" or bool(
        os.environ.get("DISPLAY") or os.environ.get("WAYLAND_DISPLAY")
    )
