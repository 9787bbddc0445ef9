"""Saves the state of a session, and restores it bit for bit."""

from cartwheel.saving.restoring import restore
from cartwheel.saving.state import State, save

__all__ = ["State", "restore", "save"]
