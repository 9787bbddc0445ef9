"""The web viewer, a client of a session."""

from cartwheel.viewer.description_viewer import DescriptionViewer
from cartwheel.viewer.viewer import Viewer

__all__ = ["DescriptionViewer", "Viewer"]
