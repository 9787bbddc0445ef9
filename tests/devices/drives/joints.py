"""Joints of drives for tests."""

from dataclasses import dataclass


@dataclass
class Joint:
    """A joint whose state a test sets."""

    position: float = 0.0
    velocity: float = 0.0
    command: float = 0.0
