"""The connections that are requested at the start of a run."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING

from cartwheel.assembly.middleware import Rmw, check_rmw
from cartwheel.assembly.processes import Kind
from cartwheel.assembly.recording import RecordingOptions, check_recordings

if TYPE_CHECKING:
    from cartwheel.assembly.assembly import Assembly


@dataclass(frozen=True, kw_only=True, slots=True)
class Plan:
    """The connections that a program or the command line requests at the start."""

    ros1: str | None = None
    """Name of the ROS 1 node."""
    ros1_arguments: tuple[str, ...] = ()
    """Remappings and parameters of the ROS 1 node, each as ``name:=value``."""
    ros2: str | None = None
    """Name of the ROS 2 node."""
    rmw: Rmw = "dds"
    foxglove: int | None = None
    """Port of the Foxglove server."""
    viewer: bool = False
    viewer_port: int | None = None
    """Port of the viewer; None for the first free port."""
    recordings: tuple[Path, ...] = ()
    recording: RecordingOptions = field(default_factory=RecordingOptions)

    @property
    def bridges(self) -> Iterator[Kind | Path]:
        """The bridges, and the paths of recordings."""
        if self.ros1 is not None:
            yield "ros1"
        if self.ros2 is not None:
            yield "ros2"
        if self.foxglove is not None:
            yield "foxglove"
        yield from self.recordings

    def check(self) -> None:
        """Checks the values before a process is started.

        Raises:
            CartwheelError: A value is invalid, or Foxglove's library is not installed.
        """
        if self.ros2 is not None:
            check_rmw(self.rmw)
        if self.recordings:
            check_recordings(self.recordings, self.recording)
        if self.foxglove is not None:
            from cartwheel.bridges.foxglove.bridge import require

            require()

    def connect(self, assembly: Assembly, *, end_ns: int | None = None) -> None:
        """Opens all connections except the viewer.

        Args:
            assembly: The assembly of a session that is attached.
            end_ns: The simulation time at which the run ends, for Foxglove's time line.

        Raises:
            CartwheelError: A connection fails.
        """
        if self.ros1 is not None:
            assembly.connect_ros1(self.ros1, self.ros1_arguments)
        if self.ros2 is not None:
            assembly.connect_ros2(self.ros2, self.rmw)
        if self.foxglove is not None:
            assembly.serve_foxglove(self.foxglove, end_ns=end_ns)
        for path in self.recordings:
            assembly.record(path, self.recording)
