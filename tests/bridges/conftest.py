"""Simulations with a bridge, in a thread of the test."""

from __future__ import annotations

import contextlib
from collections.abc import Callable, Iterator

import pytest
from tests.bridges.ros1_peers import REASON, Master, wait_for
from tests.bridges.running import Running
from tests.coded import coded

from cartwheel.bridges.ros1 import Ros1Bridge
from cartwheel.errors import Code, Diagnostic, Value


@pytest.fixture(scope="module")
def master(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Master]:
    """A ROS 1 master for the tests of a file."""
    if REASON:
        pytest.skip(REASON)
    made = Master(tmp_path_factory.mktemp("ros"))
    yield made
    made.kill()


class Bridged(Running):
    """A simulation with a bridge to ROS 1."""

    bridge: Ros1Bridge

    def __init__(self, robot: bool, node: str, arguments: tuple[str, ...]) -> None:
        super().__init__(robot=robot)
        self.ended: list[Diagnostic] = []
        self.bridge = Ros1Bridge(
            self.graph,
            node=node,
            arguments=arguments,
            report=self.reports.append,
            time_ns=lambda: self.simulation.time_ns,
            on_end=self.ended.append,
        )

    def wanted(self, topic: str) -> bool:
        """Whether the simulation would publish on a topic."""
        return any(p.wanted for p in self.graph._topics[topic].publishers)

    def reported(self, code: Code, **values: Value) -> int:
        """How often something with this code and these values was reported."""
        return len(coded(self.reports, code, **values))


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
