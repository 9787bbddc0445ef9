"""Compiles descriptions to a MuJoCo model."""

from cartwheel.world import mujoco_import  # noqa: F401 - before all others
from cartwheel.world.additions import reports
from cartwheel.world.build import Build, build, build_visuals
from cartwheel.world.entry import CameraMount, ModelEntry, Motor
from cartwheel.world.unused import unreadable, unused

__all__ = [
    "Build",
    "CameraMount",
    "ModelEntry",
    "Motor",
    "build",
    "build_visuals",
    "reports",
    "unreadable",
    "unused",
]
