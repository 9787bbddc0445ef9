"""Topics to files and back: MCAP, ROS 1's bags, ROS 2's bags."""

from cartwheel.bridges.recording.formats import ENCODINGS, Encoding
from cartwheel.bridges.recording.recorder import Recorder

__all__ = ["ENCODINGS", "Encoding", "Recorder"]
