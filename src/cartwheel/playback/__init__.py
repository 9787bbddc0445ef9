"""Playback of recordings: the same topics and times as in the recorded simulation."""

from cartwheel.playback.player import Player
from cartwheel.playback.session import PlaybackSession

__all__ = ["PlaybackSession", "Player"]
