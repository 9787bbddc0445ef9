"""Parameter studies: a function of a world for many cases, on all cores."""

from cartwheel.sweeps.results import Results, Row
from cartwheel.sweeps.study import sweep

__all__ = ["Results", "Row", "sweep"]
