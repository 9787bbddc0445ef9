"""The graph on Foxglove's WebSocket protocol, for Foxglove, Lichtblick and compatible clients."""

from cartwheel.bridges.foxglove.bridge import FoxgloveBridge

__all__ = ["FoxgloveBridge"]
