"""Plugins of gz-sim for the forces of water and air."""
