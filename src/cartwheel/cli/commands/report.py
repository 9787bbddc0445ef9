"""The terminal output of a run: what was loaded, addresses, suggestions and results."""

from __future__ import annotations

import sys
from collections.abc import Sequence
from pathlib import PurePath
from typing import TYPE_CHECKING
from urllib.parse import urlsplit

from cartwheel.assembly.names import world_title
from cartwheel.assembly.observer import Observer
from cartwheel.cli.commands.grouping import grouped
from cartwheel.cli.console import (
    is_terminal,
    note,
    paint,
    say,
    table,
)
from cartwheel.cli.showing import print_diagnostic
from cartwheel.codes.command import OTHER_SIMULATION_RUNNING
from cartwheel.control.registry import Running
from cartwheel.dialects.ros_control.files import ControllerFiles
from cartwheel.gate.access import Access, refused_page

if TYPE_CHECKING:
    from cartwheel.description.model import RobotDescription
    from cartwheel.errors import Diagnostic
    from cartwheel.session import Session

_TOPICS = 12
"""The maximum number of topics that are listed."""


def size_text(size: int) -> str:
    """A number of bytes with a readable unit."""
    if size < 1000:
        return f"{size} B"
    if size < 1_000_000:
        return f"{size / 1e3:.1f} kB"
    return f"{size / 1e6:.1f} MB" if size < 1_000_000_000 else f"{size / 1e9:.2f} GB"


class Report(Observer):
    """Prints the lines of a run; without colours and suggestions if there is no terminal.

    Args:
        verbose: Print informational messages too.
    """

    def __init__(self, *, verbose: bool) -> None:
        self._verbose = verbose
        self._decorated = is_terminal(sys.stdout) and sys.stdin.isatty()

    def others(self, others: Sequence[Running]) -> None:
        """Says that this is not the only simulation."""
        print_diagnostic(
            OTHER_SIMULATION_RUNNING.diagnostic(
                "another simulation is running, so commands such as cartwheel topic require --sim",
                hint="\n".join(["Running simulations:", *(f"    {entry}" for entry in others)]),
            )
        )

    def loaded(self, session: Session, name: str | None, *, ros: bool = False) -> None:
        """Prints the models of the world, the diagnostics and suggestions.

        Args:
            session: The loaded session.
            name: Name of the robot.
            ros: Whether ROS is available to start the controllers.
        """
        simulation = session.simulation
        self._line("world", f"{world_title(simulation.world)}{self._inhabitants(session, name)}")
        for placed in simulation.scene.models:
            if placed.name == name:
                description = placed.description
                mass = f"{description.mass:.4g} kg"
                self._line("robot", f"{name}, {mass}, {description.parts}")
        started = session.shared.get(ControllerFiles).started
        if started:
            self._line("control", ", ".join(each.name for each in started))
        elif name is not None and not ros:
            self._controllers(session, name)
        shown = session.diagnostics if self._verbose else grouped(session.diagnostics)
        for diagnostic in shown:
            self.diagnostic(diagnostic)
        simulation.engine.on_diagnostic.append(self.diagnostic)
        self._topics(session)

    def launched(self, file: PurePath, *, models: bool) -> None:
        """Prints the launch file, and that its other nodes do not start."""
        started = "models and their controllers are" if models else "world is"
        self._line("launch", f"{file}; only its {started} started")

    def viewer_shown(self, url: str, access: Access) -> None:
        """Prints the address of the viewer, and who can connect."""
        self._line("viewer", paint(url, "bold", "cyan"))
        self._open(access, url)
        if self._decorated:
            say(paint("\nPress Ctrl-C to stop.", "dim"))

    def ros1_joined(self, node: str, master: str, *, own: bool, open_ports: Sequence[int]) -> None:
        """Prints the ROS 1 node, its master, and the ports that are open to other computers."""
        self._line("ros 1", f"{node} at {master}{', started by Cartwheel' if own else ''}")
        if open_ports:
            ports = ", ".join(map(str, open_ports))
            self._line("", f"open to other computers without a password: ports {ports}")
            self._line("", "set ROS_HOSTNAME=localhost to allow only this computer")

    def _open(self, access: Access, url: str) -> None:
        if access.is_open:
            parts = urlsplit(url)
            url = access.url(parts.scheme, parts.port or 0, elsewhere=True)
            self._line("", f"open to other computers with the token: {url}")

    def page_refused(self, origin: str) -> None:
        """Reports the origin of a refused web page."""
        self.diagnostic(refused_page("the web interface", origin))

    def foxglove_served(self, url: str, access: Access) -> None:
        """Prints the address of the Foxglove server, and who can connect."""
        self._line("foxglove", paint(url, "bold", "cyan"))
        self._open(access, url)

    def recording_started(self, path: PurePath) -> None:
        """Prints the file of a recording."""
        self._line("record", str(path))

    def recording_ended(
        self, files: Sequence[PurePath], messages: int, topics: int, size: int
    ) -> None:
        """Prints the contents of a finished recording."""
        names = ", ".join(map(str, files))
        contents = f"{messages} messages on {topics} topics"
        say(f"recorded {contents}, {size_text(size)} before compression, to {names}")

    def ros2_joined(self, node: str, where: str) -> None:
        """Prints the ROS 2 node, and its domain or router."""
        self._line("ros 2", f"{node} on {where}")

    def disconnected(self, diagnostic: Diagnostic) -> None:
        """Prints why ROS 1 ended the run."""
        print_diagnostic(diagnostic)

    def diagnostic(self, diagnostic: Diagnostic) -> None:
        """Prints a diagnostic."""
        if diagnostic.severity != "info" or self._verbose:
            print_diagnostic(diagnostic)
        if diagnostic.details and self._verbose:
            note(diagnostic.details)

    def ended(self, session: Session, wall: float) -> None:
        """Prints the simulated time and the speed."""
        seconds = session.simulation.time_ns / 1e9
        factor = f", {seconds / wall:.1f} times real time" if wall > 0 else ""
        say(f"simulated {seconds:.3f} s in {wall:.3f} s{factor}")

    def _controllers(self, session: Session, name: str) -> None:
        """Prints how to start a robot's controllers, which a launch file does in ROS."""
        description = next(
            each.description for each in session.simulation.scene.models if each.name == name
        )
        offers = (service.name for service in session.graph.services())
        if not any(offer.endswith("/controller_manager/load_controller") for offer in offers):
            if not description.plugins:
                self._no_manager(description)
            return
        from cartwheel.dialects.ros_control.selection import selection_near
        from cartwheel.dialects.ros_control.suggestion import suggested

        automatic = bool(selection_near(description).names)
        files = ["auto"] if automatic else [str(file) for file in suggested(description)]
        self._line("control", "no controllers are running; in ROS, launch files start them")
        words = " ".join(f"--controllers {file}" for file in files) or "--controllers FILE.yaml"
        self._line("try", words)

    def _no_manager(self, description: RobotDescription) -> None:
        """Prints the plugin that is missing in a robot with controllers but without plugins."""
        tag, plugin = "<ros2_control>", "gz_ros2_control-system"
        if not description.ros2_control:
            tag, plugin = "<transmission>", "libgazebo_ros_control.so"
            if not description.transmissions:
                return
        self._line("control", f"no plugin reads the {tag} tags, so no joint is driven")
        self._line("try", f'<gazebo><plugin filename="{plugin}" name="control">…')

    def _inhabitants(self, session: Session, name: str | None) -> str:
        others = [model for model in session.simulation.models if model != name]
        if not others:
            return ""
        more = f" and {len(others) - 6} more" if len(others) > 6 else ""
        return f" with {', '.join(others[:6])}{more}"

    def _topics(self, session: Session) -> None:
        topics = [topic for topic in session.graph.topics() if topic.name != "/clock"]
        rows = []
        for topic in topics[:_TOPICS]:
            rate = f"{topic.rate:g} Hz" if topic.rate else ""
            sense = "" if topic.publishers else "subscribed"
            rows.append([topic.name, topic.type.replace("/msg/", "/"), rate or sense])
        if rows:
            for line in table(rows).splitlines():
                self._line("topic", line)
        if len(topics) > _TOPICS:
            self._line("", f"and {len(topics) - _TOPICS} more; to list all: cartwheel topic list")
        if self._decorated:
            self._try(session)

    def _try(self, session: Session) -> None:
        topics = session.graph.topics()
        if any(topic.drives for topic in topics):
            self._line("try", "cartwheel teleop")
        published = [topic.name for topic in topics if topic.publishers]
        for wanted in ("odom", "imu", "image", "clock"):
            name = next((name for name in published if wanted in name), None)
            if name:
                self._line("try", f"cartwheel topic {'hz' if wanted == 'image' else 'echo'} {name}")
                return

    @staticmethod
    def _line(title: str, text: str) -> None:
        say(f"{paint(title.ljust(7), 'dim')} {text}")
