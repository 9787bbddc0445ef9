"""Each wire of a run has a process of its own: what becomes of both when one of them ends."""

import os
import signal
import subprocess
import sys
import time
from collections.abc import Callable
from typing import Any

import pytest
from tests.cli.conftest import Program
from tests.processes import bridges_of, is_alive

from cartwheel.codes.recording import RECORDING_BROKE_OFF
from cartwheel.codes.wires import BRIDGE_ENDED

_PATIENCE = 60.0

pytestmark = pytest.mark.skipif(sys.platform != "linux", reason="looks at processes in /proc")


def _until(condition: Callable[[], Any]) -> None:
    deadline = time.monotonic() + _PATIENCE
    while not condition():
        assert time.monotonic() < deadline
        time.sleep(0.02)


def _read_to(process: subprocess.Popen[str], start: str) -> None:
    """Reads what it prints up to a line of that beginning: it runs soon."""
    assert process.stdout is not None
    for line in process.stdout:
        if line.startswith(start):
            return
    raise AssertionError(f"{start} never came")


def test_a_killed_run_leaves_no_process_and_a_whole_recording(program: Program) -> None:
    process = program.start("run", "--headless", "--ros2", "--record", "drive.mcap")
    _until(lambda: len(bridges_of(process)) == 2)
    children = bridges_of(process)
    file = program.folder / "drive.mcap"
    _until(lambda: file.exists() and file.stat().st_size > 100_000)
    process.kill()
    process.communicate(timeout=_PATIENCE)
    _until(lambda: not any(map(is_alive, children)))
    done = program("info", "drive.mcap")
    assert "messages" in done.stdout
    assert "CW031" not in done.stderr
    assert "/odom" in done.stdout


def test_ctrl_c_ends_them_all_and_keeps_everything(program: Program) -> None:
    process = program.start(
        "run", "--headless", "--ros2", "--record", "drive.mcap", start_new_session=True
    )
    program.wait_until_up(process)
    _until(lambda: len(bridges_of(process)) == 2)
    children = bridges_of(process)
    file = program.folder / "drive.mcap"
    _until(lambda: file.exists() and file.stat().st_size > 100_000)
    # As a terminal does: to all of its foreground.
    os.killpg(process.pid, signal.SIGINT)
    out, error = process.communicate(timeout=_PATIENCE)
    assert process.returncode == 0, error
    assert "recorded" in out
    assert not any(map(is_alive, children))
    assert "messages" in program("info", "drive.mcap").stdout


def test_a_signal_to_all_of_them_keeps_everything(program: Program) -> None:
    process = program.start("run", "--headless", "--record", "drive.mcap")
    _read_to(process, "record")
    (child,) = bridges_of(process)
    # As systemd does.
    for pid in (child, process.pid):
        os.kill(pid, signal.SIGTERM)
    out, error = process.communicate(timeout=_PATIENCE)
    assert process.returncode == 0, error
    assert "recorded" in out


def test_a_wire_that_dies_is_reported_and_the_simulation_goes_on(program: Program) -> None:
    process = program.start("run", "--headless", "--ros2", "--for", "6")
    _read_to(process, "ros 2")
    (child,) = bridges_of(process)
    os.kill(child, signal.SIGKILL)
    out, error = process.communicate(timeout=_PATIENCE)
    assert process.returncode == 0, error
    assert "simulated 6.000 s" in out
    assert f"[{BRIDGE_ENDED}]" in error


def test_a_recorder_that_dies_ends_the_run(program: Program) -> None:
    process = program.start("run", "--headless", "--record", "drive.mcap")
    _read_to(process, "record")
    (child,) = bridges_of(process)
    os.kill(child, signal.SIGKILL)
    _, error = process.communicate(timeout=_PATIENCE)
    assert process.returncode == 2
    assert f"[{RECORDING_BROKE_OFF}]" in error
    assert "Traceback" not in error


def test_a_wire_that_stands_still_does_not_hold_the_simulation(program: Program) -> None:
    process = program.start("run", "--headless", "--ros2", "--speed", "max", "--for", "60")
    _read_to(process, "ros 2")
    (child,) = bridges_of(process)
    os.kill(child, signal.SIGSTOP)
    out, error = process.communicate(timeout=_PATIENCE)
    assert process.returncode == 0, error
    assert "simulated 60.000 s" in out
    # A killed process is there until the kernel has cleared it away.
    deadline = time.monotonic() + _PATIENCE
    while is_alive(child) and time.monotonic() < deadline:
        time.sleep(0.05)
    assert not is_alive(child)


_HELD = """
import sys
if "broken.urdf" in sys.argv:
    import time
    from pathlib import Path
    from cartwheel.description.elements import xml
    read = xml.read_bytes
    def held(path, *more, **options):
        end = time.monotonic() + 60
        while not Path("go on").exists() and time.monotonic() < end:
            time.sleep(0.01)
        return read(path, *more, **options)
    xml.read_bytes = held
"""


def test_a_file_that_cannot_be_read_leaves_nothing_behind(program: Program) -> None:
    (program.folder / "broken.urdf").write_text("<robot")
    # It is read when both processes are there.
    (program.folder / "sitecustomize.py").write_text(_HELD)
    paths = (str(program.folder), program.environment.get("PYTHONPATH", ""))
    program.environment["PYTHONPATH"] = os.pathsep.join(path for path in paths if path)
    process = program.start("run", "broken.urdf", "--headless", "--ros2", "--record", "a.mcap")
    _until(lambda: len(bridges_of(process)) == 2)
    children = bridges_of(process)
    (program.folder / "go on").touch()
    _, error = process.communicate(timeout=_PATIENCE)
    assert process.returncode == 2
    assert "broken.urdf:1" in error
    _until(lambda: not any(map(is_alive, children)))
    assert not (program.folder / "a.mcap").exists()
