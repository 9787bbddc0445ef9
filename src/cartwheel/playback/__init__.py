"""A recording in a simulation's place: the same topics, at the times that they had."""

from cartwheel.playback.player import Player
from cartwheel.playback.session import PlaybackSession

__all__ = ["PlaybackSession", "Player"]
