"""The Python API: worlds, models and simulation time."""

from cartwheel.api.built import Built, build
from cartwheel.api.model import Model
from cartwheel.api.world import World

__all__ = ["Built", "Model", "World", "build"]
