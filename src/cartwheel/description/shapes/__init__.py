"""Polylines, heightmaps and texture coordinates."""
