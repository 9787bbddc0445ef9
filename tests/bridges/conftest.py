"""Simulations with a bridge, in a thread of the test."""

from __future__ import annotations

import contextlib
import threading
from collections.abc import Callable, Iterator

import pytest
from tests.bridges.ros1_peers import REASON, Master, wait_for

from cartwheel.bridges.ros1 import Ros1Bridge
from cartwheel.description import load_robot, load_world
from cartwheel.errors import Diagnostic
from cartwheel.session import Session


@pytest.fixture(scope="module")
def master(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Master]:
    """A ROS 1 master for the tests of a file."""
    if REASON:
        pytest.skip(REASON)
    made = Master(tmp_path_factory.mktemp("ros"))
    yield made
    made.kill()


class Bridged:
    """A simulation that runs in real time on a thread, with its bridge."""

    def __init__(self, robot: bool, node: str, arguments: tuple[str, ...]) -> None:
        self.session = Session(load_world("empty"))
        if robot:
            self.session.spawn(load_robot("rosbots.xacro"))
        self.graph = self.session.graph
        self.simulation = self.session.simulation
        self.reports: list[Diagnostic] = []
        self.ended: list[str] = []
        self.bridge = Ros1Bridge(
            self.graph,
            node=node,
            arguments=arguments,
            report=self.reports.append,
            time_ns=lambda: self.simulation.time_ns,
            on_end=self.ended.append,
        )
        self._thread = threading.Thread(target=self._own)

    def start(self) -> None:
        self.bridge.start()
        self._thread.start()

    def close(self) -> None:
        self.bridge.close()
        self.simulation.post(self.simulation.stop)
        self._thread.join()

    def _own(self) -> None:
        self.session.pacer().run()
        self.session.close()

    def wanted(self, topic: str) -> bool:
        """Whether the simulation would publish on a topic."""
        return any(p.wanted for p in self.graph._topics[topic].publishers)

    def told(self, text: str) -> int:
        """How often a report with this text was made."""
        return sum(text in report.message for report in self.reports)


Bridge = Callable[..., Bridged]


@pytest.fixture
def bridge(master: Master, monkeypatch: pytest.MonkeyPatch) -> Iterator[Bridge]:
    """Makes simulations with bridges, and ends them."""
    monkeypatch.setenv("ROS_MASTER_URI", master.uri)
    monkeypatch.setenv("ROS_HOSTNAME", "127.0.0.1")
    with contextlib.ExitStack() as stack:

        def make(
            *arguments: str, robot: bool = True, node: str = "gazebo", start: bool = True
        ) -> Bridged:
            made = Bridged(robot, node, arguments)
            stack.callback(made.close if start else made.session.close)
            if start:
                made.start()
                wait_for(lambda: "/clock" in master.types(), "the registration")
            return made

        yield make
