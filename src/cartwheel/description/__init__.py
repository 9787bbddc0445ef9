"""From the user's files to what they say: xacro, URDF with ``<gazebo>`` tags, SDF, meshes."""

from cartwheel.description.loading import (
    load,
    load_plain,
    load_robot,
    load_text,
    load_world,
)

__all__ = ["load", "load_plain", "load_robot", "load_text", "load_world"]
