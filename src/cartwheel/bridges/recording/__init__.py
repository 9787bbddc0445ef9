"""Recording and reading topics: MCAP, ROS 1 bags, ROS 2 bags."""

from cartwheel.bridges.recording.formats import ENCODINGS, Encoding
from cartwheel.bridges.recording.recorder import Recorder

__all__ = ["ENCODINGS", "Encoding", "Recorder"]
