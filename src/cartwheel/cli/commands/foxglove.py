"""A run that Foxglove can look at."""

from __future__ import annotations

import contextlib
import re
from collections.abc import Callable, Iterator, Sequence
from pathlib import Path
from typing import TYPE_CHECKING
from urllib.parse import unquote

from cartwheel.cli import interrupts
from cartwheel.cli.commands.bridges import log_all_on
from cartwheel.cli.commands.options import Options
from cartwheel.cli.commands.report import Report
from cartwheel.description.packages import Packages
from cartwheel.errors import CartwheelError
from cartwheel.simulation import RunState

if TYPE_CHECKING:
    from cartwheel.bridges.apart.process import BridgeProcess
    from cartwheel.bridges.foxglove.controls import TimeState
    from cartwheel.session import Session
    from cartwheel.simulation import Simulation

_SHAPES = {".stl", ".dae", ".obj", ".mtl", ".ply", ".glb", ".gltf", ".bin"}
_PICTURES = {".png", ".jpg", ".jpeg", ".tif", ".tiff", ".tga", ".bmp", ".webp"}
_LARGEST = 200 << 20
"""Bytes of a file that is handed out."""
_FILE = re.compile(r'file://[^"\'<>\s]+')


@contextlib.contextmanager
def shown_by_foxglove(
    session: Session, process: BridgeProcess, options: Options, port: int, report: Report
) -> Iterator[None]:
    """Serves the enclosed run to Foxglove.

    Raises:
        CartwheelError: The extra is missing, or the port is taken.
    """
    from cartwheel.gazebo.ros2_api import Ros2Api

    simulation = session.simulation
    end_ns = None if options.seconds is None else round(options.seconds * 1e9)
    controls = SimulationControls(simulation)

    with interrupts.finally_do(process.close):
        process.open(
            session.graph,
            {
                "name": f"Cartwheel: {', '.join(simulation.models)}",
                "host": options.host,
                "port": port,
                "time_range": None if end_ns is None else (0, end_ns),
            },
            time_ns=lambda: simulation.time_ns,
            echo=True,
            report=simulation.report,
            handlers={
                "state": (controls.state, False),
                "pause": (controls.pause, True),
                "resume": (controls.resume, True),
                "set_speed": (controls.set_speed, True),
                "seek": (controls.seek, True),
                "asset": (Assets(session, options.package_path), True),
            },
        )
        if options.ros1_node is None and options.ros2_node is None:
            # Where a run is no part of ROS, nobody else offers what Gazebo does.
            Ros2Api(session, package_path=options.package_path).start()
        url = process.call("start")
        log_all_on(process, simulation)
        report.foxglove(url)
        yield


class SimulationControls:
    """Time of a simulation, from any thread."""

    def __init__(self, simulation: Simulation) -> None:
        self._simulation = simulation

    @property
    def time_ns(self) -> int:
        """What time it is."""
        return self._simulation.time_ns

    def state(self) -> TimeState:
        """How it goes; numbers that may be read while they change."""
        from cartwheel.bridges.foxglove.controls import TimeState

        simulation = self._simulation
        return TimeState(
            time_ns=simulation.time_ns,
            paused=simulation.run_state is not RunState.RUNNING,
            speed=simulation.speed,
        )

    def pause(self) -> None:
        """Holds time."""
        self._do(self._simulation.pause)

    def resume(self) -> None:
        """Lets it go on."""
        self._do(self._simulation.resume)

    def set_speed(self, speed: float | None) -> None:
        """Sets the wanted real-time factor."""
        self._do(lambda: self._simulation.set_speed(speed))

    def seek(self, time_ns: int) -> None:
        """Back to the start, which is where a simulation can go.

        Raises:
            CartwheelError: It is asked to go elsewhere.
        """
        if time_ns > 0:
            raise CartwheelError("a simulation cannot jump in time, but to its start")
        self._do(self._simulation.reset)

    def _do(self, function: Callable[[], None]) -> None:
        # Waited for: the client is told the state that it has brought about.
        with contextlib.suppress(TimeoutError):
            self._simulation.call(function).result(5.0)


class Assets:
    """Meshes and textures of what stands in the world, by their URIs.

    Any page in a browser may ask, so nothing else is handed out: by ``package://`` and
    ``model://`` shapes and pictures below the package's folder; by ``file://`` those that a
    robot's description names, and what lies beside them.

    Args:
        session: Whose models.
        package_path: Where packages are looked for first.
    """

    def __init__(self, session: Session, package_path: Sequence[Path]) -> None:
        self._session = session
        self._package_path = package_path

    def __call__(self, uri: str) -> bytes | None:
        """The content; None where there is none to be had."""
        plain = unquote(uri)
        if ".." in plain.split("/") or "\0" in plain or "\\" in plain:
            return None
        if Path(plain).suffix.lower() not in _SHAPES | _PICTURES:
            return None
        scheme = plain.partition("://")[0]
        if scheme in ("package", "model"):
            return self._in_package(uri)
        if scheme == "file":
            path = Path(plain.removeprefix("file://"))
            return _content(path) if path.parent in self._named_folders() else None
        return None

    def _in_package(self, uri: str) -> bytes | None:
        for file in dict.fromkeys(
            model.description.origin.file for model in self._session.simulation.scene.models
        ):
            near = None if file.startswith("<") else Path(file)
            with contextlib.suppress(CartwheelError, OSError):
                return _content(Packages(near, self._package_path).resolve(uri))
        return None

    def _named_folders(self) -> set[Path]:
        return {
            Path(unquote(found).removeprefix("file://")).parent
            for model in self._session.simulation.scene.models
            for found in _FILE.findall(model.description.text)
        }


def _content(path: Path) -> bytes | None:
    try:
        return path.read_bytes() if path.stat().st_size <= _LARGEST else None
    except OSError:
        return None
