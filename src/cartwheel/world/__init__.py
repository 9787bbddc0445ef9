"""Compiles descriptions to a MuJoCo model."""

from cartwheel.world import mujoco_import  # noqa: F401 - before all others
from cartwheel.world.actuation import rotor_strength, stiffen_rotors
from cartwheel.world.additions import reports
from cartwheel.world.build import (
    Build,
    build,
    build_visuals,
    exclude_rotors,
    extend_at_rest,
)
from cartwheel.world.chains import drag_chains
from cartwheel.world.inertials import Principal, principal_inertial
from cartwheel.world.unused import unreadable, unused

__all__ = [
    "Build",
    "Principal",
    "build",
    "build_visuals",
    "drag_chains",
    "exclude_rotors",
    "extend_at_rest",
    "principal_inertial",
    "reports",
    "rotor_strength",
    "stiffen_rotors",
    "unreadable",
    "unused",
]
