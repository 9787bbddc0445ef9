"""Launch files that do not start a robot, because a file that they need does not exist.

From roslaunch, launch and Gazebo: roslaunch stops at an include, a ``<rosparam>``, a ``textfile``
or a command whose file is missing, and so does launch in ROS 2 at an included file, a command and
``open``. Gazebo ends if it does not find its world.
"""

from __future__ import annotations

from collections.abc import Iterator

from cartwheel.checks.rule import rule
from cartwheel.checks.subject import Subject
from cartwheel.codes.files import LAUNCH_STOPS
from cartwheel.description.launches import stopping
from cartwheel.description.model import RobotDescription
from cartwheel.errors import Diagnostic


@rule(LAUNCH_STOPS)
def launch_files(subject: Subject) -> Iterator[Diagnostic]:
    """Finds what is missing for the launch file that starts a robot."""
    if isinstance(subject.read, RobotDescription):
        yield from stopping(subject.launch)
