"""The simulation, which a single thread owns."""

import cartwheel.world  # noqa: F401 - imports MuJoCo as it must be
from cartwheel.simulation.handles import CameraHandle, JointHandle, LinkHandle, MotorHandle
from cartwheel.simulation.part import Part
from cartwheel.simulation.simulation import Simulation
from cartwheel.simulation.snapshot import Contact, PlacedModel, RunState, Scene, Snapshot

__all__ = [
    "CameraHandle",
    "Contact",
    "JointHandle",
    "LinkHandle",
    "MotorHandle",
    "Part",
    "PlacedModel",
    "RunState",
    "Scene",
    "Simulation",
    "Snapshot",
]
