"""Sensors of gz-sim that need no plugin."""
