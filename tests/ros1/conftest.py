"""The overlay, built once, and a ROS graph of each test's own."""

from __future__ import annotations

import fcntl
import json
import os
import shutil
import signal
import socket
import subprocess
import sys
import time
import uuid
import xmlrpc.client
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import pytest
from tests import launching
from tests.reserved import free_port

ROOT = Path(__file__).parents[2]
PYTHON = launching.ROS1_PYTHON
BUILD = ROOT / "tools" / "build_ros1.sh"
MARK = "TEST_ROS1"
OTHER_LANGUAGES = "gencpp:genlisp"
"""Of messages, in which no test has a program; they take half of the build's time."""
PATIENCE = 120.0
"""s; a machine may be busy."""


@dataclass(frozen=True)
class Overlay:
    """The built workspace."""

    environment: Mapping[str, str]
    """Of a shell that has sourced it."""

    def program(self, package: str, name: str) -> Path:
        return ROOT / "ros1" / "devel" / "lib" / package / name


def build() -> subprocess.CompletedProcess[str]:
    """Builds the overlay, unless it is built; a second process waits for the first.

    catkin_make takes seconds to find that nothing has changed.
    """
    venv = Path(sys.executable).parent.parent
    made = ROOT / "ros1" / "build"
    made.mkdir(exist_ok=True)
    state = made / "tests.state"
    with (made / "tests.lock").open("w") as lock:
        fcntl.flock(lock, fcntl.LOCK_EX)
        if state.exists() and state.read_text() == _state(venv):
            return subprocess.CompletedProcess([], 0, "", "")
        state.unlink(missing_ok=True)
        done = subprocess.run(
            [BUILD],
            env={**os.environ, "VENV": str(venv), "ROS_LANG_DISABLE": OTHER_LANGUAGES},
            capture_output=True,
            text=True,
            check=False,
        )
        if done.returncode == 0:
            state.write_text(_state(venv))
        return done


def _state(venv: Path) -> str:
    """What the overlay is built from and has become: files with their times and sizes.

    The log is that of the last build, which may have been with other options.
    """
    found = [f"{venv} {OTHER_LANGUAGES}"]
    tree = os.walk(ROOT / "ros1" / "src", followlinks=True)
    files = [
        Path(folder, name)
        for folder, _, names in tree
        for name in names
        if not folder.endswith("__pycache__")
    ]
    log = ROOT / "ros1" / "build" / "catkin_make.log"
    for file in (*files, BUILD, log, ROOT / "ros1" / "devel" / "setup.bash"):
        if file.exists():
            state = file.stat()
            found.append(f"{file} {state.st_mtime_ns} {state.st_size}")
    return "\n".join(sorted(found))


@pytest.fixture(scope="session", autouse=True)
def overlay() -> Overlay:
    if shutil.which("catkin_make") is None:
        pytest.skip("catkin is not installed (tools/setup.sh ros1 does it)")
    built = build()
    assert built.returncode == 0, built.stderr
    kept = {key: os.environ[key] for key in ("HOME", "LANG", "USER") if key in os.environ}
    shell = subprocess.run(
        ["bash", "-c", "source ros1/devel/setup.bash && env -0"],
        cwd=ROOT,
        env={"PATH": "/usr/local/bin:/usr/bin:/bin", **kept},
        capture_output=True,
        text=True,
        check=True,
    )
    pairs = (entry.partition("=") for entry in shell.stdout.split("\0") if entry)
    environment = {name: value for name, _, value in pairs}
    launching.admit_ros1(environment)
    return Overlay({**environment, "ROS_MASTER_URI": "http://127.0.0.1:1"})


@dataclass
class Ros:
    """A ROS graph of a test's own, and everything that was started in it."""

    environment: dict[str, str]
    folder: Path
    overlay: Overlay
    started: list[subprocess.Popen[str]] = field(default_factory=list)

    def start(self, *command: str | Path, **options: Any) -> subprocess.Popen[str]:
        """Starts a command in a session of its own."""
        for name in ("stdin", "stdout", "stderr"):
            options.setdefault(name, subprocess.DEVNULL if name == "stdin" else subprocess.PIPE)
        process = launching.Popen(
            [str(word) for word in command],
            env={**self.environment, **options.pop("environment", {})},
            cwd=options.pop("cwd", self.folder),
            text=True,
            start_new_session=True,
            **options,
        )
        self.started.append(process)
        return process

    def run(
        self, *command: str | Path, status: int | None = 0, **options: Any
    ) -> subprocess.CompletedProcess[str]:
        """Runs a command to its end and expects its status."""
        text = options.pop("input", None)
        if text is not None:
            options["stdin"] = subprocess.PIPE
        process = self.start(*command, **options)
        output, errors = process.communicate(text, timeout=2 * PATIENCE)
        assert "Traceback" not in errors, errors
        if status is not None:
            assert process.returncode == status, f"{output}\n{errors}"
        return subprocess.CompletedProcess(command, process.returncode, output, errors)

    def master(self) -> None:
        """Starts a master and waits for it."""
        self.start("rosmaster", "--core", "-p", self.port, stdout=subprocess.DEVNULL,
                   stderr=subprocess.DEVNULL)  # fmt: skip
        self.until(lambda: reachable(int(self.port)))

    def _named(self, kind: int) -> set[str]:
        """The master's topics that are published (0) or subscribed to (1), or services (2)."""
        try:
            master = xmlrpc.client.ServerProxy(self.environment["ROS_MASTER_URI"])
            state: Any = master.getSystemState("/test")
        except OSError:
            return set()  # No master yet.
        return {name for name, _ in state[2][kind]}

    @property
    def services(self) -> set[str]:
        return self._named(2)

    @property
    def topics(self) -> set[str]:
        return self._named(0) | self._named(1)

    @property
    def port(self) -> str:
        return self.environment["ROS_MASTER_URI"].rsplit(":", 1)[1].strip("/")

    def python(self, code: str, *arguments: str) -> subprocess.Popen[str]:
        """Starts a program for the Python that has rospy."""
        environment = {"PYTHONUNBUFFERED": "1"}
        return self.start(PYTHON, "-c", code, *arguments, environment=environment)

    def until(self, reached: Callable[[], object], what: str = "") -> Any:
        """Waits for something, and returns it."""
        deadline = time.monotonic() + PATIENCE
        while not (found := reached()):
            assert time.monotonic() < deadline, what or "that never came"
            time.sleep(0.05)
        return found

    def left(self) -> list[str]:
        """The process IDs and commands of all that was started here and still runs."""
        mark = f"{MARK}={self.environment[MARK]}".encode()
        # What a launcher started has the launcher's environment.
        found = [
            f"{process.pid} {process.args}" for process in self.started if process.poll() is None
        ]
        for process in Path("/proc").glob("[0-9]*"):
            try:
                new = int(process.name) not in {each.pid for each in self.started}
                if new and mark in (process / "environ").read_bytes().split(b"\0"):
                    words = (process / "cmdline").read_bytes().split(b"\0")
                    found.append(f"{process.name} {b' '.join(words).decode()}")
            except OSError:
                continue
        return found

    def close(self) -> None:
        deadline = time.monotonic() + 40.0
        while self.left():
            number = signal.SIGTERM if time.monotonic() < deadline - 20.0 else signal.SIGKILL
            for line in self.left():
                try:
                    os.kill(int(line.split()[0]), number)
                except ProcessLookupError:
                    continue
            if time.monotonic() > deadline:
                break
            for process in self.started:
                process.poll()
            time.sleep(0.1)
        for process in self.started:
            process.communicate(timeout=60)


def reachable(port: int) -> bool:
    with socket.socket() as probe:
        probe.settimeout(1.0)
        return probe.connect_ex(("127.0.0.1", port)) == 0


@pytest.fixture
def ros(overlay: Overlay, tmp_path: Path, runtime_folder: Path) -> Iterator[Ros]:
    made = Ros(
        environment={
            **overlay.environment,
            "ROS_MASTER_URI": f"http://127.0.0.1:{free_port()}",
            "ROS_HOSTNAME": "127.0.0.1",
            "ROS_LOG_DIR": str(tmp_path / "log"),
            "XDG_RUNTIME_DIR": str(runtime_folder),
            MARK: uuid.uuid4().hex,
        },
        folder=tmp_path,
        overlay=overlay,
    )
    yield made
    made.close()


GAZEBO = """
import json, sys
import rospy
from gazebo_msgs.srv import *
from std_srvs.srv import Empty, EmptyResponse

space, refuse = sys.argv[1], sys.argv[2] == "refuse"
present = ["ground_plane"]

def reported(what, fields):
    print(json.dumps([what, fields]), flush=True)

def spawn(kind):
    def serve(request):
        at, turn = request.initial_pose.position, request.initial_pose.orientation
        reported(kind, dict(
            name=request.model_name, xml=request.model_xml, namespace=request.robot_namespace,
            frame=request.reference_frame, position=[at.x, at.y, at.z],
            orientation=[turn.x, turn.y, turn.z, turn.w]))
        present.append(request.model_name)
        return SpawnModelResponse(not refuse, "refused" if refuse else "done")
    return serve

def configure(request):
    reported("configure", dict(name=request.model_name, parameter=request.urdf_param_name,
        joints=list(request.joint_names), positions=list(request.joint_positions)))
    return SetModelConfigurationResponse(True, "set")

def delete(request):
    reported("delete", request.model_name)
    return DeleteModelResponse(True, "deleted")

def unpause(request):
    reported("unpause", None)
    return EmptyResponse()

def world(request):
    present.append("late")
    return GetWorldPropertiesResponse(0.0, present[:-1], True, True, "")

rospy.init_node("gazebo")
rospy.Service(space + "/get_world_properties", GetWorldProperties, world)
rospy.Service(space + "/unpause_physics", Empty, unpause)
rospy.Service(space + "/delete_model", DeleteModel, delete)
rospy.Service(space + "/set_model_configuration", SetModelConfiguration, configure)
rospy.Service(space + "/spawn_sdf_model", SpawnModel, spawn("sdf"))
rospy.Service(space + "/spawn_urdf_model", SpawnModel, spawn("urdf"))
reported("ready", None)
rospy.spin()
"""


class Gazebo:
    """A node that takes what spawn_model asks for, and writes it down."""

    def __init__(self, process: subprocess.Popen[str]) -> None:
        self._process = process
        assert self.next()[0] == "ready"

    def next(self) -> tuple[str, Any]:
        """The next request: what, and its fields."""
        assert self._process.stdout is not None
        what, fields = json.loads(self._process.stdout.readline())
        return what, fields


@pytest.fixture
def gazebo(ros: Ros) -> Callable[..., Gazebo]:
    return lambda space="/gazebo", mood="grant": Gazebo(ros.python(GAZEBO, space, mood))
