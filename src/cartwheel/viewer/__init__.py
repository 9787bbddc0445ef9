"""The viewer in the browser: one more client of a session."""

from cartwheel.viewer.viewer import Viewer

__all__ = ["Viewer"]
