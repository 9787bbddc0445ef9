"""Starts the program and Python code without importing Cartwheel each time.

Importing Cartwheel takes most of a short command's time, and the tests start hundreds. The test
processes therefore have a launcher: a process that has imported Cartwheel and forks for each start.
The fork gets the arguments, folder, environment and streams of the start, and then runs as the
program would. `Popen` and `run` are those of `subprocess` in all that tests use of them.

ROS 1's programs have launchers as well, in the environments that were given to `admit_ros1`.
Bridge processes and those of `multiprocessing` come from the launcher of the test process, also
those of programs that it started.

What differs: the parent is the launcher, ``/proc/PID/cmdline`` and ``/proc/PID/environ`` are the
launcher's (`tests.processes` finds the bridges of a program nevertheless), all modules are imported
already, OpenBLAS has one thread, hashes of strings have the same seed, and at the end no objects
are freed. Tests that look at these, at the start-up or at the usage of children use `subprocess`.
"""

from __future__ import annotations

import atexit
import contextlib
import fcntl
import functools
import gc
import importlib
import inspect
import io
import json
import multiprocessing.popen_spawn_posix
import multiprocessing.util
import os
import pkgutil
import re
import runpy
import select
import shlex
import shutil
import signal
import socket
import subprocess
import sys
import threading
import traceback
import types
from collections.abc import Callable, Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any, NamedTuple, NoReturn

PROGRAM = Path(sys.executable).with_name("cartwheel")
_OTHERS = (
    *("viser", "PIL.JpegImagePlugin", "PIL.PngImagePlugin", "websockets.sync.client", "xacro"),
    *("rosbags.typesys.stores.ros2_jazzy", "rosbags.typesys.stores.ros1_noetic"),
    # Of libraries, which import these in turn when they need them.
    *("numpy.ma", "typer._adapters", "typer._click.decorators", "pydantic.type_adapter"),
    *("pydantic.deprecated.class_validators", "pydantic.functional_validators", "sysconfig"),
    *("rich.console", "rich.table", "foxglove", "pydantic.plugin._loader", "rosbags.usertypes"),
    *("pytest", "_pytest.cacheprovider"),
)
"""Modules that are imported when they are needed."""
ROS1_PYTHON = "/usr/bin/python3"
_OF_ROS1 = (
    *("rospy", "roslaunch", "rosmaster", "rosmaster.main", "rosmaster.master", "rosbag", "rosmsg"),
    *("rosnode", "rosparam", "rosservice", "rostopic", "actionlib", "tf2_ros"),
    *("actionlib_msgs.msg", "geometry_msgs.msg", "nav_msgs.msg", "rosgraph_msgs.msg"),
    *("sensor_msgs.msg", "std_msgs.msg", "std_srvs.srv", "tf2_msgs.msg", "trajectory_msgs.msg"),
    *(
        "gazebo_msgs.msg",
        "gazebo_msgs.srv",
        "gazebo_ros.spawn_model",
        "controller_manager_msgs.srv",
    ),
    *("controller_manager.controller_manager", "control_msgs.msg"),
)
"""Modules that ROS 1's programs import, as far as an environment has them."""
_AT_START = ("PYTHON", "LD_", "LC_", "LANG", "MUJOCO_", "CARTWHEEL_CODES_ONLY", "ROS_NAMESPACE")
_LATER = {"PYTHONUNBUFFERED"}
_LONGEST = 200_000
"""Bytes of a request: more does not fit into a packet."""
_MOST_FILES = 16
"""Files that a start may get besides its streams."""
RARE_COLLECTIONS = (10_000, 20, 10)
"""Thresholds of the garbage collector in test processes and launchers. Python's own take a
tenth of the processor time."""
_SPAWNED = "--multiprocessing-fork"
"""Last word of the command of a process of `multiprocessing`."""
_signature = inspect.signature(subprocess.Popen._execute_child)
_spawn_cold = multiprocessing.util.spawnv_passfds


class Popen(subprocess.Popen):
    """`subprocess.Popen`, from the launcher if that can start it."""

    _answer: socket.socket | None = None

    def _execute_child(self, *arguments: Any) -> None:
        start = _signature.bind(self, *arguments).arguments
        found = _request(start)
        if found is None:
            super()._execute_child(*arguments)
            return
        launcher, request = found
        files = start["pass_fds"]
        ends = [start[name] for name in ("p2cread", "c2pwrite", "errwrite")]
        streams = [number if end == -1 else end for number, end in enumerate(ends)]
        self._answer, theirs = socket.socketpair()
        with theirs:
            socket.send_fds(
                _started(launcher, os.getpid()), [request], [theirs.fileno(), *streams, *files]
            )
        self.pid = int.from_bytes(self._receive(), "little")
        self._child_created = True
        pipes = ("p2cread", "p2cwrite", "c2pread", "c2pwrite", "errread", "errwrite")
        self._close_pipe_fds(*(start[name] for name in pipes))

    def _receive(self) -> bytes:
        assert self._answer is not None
        answer = self._answer.recv(4)
        assert len(answer) == 4, "the launcher ended"
        return answer

    def _internal_poll(self, *arguments: Any, **options: Any) -> int | None:
        if self._answer is None:
            return super()._internal_poll(*arguments, **options)
        with self._waitpid_lock:
            self._look(0)
        return self.returncode

    def _wait(self, timeout: float | None) -> int:
        if self._answer is None:
            return super()._wait(timeout)
        with self._waitpid_lock:
            if not self._look(timeout):
                raise subprocess.TimeoutExpired(self.args, timeout)
        return self.returncode

    def _look(self, timeout: float | None) -> bool:
        """Waits for the end; returns whether the process has ended."""
        if self.returncode is None:
            poll = select.poll()
            poll.register(self._answer, select.POLLIN)
            if not poll.poll(None if timeout is None else max(0.0, timeout) * 1000):
                return False
            self._handle_exitstatus(int.from_bytes(self._receive(), "little"))
            self._answer.close()
        return True


def run(
    command: Any,
    *,
    input: Any = None,
    capture_output: bool = False,
    timeout: float | None = None,
    check: bool = False,
    **options: Any,
) -> subprocess.CompletedProcess[Any]:
    """`subprocess.run`, from the launcher if that can start it."""
    if input is not None:
        options["stdin"] = subprocess.PIPE
    if capture_output:
        options["stdout"] = options["stderr"] = subprocess.PIPE
    with Popen(command, **options) as process:
        try:
            output, errors = process.communicate(input, timeout=timeout)
        except BaseException:
            process.kill()
            raise
    done = subprocess.CompletedProcess(command, process.returncode, output, errors)
    if check:
        done.check_returncode()
    return done


class SpawnedPopen(multiprocessing.popen_spawn_posix.Popen):
    """A process of `multiprocessing`'s start method ``spawn``, from the launcher."""

    def poll(self, flag: int = os.WNOHANG) -> int | None:
        process = _spawned.get(self.pid)
        if process is None:
            return super().poll(flag)
        if self.returncode is None:
            if flag == os.WNOHANG:
                process.poll()
            else:
                process.wait()
            if process.returncode is not None:
                self.returncode = process.returncode
                del _spawned[self.pid]
        return self.returncode


_spawned: dict[int, Popen] = {}
"""Running processes of `multiprocessing` from the launcher."""


def _spawn(path: bytes, words: list[str], files: Sequence[int]) -> int:
    """Starts Python as `multiprocessing` does; returns the process ID."""
    if _SPAWNED not in words:
        return _spawn_cold(path, words, files)
    process = Popen([os.fsdecode(path), *words[1:]], pass_fds=sorted(files))
    _spawned[process.pid] = process
    return process.pid


def replace_starts() -> None:
    """Starts bridge processes and those of `multiprocessing` from the launcher."""
    from cartwheel.bridges.apart import process

    vars(process)["Popen"] = Popen
    vars(multiprocessing.util)["spawnv_passfds"] = _spawn
    vars(multiprocessing.popen_spawn_posix)["Popen"] = SpawnedPopen


def shell(text: str) -> list[str]:
    """A shell's command, without the shell if it only starts the program."""
    if not text.startswith("cartwheel ") or re.search(r"[|&;<>()$`\\*?\[\]{}~#=%!\n]", text):
        return ["bash", "-c", f"set -o pipefail; {text}"]
    return [str(PROGRAM), *shlex.split(text)[1:]]


def admit_ros1(environment: Mapping[str, str]) -> None:
    """Starts ROS 1's programs from a launcher, in environments with the same `_at_start`."""
    _ros1_variables.add(_at_start(environment))


def _request(start: Mapping[str, Any]) -> tuple[_Launcher, bytes] | None:
    """A launcher and what it is to start; None if that needs a process of its own."""
    args = start["args"]
    if isinstance(args, str | bytes | os.PathLike) or start["shell"] or start["executable"]:
        return None
    words = [os.fsdecode(word) for word in args]
    if words[0] == sys.executable and words[1:3] == ["-m", "cartwheel"]:
        words = [str(PROGRAM), *words[3:]]
    asked = ("preexec_fn", "gid", "gids", "uid")
    if (
        len(start["pass_fds"]) > _MOST_FILES
        or any(start.get(name) not in (None, (), []) for name in asked)
        or not start["close_fds"]
    ):
        return None
    if start["umask"] != -1 or start.get("process_group", -1) not in (-1, None):
        return None
    given = os.environ if start["env"] is None else start["env"]
    environment = {os.fsdecode(name): os.fsdecode(value) for name, value in given.items()}
    variables = _at_start(environment)
    if words[0] in (str(PROGRAM), sys.executable):
        launcher = _Launcher(sys.executable, _VARIABLES)
    else:
        launcher = _Launcher(ROS1_PYTHON, variables)
        words[0] = shutil.which(words[0], path=environment.get("PATH")) or words[0]
        # rospy reads remappings when it is imported; roslaunch's arguments only look like them.
        remaps = Path(words[0]).name != "roslaunch" and any(":=" in word for word in words)
        if variables not in _ros1_variables or remaps:
            return None
    if launcher.variables != variables or not _is_known(words, launcher.python):
        return None
    folder = Path(os.fsdecode(start["cwd"] or ".")).absolute()
    if not folder.is_dir():
        return None
    request = {
        "words": words,
        "folder": str(folder),
        "environment": environment,
        "session": bool(start["start_new_session"]),
        "files": start["pass_fds"],
        "name": BRIDGE.format(os.getpid()) if start["pass_fds"] and _SPAWNED not in words else "",
    }
    data = json.dumps(request).encode()
    return (launcher, data) if len(data) <= _LONGEST else None


def _is_known(words: list[str], python: str) -> bool:
    """Whether these words start code, a module, a file or a program that this Python runs."""
    if words[0] == python:
        return len(words) > 1 and (words[1] in ("-c", "-m") or words[1].endswith(".py"))
    return words[0] == str(PROGRAM) or _interpreter(words[0]) == python


@functools.cache
def _interpreter(program: str) -> str:
    """What the first line of a script names; empty for other files."""
    try:
        with Path(program).open("rb") as file:
            first = file.readline(200)
    except OSError:
        return ""
    return os.fsdecode(first[2:].strip()) if first.startswith(b"#!") else ""


def _at_start(environment: Mapping[str, str]) -> frozenset[tuple[str, str]]:
    """The variables that Python and libraries read when they start."""
    return frozenset(
        (name, value)
        for name, value in environment.items()
        if name.startswith(_AT_START) and name not in _LATER
    )


BRIDGE = "bridge {}"
"""Name of a bridge process from a launcher, with the process ID of its program."""
_VARIABLES = _at_start(os.environ)
"""Of Cartwheel's launcher. Tests and libraries change those of this process."""
_ros1_variables: set[frozenset[tuple[str, str]]] = set()
_addresses: dict[_Launcher, bytes] = {}
"""Where the launchers of this process listen."""
_listening = b""
"""Where the launcher that this process is or comes from, or of the run of all tests, listens."""


class _Launcher(NamedTuple):
    """Which launcher: there is one for each."""

    python: str
    variables: frozenset[tuple[str, str]]


@functools.cache
def _started(launcher: _Launcher, _process: int) -> socket.socket:
    """The connection to a launcher of this process."""
    if _listening and launcher.python == sys.executable:
        own = socket.socket(socket.AF_UNIX, socket.SOCK_SEQPACKET)
        own.connect(_listening)
        return own
    own, theirs = socket.socketpair(socket.AF_UNIX, socket.SOCK_SEQPACKET)
    listener = socket.socket(socket.AF_UNIX, socket.SOCK_SEQPACKET)
    listener.bind(f"\0cartwheel-tests-{os.getpid()}-{len(_addresses)}")
    listener.listen(64)
    _addresses[launcher] = listener.getsockname()
    with theirs, listener:
        # It ends when this process has ended, which closes the socket.
        others = {name: os.environ[name] for name in os.environ if not name.startswith(_AT_START)}
        process = subprocess.Popen(
            [launcher.python, __file__, str(theirs.fileno()), str(listener.fileno())],
            env={**others, **dict(launcher.variables), "OPENBLAS_NUM_THREADS": "1"},
            pass_fds=[theirs.fileno(), listener.fileno()],
            stdin=subprocess.DEVNULL,
            cwd="/",
        )
    atexit.register(_end, own, process, os.getpid())
    return own


def shared() -> str:
    """Where this process's launcher listens, for `share` in the processes of a run of tests."""
    launcher = _Launcher(sys.executable, _VARIABLES)
    _started(launcher, os.getpid())
    return _addresses[launcher].hex()


def share(address: str) -> None:
    """Uses the launcher of another process, which has the same environment."""
    global _listening
    _listening = bytes.fromhex(address)


def _end(connection: socket.socket, process: subprocess.Popen[bytes], owner: int) -> None:
    connection.close()
    if owner == os.getpid():
        process.wait()


# From here on, in the launcher.


def _serve(control: socket.socket, listener: socket.socket) -> Callable[[], None]:
    """Forks for each request; returns only in a fork, with what it is to run."""
    running: dict[int, tuple[int, socket.socket]] = {}
    asking = {control.fileno(): control}
    poll = select.poll()
    poll.register(control, select.POLLIN)
    poll.register(listener, select.POLLIN)
    while True:
        for number, _ in poll.poll():
            if number in running:
                pid, answer = running.pop(number)
                poll.unregister(number)
                os.close(number)
                _, status = os.waitpid(pid, 0)
                with answer, contextlib.suppress(OSError):
                    answer.send(status.to_bytes(4, "little"))
                continue
            if number == listener.fileno():
                program, _ = listener.accept()
                asking[program.fileno()] = program
                poll.register(program, select.POLLIN)
                continue
            try:
                data, files, _, _ = socket.recv_fds(asking[number], _LONGEST, 4 + _MOST_FILES)
            except OSError:
                data, files = b"", []  # A killed program.
            if not data:
                if number == control.fileno():
                    sys.stdout = sys.stderr = None  # The test process has ended.
                    os._exit(0)
                poll.unregister(number)
                asking.pop(number).close()
                continue
            pid = os.fork()
            if pid == 0:
                return functools.partial(_become, json.loads(data), files[1:])
            answer = socket.socket(fileno=files[0])
            for file in files[1:]:
                os.close(file)
            with contextlib.suppress(OSError):  # Who asked may have been killed.
                answer.send(pid.to_bytes(4, "little"))
            watched = os.pidfd_open(pid)
            running[watched] = (pid, answer)
            poll.register(watched, select.POLLIN)


def _take_files(received: list[int], wanted: list[int]) -> None:
    """Gives the received files the wanted numbers, and closes all others."""
    above = max(wanted) + 1
    moved = [fcntl.fcntl(number, fcntl.F_DUPFD_CLOEXEC, above) for number in received]
    for number, file in zip(wanted, moved, strict=True):
        os.dup2(file, number)
    for file in [int(path.name) for path in Path("/dev/fd").iterdir()]:
        if file not in wanted:
            with contextlib.suppress(OSError):  # That of the listing itself.
                os.close(file)


def _become(request: Mapping[str, Any], files: list[int]) -> None:
    """Runs a start in this process."""
    _take_files(files, [0, 1, 2, *request["files"]])
    if request["name"]:
        Path("/proc/self/comm").write_text(request["name"])
    if request["session"]:
        os.setsid()
    os.chdir(request["folder"])
    os.environ.clear()
    os.environ.update(request["environment"])
    signal.signal(signal.SIGINT, signal.default_int_handler)
    _open_streams(unbuffered=bool(os.environ.get("PYTHONUNBUFFERED")))
    words = request["words"]
    if words[0] == str(PROGRAM):
        sys.argv = words
        sys.path.insert(0, str(PROGRAM.parent))
        from cartwheel.cli.main import main

        _leave(main)
    main_module = types.ModuleType("__main__")
    main_module.__builtins__ = __builtins__
    sys.modules["__main__"] = main_module
    # The same list, because functions of imported modules have it as their default value.
    sys.argv[:] = words[words[0] == sys.executable :]
    if sys.argv[0] == "-m":
        module = sys.argv.pop(1)
        sys.path.insert(0, str(Path.cwd()))
        _leave(lambda: runpy.run_module(module, run_name="__main__", alter_sys=True))
    if sys.argv[0] == "-c":
        name, source = "<string>", sys.argv.pop(1)
        sys.path.insert(0, "")
    else:
        name = main_module.__file__ = sys.argv[0]
        source = Path(name).read_bytes()
        sys.path.insert(0, str(Path(name).resolve().parent))
    _leave(lambda: exec(compile(source, name, "exec", dont_inherit=True), vars(main_module)))


def _leave(function: Callable[[], object]) -> NoReturn:
    """Runs it, and ends the process as the interpreter would."""
    status = 0
    try:
        function()
    except SystemExit as error:
        if error.code is not None and not isinstance(error.code, int):
            raise
        status = error.code or 0
    except KeyboardInterrupt:
        raise
    except BaseException as error:  # noqa: BLE001 - as the interpreter
        trace = error.__traceback__
        while trace is not None and trace.tb_frame.f_code.co_filename == __file__:
            trace = trace.tb_next
        error.__traceback__ = trace
        if sys.excepthook is sys.__excepthook__:
            traceback.print_exception(error)
        else:
            sys.excepthook(type(error), error, trace)
        status = 1
    # The interpreter would now free all objects, which takes a tenth of a second after so many
    # imports. Before that, it does this.
    threading._shutdown()
    atexit._run_exitfuncs()
    try:
        for stream in (sys.stdout, sys.stderr):
            if stream is not None:
                stream.flush()
    except (OSError, ValueError):
        sys.exit(status)  # It prints the reason, and has a status for this.
    os._exit(status & 0xFF)


def _open_streams(*, unbuffered: bool) -> None:
    for number, name in enumerate(("stdin", "stdout", "stderr")):
        buffering = 0 if unbuffered and number else -1
        binary = open(number, "wb" if number else "rb", buffering, closefd=False)  # noqa: SIM115
        (binary if unbuffered and number else binary.raw).name = f"<{name}>"
        errors = "backslashreplace" if number == 2 else sys.__stdin__.errors
        stream = io.TextIOWrapper(
            binary,
            encoding=sys.__stdin__.encoding,
            errors=errors,
            line_buffering=number == 2 or os.isatty(number),
            write_through=unbuffered and number > 0,
        )
        stream.mode = "w" if number else "r"
        setattr(sys, name, stream)
        setattr(sys, f"__{name}__", stream)


def _modules() -> Iterator[str]:
    """Cartwheel's modules."""
    import cartwheel

    for module in pkgutil.walk_packages(cartwheel.__path__, "cartwheel."):
        # Those of pytest's plugin import pytest, and a program's main module is not imported.
        if not module.name.startswith("cartwheel.testing") and not module.name.endswith("__main__"):
            yield module.name


def _main() -> Callable[[], None]:
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    # The folder of this file is no place for modules.
    sys.path.pop(0)
    gc.disable()
    for name in _OF_ROS1 if sys.executable == ROS1_PYTHON else (*_modules(), *_OTHERS):
        with contextlib.suppress(ImportError):  # It needs a package that is not installed.
            importlib.import_module(name)
    if sys.executable != ROS1_PYTHON:
        replace_starts()
    control, listener = (socket.socket(fileno=int(number)) for number in sys.argv[1:])
    global _listening
    _listening = listener.getsockname()
    gc.collect()
    # Otherwise a collection in a fork copies all pages.
    gc.freeze()
    gc.set_threshold(*RARE_COLLECTIONS)
    gc.enable()
    return _serve(control, listener)


if __name__ == "__main__":
    _main()()
