"""The physics of many worlds on a GPU, by MuJoCo Warp."""

from cartwheel.batch.warp.library import unsupported
from cartwheel.batch.warp.physics import WarpPhysics

__all__ = ["WarpPhysics", "unsupported"]
