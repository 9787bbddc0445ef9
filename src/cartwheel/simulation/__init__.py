"""The simulation, which a single thread owns."""

import cartwheel.world  # noqa: F401 - imports MuJoCo as it must be
from cartwheel.simulation.dynamics.velocity_motor import MotorHandle
from cartwheel.simulation.handles import CameraHandle, LinkHandle
from cartwheel.simulation.part import Part
from cartwheel.simulation.simulation import Simulation
from cartwheel.simulation.snapshot import Contact, PlacedModel, RunState

__all__ = [
    "CameraHandle",
    "Contact",
    "LinkHandle",
    "MotorHandle",
    "Part",
    "PlacedModel",
    "RunState",
    "Simulation",
]
