"""Notifications about the parts of a run."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from contextlib import AbstractContextManager
from pathlib import PurePath

from cartwheel.errors import Diagnostic
from cartwheel.gate.access import Access

AtEnd = Callable[[Callable[[], None]], AbstractContextManager[object]]
"""Creates a context manager that calls a function at its end. The command line's also calls it if
the process is terminated before."""


class Observer:
    """Is notified of what a run connects to; the methods of this class do nothing.

    The methods may be called on any thread.
    """

    def ros1_joined(self, node: str, master: str, *, own: bool, open_ports: Sequence[int]) -> None:
        """The run is a ROS 1 node.

        Args:
            node: Name of the node.
            master: URI of the ROS master.
            own: Whether Cartwheel started this master.
            open_ports: Ports that other computers can connect to.
        """

    def ros2_joined(self, node: str, where: str) -> None:
        """The run is a ROS 2 node, in a domain or at a router."""

    def disconnected(self, diagnostic: Diagnostic) -> None:
        """Another node has replaced the ROS 1 node, which ends the run."""

    def foxglove_served(self, url: str, access: Access) -> None:
        """Foxglove can connect."""

    def viewer_shown(self, url: str, access: Access) -> None:
        """Browsers can connect."""

    def page_refused(self, origin: str) -> None:
        """A web page of this origin was not allowed to connect to the viewer."""

    def recording_started(self, path: PurePath) -> None:
        """Messages are recorded to a file or folder."""

    def recording_ended(
        self, files: Sequence[PurePath], messages: int, topics: int, size: int
    ) -> None:
        """A recording is complete.

        Args:
            files: The written files.
            messages: Number of messages.
            topics: Number of topics.
            size: Bytes of the messages.
        """
