"""Plugins of gz-sim for vehicles on tracks, boats and multicopters."""
