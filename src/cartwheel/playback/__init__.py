"""Playback of recordings: the same topics and times as in the recorded simulation."""

from cartwheel.playback.session import PlaybackSession

__all__ = ["PlaybackSession"]
