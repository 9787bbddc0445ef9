"""URDF with its ``<gazebo>`` tags."""

from cartwheel.description.urdf.reading import read_urdf

__all__ = ["read_urdf"]
