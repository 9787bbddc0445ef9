import tempfile
import threading
import time
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest

from cartwheel.codes.tags import VALUE_INVALID
from cartwheel.control.server import ControlServer
from cartwheel.description.model import (
    Box,
    Collision,
    Inertial,
    Link,
    RobotDescription,
    WorldDescription,
)
from cartwheel.errors import DescriptionError, Origin
from cartwheel.messages import from_dict
from cartwheel.session import Session

ORIGIN = Origin(file="box.urdf", line=3)


def box(name: str = "box") -> RobotDescription:
    link = Link(
        name="link",
        inertial=Inertial(mass=1.0, ixx=0.1, iyy=0.1, izz=0.1, origin=ORIGIN),
        collisions=(Collision(name="collision", shape=Box(size=(1, 1, 1)), origin=ORIGIN),),
        origin=ORIGIN,
    )
    return RobotDescription(name=name, links=(link,), canonical_link="link", origin=ORIGIN)


def load(path: Path, *, arguments: dict[str, str], **_: list[Path]) -> RobotDescription:
    """Stands in for reading a file: its name decides what comes."""
    if path.name == "bad.urdf":
        raise DescriptionError(
            "it is bad",
            code=VALUE_INVALID,
            origin=Origin(file=str(path), line=7),
            hint="Mend it.",
            values={"name": "mass"},
        )
    if path.name == "broken.urdf":
        raise ZeroDivisionError("a fault of ours")
    return box(arguments.get("name", path.stem))


@pytest.fixture(autouse=True)
def runtime_folder(monkeypatch: pytest.MonkeyPatch) -> Iterator[Path]:
    """Its path is short enough for sockets, wherever tests keep their files."""
    monkeypatch.delenv("CARTWHEEL_SIM", raising=False)
    with tempfile.TemporaryDirectory(prefix="cw", dir="/tmp") as folder:
        monkeypatch.setenv("XDG_RUNTIME_DIR", folder)
        yield Path(folder, "cartwheel")


@pytest.fixture
def session() -> Iterator[Session]:
    """Runs in real time, with a topic /twist at 50 Hz and the commands of /cmd_vel kept."""
    made = Session(WorldDescription(name="test_world"))
    twists = made.graph.advertise("/twist", "geometry_msgs/msg/Twist", rate=50)

    def publish() -> None:
        twists.publish(from_dict("geometry_msgs/Twist", [[made.simulation.time_ns, 0, 0], None]))

    made.simulation.schedule(50, after=publish, active=lambda: twists.wanted)
    thread = threading.Thread(target=made.pacer().run)
    thread.start()
    yield made
    made.simulation.post(made.simulation.stop)
    thread.join(120)
    assert not thread.is_alive()
    made.close()


@pytest.fixture
def server(session: Session) -> Iterator[ControlServer]:
    made = ControlServer(session, title="nothing in test_world", load=load)
    yield made
    made.close()


@pytest.fixture
def commands(session: Session) -> list[object]:
    received: list[object] = []
    session.graph.subscribe("/cmd_vel", received.append, type_name="geometry_msgs/msg/Twist")
    return received


@pytest.fixture
def eventually() -> Callable[[Callable[[], object]], None]:
    def wait(condition: Callable[[], object]) -> None:
        deadline = time.monotonic() + 60.0
        while time.monotonic() < deadline:
            if condition():
                return
            time.sleep(0.01)
        raise AssertionError("it did not come true")

    return wait
