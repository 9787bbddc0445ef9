"""A simulation that runs while a test looks at it from outside."""

from __future__ import annotations

import threading
from typing import Any

from cartwheel.description import load_robot, load_world
from cartwheel.errors import Diagnostic
from cartwheel.session import Session


class Running:
    """Runs in real time on a thread; a subclass makes its `bridge`."""

    bridge: Any

    def __init__(self, *, robot: bool = True) -> None:
        self.session = Session(load_world("empty"))
        if robot:
            self.session.spawn(load_robot("rosbots.xacro"))
        self.graph = self.session.graph
        self.simulation = self.session.simulation
        self.reports: list[Diagnostic] = []
        self._thread = threading.Thread(target=self._own)

    def start(self) -> None:
        self.bridge.start()
        self._thread.start()

    def close(self) -> None:
        self.bridge.close()
        self.simulation.stop()
        self._thread.join()

    def _own(self) -> None:
        self.session.pacer().run()
        self.session.close()
