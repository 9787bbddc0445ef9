"""The graph on Foxglove's WebSocket protocol, for Foxglove, Lichtblick and compatible clients."""

from cartwheel.bridges.foxglove.bridge import FoxgloveBridge
from cartwheel.bridges.foxglove.controls import Controls

__all__ = ["Controls", "FoxgloveBridge"]
