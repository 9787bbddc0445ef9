"""Access to a running simulation from another process."""

from cartwheel.control.client import ControlClient, Sample
from cartwheel.control.registry import Running, find, running

__all__ = ["ControlClient", "Running", "Sample", "find", "running"]
