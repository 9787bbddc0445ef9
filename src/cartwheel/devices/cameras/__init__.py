"""Cameras: lenses, images, depths and their messages."""
