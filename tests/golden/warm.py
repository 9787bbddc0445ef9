"""Loads what every measurement needs, once, in the process from which the others are forked.

Reading the message types takes ten times as long as the simulation of a small robot. Nothing is
rendered here, because OpenGL does not work after a fork.
"""

from .subjects import ROBOTS, Subject
from .trial import measure

measure(
    Subject(
        key="warm",
        kind="robot",
        robot=ROBOTS / "libgazebo_ros_diff_drive.urdf",
        seconds=0.1,
    )
)
