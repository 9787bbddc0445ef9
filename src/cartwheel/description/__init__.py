"""Reads descriptions from files: xacro, URDF with ``<gazebo>`` tags, SDF and meshes."""

from cartwheel.description.loading import (
    load,
    load_plain,
    load_robot,
    load_text,
    load_world,
)

__all__ = ["load", "load_plain", "load_robot", "load_text", "load_world"]
