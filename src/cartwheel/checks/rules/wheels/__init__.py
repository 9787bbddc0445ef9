"""Wheels and tracks that drive a robot."""
