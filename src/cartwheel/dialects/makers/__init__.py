"""Plugins that makers of robots and sensors publish."""
