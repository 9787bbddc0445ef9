"""Programs that end without closing their world."""

import os
import signal
import subprocess
import sys
from pathlib import Path

import pytest
from tests import launching
from tests.bridges.ros1_peers import wait_for
from tests.processes import bridges_of, is_alive

from cartwheel.bridges.recording.opening import open_recording

pytestmark = pytest.mark.skipif(sys.platform != "linux", reason="looks at processes in /proc")

_PROGRAM = """
import sys, threading, time
import cartwheel as cw
world = cw.World("empty", record="drive.mcap", foxglove=0, viewer=0)
world.spawn("rosbots.xacro")
world.run(0.2)
print("ready", flush=True)
sys.stdin.readline()
{end}
"""
_SPINNING = """
threading.Thread(target=world.spin, daemon=True).start()
while world.time < 0.4:
    time.sleep(0.01)
"""


@pytest.mark.parametrize(
    ("end", "status"),
    [
        ("", 0),
        ("raise ValueError", 1),
        ("sys.exit(3)", 3),
        (_SPINNING, 0),
        ("world.stop()\ndel world", 0),
        ("import os, signal; os.kill(os.getpid(), signal.SIGKILL)", -signal.SIGKILL),
        ("import os, signal; os.kill(os.getpid(), signal.SIGTERM)", -signal.SIGTERM),
        ("import os\nif not os.fork(): sys.exit()\nos.wait()\nworld.run(0.2)", 0),
    ],
)
def test_nothing_is_left(tmp_path: Path, runtime_folder: Path, end: str, status: int) -> None:
    pytest.importorskip("foxglove")
    process = launching.Popen(
        [sys.executable, "-c", _PROGRAM.format(end=end)],
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        cwd=tmp_path,
        env={**os.environ, "XDG_RUNTIME_DIR": str(runtime_folder)},
    )
    assert process.stdout is not None
    assert process.stdout.readline() == "ready\n"
    children = bridges_of(process)
    assert len(children) == 2
    _, error = process.communicate("\n", timeout=120)
    assert process.returncode == status, error
    assert ("ValueError" in error) == (status == 1), error
    wait_for(lambda: not any(map(is_alive, children)), "the end of the bridges")
    recording = open_recording(tmp_path / "drive.mcap")
    assert recording.complete
    assert "/odom" in {topic.name for topic in recording.topics}
    if status >= 0:
        assert list((runtime_folder / "cartwheel").iterdir()) == []


@pytest.mark.parametrize(
    "run",
    [
        "world.run(0.2)",
        "threading.Thread(target=world.spin, daemon=True).start()",
        "threading.Thread(target=lambda: [world.run(0.05) for _ in range(10**6)], "
        "daemon=True).start()",
    ],
    ids=["run", "spin", "runs"],
)
def test_a_program_that_leaves_its_cameras_open_ends_silently(tmp_path: Path, run: str) -> None:
    """Also if Python's exit handler for `weakref.finalize` is older than that of OpenGL."""
    program = f"""
import tempfile, threading, time
with tempfile.TemporaryDirectory():
    pass
import cartwheel as cw
world = cw.World("empty")
world.spawn("rosbots.xacro")
images = world.topic("/rosbots/camera1/image_raw")
{run}
end = time.monotonic() + 60
while images.count < 3 and time.monotonic() < end:
    time.sleep(0.01)
print(images.count >= 3)
"""
    done = subprocess.run(
        [sys.executable, "-c", program],
        check=False,
        capture_output=True,
        text=True,
        cwd=tmp_path,
        timeout=120,
    )
    assert (done.returncode, done.stdout, done.stderr) == (0, "True\n", "")
