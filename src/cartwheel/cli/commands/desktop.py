"""Detects whether a browser would be visible to the user."""

from __future__ import annotations

import os
import sys


def is_desktop() -> bool:
    """Whether an opened browser is likely to be visible to the user."""
    return sys.stdout.isatty() and has_display()


def has_display() -> bool:
    """Whether windows opened by this process are visible to the user."""
    if "SSH_CONNECTION" in os.environ:
        return False
    return sys.platform == "darwin" or bool(
        os.environ.get("DISPLAY") or os.environ.get("WAYLAND_DISPLAY")
    )
