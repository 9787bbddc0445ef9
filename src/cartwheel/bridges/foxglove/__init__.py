"""The graph on Foxglove's WebSocket: for Foxglove, Lichtblick and whatever speaks it."""

from cartwheel.bridges.foxglove.bridge import FoxgloveBridge
from cartwheel.bridges.foxglove.controls import Controls

__all__ = ["Controls", "FoxgloveBridge"]
