"""Triangles of shapes, polylines, heightmaps and texture coordinates."""
