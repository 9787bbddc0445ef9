"""SDF models and worlds."""

from cartwheel.description.sdf.reading import read_sdf

__all__ = ["read_sdf"]
