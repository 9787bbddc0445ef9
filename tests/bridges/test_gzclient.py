"""Which of several simulations gzclient shows, with real masters and without."""

import contextlib
import re
import signal
import subprocess
import sys
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest
from tests import launching
from tests.bridges.ros1_peers import PATIENCE, PROGRAM, REASON, Master, simulation, wait_for

from cartwheel.control import Running, running

pytestmark = [
    pytest.mark.timeout(300),
    pytest.mark.skipif(bool(REASON), reason=REASON),
]

Client = Callable[..., "subprocess.Popen[str]"]


@pytest.fixture
def masters(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[list[Master]]:
    """Two, of a user who has one folder of sockets."""
    for name in ("DISPLAY", "WAYLAND_DISPLAY", "CARTWHEEL_SIM"):
        monkeypatch.delenv(name, raising=False)
    runtime = tmp_path / "r"
    runtime.mkdir(mode=0o700)
    monkeypatch.setenv("XDG_RUNTIME_DIR", str(runtime))
    made = [Master(tmp_path / str(i)) for i in range(2)]
    for one in made:
        one.environment["XDG_RUNTIME_DIR"] = str(runtime)
    yield made
    for one in made:
        one.kill()


@pytest.fixture
def client() -> Iterator[Client]:
    with contextlib.ExitStack() as stack:

        def start(environment: dict[str, str], *words: str) -> subprocess.Popen[str]:
            made = launching.Popen(
                [str(PROGRAM), "gzclient", *words],
                env=environment,
                stdin=subprocess.DEVNULL,
                stdout=subprocess.PIPE,
                stderr=subprocess.PIPE,
                text=True,
            )
            stack.callback(made.communicate)
            stack.callback(made.kill)
            return made

        yield start


def entry_of(process: subprocess.Popen[str]) -> Running | None:
    return next((one for one in running() if one.pid == process.pid), None)


def joined(process: subprocess.Popen[str]) -> None:
    def there() -> bool:
        entry = entry_of(process)
        return entry is not None and bool(entry.ros_master)

    wait_for(there, "the simulation")


def shown(client: subprocess.Popen[str]) -> str:
    assert client.stdout is not None
    line = client.stdout.readline()
    found = re.search(r"http://[\d.]+:\d+", line)
    assert found, line
    return found[0]


def test_each_master_has_its_own(masters: list[Master], client: Client) -> None:
    with simulation(masters[0], "empty.world") as first:
        joined(first)
        late = client(masters[1].environment)
        assert late.stderr is not None
        assert masters[1].uri in late.stderr.readline()
        assert "other simulations are running" in late.stderr.readline()
        assert masters[0].uri in late.stderr.readline()
        early = client(masters[0].environment)
        one = shown(early)
        entry = entry_of(first)
        assert entry is not None
        assert entry.url == one
        with simulation(masters[1], "empty.world") as second:
            other = shown(late)
            entry = entry_of(second)
            assert entry is not None
            assert entry.url == other
            assert one != other
            by_argument = client(masters[0].environment, f"__master:={masters[1].uri}")
            assert shown(by_argument) == other
            by_number = client({**masters[0].environment, "CARTWHEEL_SIM": str(second.pid)})
            assert shown(by_number) == other
        assert late.wait(PATIENCE) == 0
        assert early.poll() is None


def test_a_run_without_ros_is_for_those_without(masters: list[Master], client: Client) -> None:
    process = launching.Popen(
        [str(PROGRAM), "run", "--headless"],
        env={k: v for k, v in masters[0].environment.items() if k != "ROS_MASTER_URI"},
        stdin=subprocess.DEVNULL,
        stdout=subprocess.DEVNULL,
    )
    try:
        wait_for(lambda: entry_of(process), "the simulation")
        waiting = client(masters[0].environment)
        assert waiting.stderr is not None
        assert "waiting for a simulation that uses the ROS master" in waiting.stderr.readline()
        with simulation(masters[1], "empty.world") as other:
            joined(other)
            # Of the two it is the only one without ROS.
            alone = client(
                {k: v for k, v in masters[0].environment.items() if k != "ROS_MASTER_URI"}
            )
            url = shown(alone)
            entry = entry_of(process)
            assert entry is not None
            assert entry.url == url
        assert waiting.poll() is None
        waiting.send_signal(signal.SIGINT)
        assert waiting.wait(PATIENCE) == 128 + signal.SIGINT
    finally:
        process.kill()
        process.wait()


def test_it_ends_with_what_started_it(masters: list[Master], tmp_path: Path) -> None:
    number = tmp_path / "number"
    script = (
        "import subprocess, sys\n"
        "made = subprocess.Popen(sys.argv[2:], stdin=subprocess.DEVNULL)\n"
        "open(sys.argv[1], 'w').write(str(made.pid))\n"
        "made.wait()\n"
    )
    launch = subprocess.Popen(
        [sys.executable, "-c", script, str(number), str(PROGRAM), "gzclient"],
        env=masters[0].environment,
        stderr=subprocess.PIPE,
        text=True,
    )
    assert launch.stderr is not None
    assert "waiting for" in launch.stderr.readline()
    pid = int(wait_for(lambda: number.exists() and number.read_text(), "its number"))
    launch.kill()
    launch.wait()

    def ended() -> bool:
        try:
            # Somebody may have to reap it.
            return ") Z " in Path(f"/proc/{pid}/stat").read_text()
        except OSError:
            return True

    wait_for(ended, "its end")
    launch.stderr.close()
