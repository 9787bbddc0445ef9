"""Starts the program and Python code without importing Cartwheel each time.

Importing Cartwheel takes most of a short command's time, and the tests start hundreds. Each test
process therefore has a launcher: a process that has imported Cartwheel, and forks for each start.
The fork gets the arguments, folder, environment and streams of the start, and then runs as the
program would. `Popen` and `run` are those of `subprocess` in all that tests use of them.

What differs: the parent is the launcher, ``/proc/PID/cmdline`` and ``/proc/PID/environ`` are the
launcher's, all modules are imported already, and hashes of strings have the same seed. Tests that
look at these, at the start-up or at the usage of children use `subprocess`.
"""

from __future__ import annotations

import atexit
import contextlib
import functools
import gc
import importlib
import inspect
import io
import json
import os
import pkgutil
import re
import select
import shlex
import signal
import socket
import subprocess
import sys
import traceback
import types
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any, NoReturn

PROGRAM = Path(sys.executable).with_name("cartwheel")
_OTHERS = (
    *("viser", "PIL.JpegImagePlugin", "PIL.PngImagePlugin", "websockets.sync.client", "xacro"),
    *("rosbags.typesys.stores.ros2_jazzy", "rosbags.typesys.stores.ros1_noetic"),
    # Of libraries, which import these in turn when they need them.
    *("numpy.ma", "typer._adapters", "typer._click.decorators", "pydantic.type_adapter"),
    *("pydantic.deprecated.class_validators", "pydantic.functional_validators", "sysconfig"),
    *("rich.console", "rich.table", "foxglove", "pydantic.plugin._loader", "rosbags.usertypes"),
)
"""Modules that are imported when they are needed."""
_AT_START = ("PYTHON", "LD_", "LC_", "LANG", "MUJOCO_", "CARTWHEEL_CODES_ONLY")
_LATER = {"PYTHONUNBUFFERED"}
_LONGEST = 200_000
"""Bytes of a request: more does not fit into a packet."""
_signature = inspect.signature(subprocess.Popen._execute_child)


class Popen(subprocess.Popen):
    """`subprocess.Popen`, from the launcher if that can start it."""

    _answer: socket.socket | None = None

    def _execute_child(self, *arguments: Any) -> None:
        start = _signature.bind(self, *arguments).arguments
        request = _request(start)
        if request is None:
            super()._execute_child(*arguments)
            return
        ends = [start[name] for name in ("p2cread", "c2pwrite", "errwrite")]
        streams = [number if end == -1 else end for number, end in enumerate(ends)]
        self._answer, theirs = socket.socketpair()
        with theirs:
            socket.send_fds(_launcher(), [request], [*streams, theirs.fileno()])
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


def shell(text: str) -> list[str]:
    """A shell's command, without the shell if it only starts the program."""
    if not text.startswith("cartwheel ") or re.search(r"[|&;<>()$`\\*?\[\]{}~#=%!\n]", text):
        return ["bash", "-c", f"set -o pipefail; {text}"]
    return [str(PROGRAM), *shlex.split(text)[1:]]


def _request(start: Mapping[str, Any]) -> bytes | None:
    """What the launcher is to start; None if that needs a process of its own."""
    args = start["args"]
    if isinstance(args, str | bytes | os.PathLike) or start["shell"] or start["executable"]:
        return None
    words = [os.fsdecode(word) for word in args]
    if words[0] == sys.executable and words[1:3] == ["-m", "cartwheel.cli.main"]:
        words = [str(PROGRAM), *words[3:]]
    code = len(words) > 2 and words[1] == "-c"
    script = len(words) > 1 and words[1].endswith(".py")
    if words[0] != str(PROGRAM) and not (words[0] == sys.executable and (code or script)):
        return None
    asked = ("preexec_fn", "pass_fds", "gid", "gids", "uid")
    if any(start.get(name) not in (None, (), []) for name in asked) or not start["close_fds"]:
        return None
    if start["umask"] != -1 or start.get("process_group", -1) not in (-1, None):
        return None
    given = os.environ if start["env"] is None else start["env"]
    environment = {os.fsdecode(name): os.fsdecode(value) for name, value in given.items()}
    if _at_start(environment) != _VARIABLES:
        return None
    folder = Path(os.fsdecode(start["cwd"] or ".")).absolute()
    if not folder.is_dir():
        return None
    request = {
        "words": words,
        "folder": str(folder),
        "environment": environment,
        "session": bool(start["start_new_session"]),
    }
    data = json.dumps(request).encode()
    return data if len(data) <= _LONGEST else None


def _at_start(environment: Mapping[str, str]) -> dict[str, str]:
    """The variables that Python and libraries read when they start."""
    return {
        name: value
        for name, value in environment.items()
        if name.startswith(_AT_START) and name not in _LATER
    }


_VARIABLES = _at_start(os.environ)
"""Of the launcher. Tests and libraries change those of this process."""


def _launcher() -> socket.socket:
    """The connection to the launcher."""
    return _started(os.getpid())


@functools.cache
def _started(_process: int) -> socket.socket:
    own, theirs = socket.socketpair(socket.AF_UNIX, socket.SOCK_SEQPACKET)
    with theirs:
        # It ends when this process has ended, which closes the socket.
        others = {name: os.environ[name] for name in os.environ if not name.startswith(_AT_START)}
        process = subprocess.Popen(
            [sys.executable, __file__, str(theirs.fileno())],
            env={**others, **_VARIABLES},
            pass_fds=[theirs.fileno()],
            stdin=subprocess.DEVNULL,
            cwd="/",
        )
    atexit.register(_end, own, process, os.getpid())
    return own


def _end(connection: socket.socket, process: subprocess.Popen[bytes], owner: int) -> None:
    connection.close()
    if owner == os.getpid():
        process.wait()


# From here on, in the launcher.


def _serve(control: socket.socket) -> Callable[[], None]:
    """Forks for each request; returns only in a fork, with what it is to run."""
    running: dict[int, tuple[int, socket.socket]] = {}
    poll = select.poll()
    poll.register(control, select.POLLIN)
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
            data, files, _, _ = socket.recv_fds(control, _LONGEST, 4)
            if not data:
                sys.stdout = sys.stderr = None  # The test process has ended.
                os._exit(0)
            pid = os.fork()
            if pid == 0:
                return functools.partial(_become, json.loads(data), files[:3])
            answer = socket.socket(fileno=files.pop())
            for file in files:
                os.close(file)
            answer.send(pid.to_bytes(4, "little"))
            watched = os.pidfd_open(pid)
            running[watched] = (pid, answer)
            poll.register(watched, select.POLLIN)


def _become(request: Mapping[str, Any], streams: list[int]) -> None:
    """Runs a start in this process."""
    for number, stream in enumerate(streams):
        os.dup2(stream, number)
    os.closerange(3, os.sysconf("SC_OPEN_MAX"))
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
    if words[1] == "-c":
        name, source = "<string>", words[2]
        sys.argv = ["-c", *words[3:]]
        sys.path.insert(0, "")
    else:
        name, source = words[1], Path(words[1]).read_bytes()
        sys.argv = words[1:]
        sys.path.insert(0, str(Path(words[1]).resolve().parent))
        main_module.__file__ = words[1]
    _leave(lambda: exec(compile(source, name, "exec", dont_inherit=True), vars(main_module)))


def _leave(function: Callable[[], object]) -> NoReturn:
    """Runs it, and ends the process as the interpreter would."""
    try:
        function()
    except (SystemExit, KeyboardInterrupt):
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
        sys.exit(1)
    sys.exit(0)


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


def _main() -> Callable[[], None]:
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    # The folder of this file is no place for modules.
    sys.path.pop(0)
    gc.disable()
    import cartwheel

    found = [module.name for module in pkgutil.walk_packages(cartwheel.__path__, "cartwheel.")]
    for name in (*found, *_OTHERS):
        # Those of pytest's plugin import pytest, and a program's main module is not imported.
        if not name.startswith("cartwheel.testing") and not name.endswith("__main__"):
            with contextlib.suppress(ImportError):  # It needs a package that is not installed.
                importlib.import_module(name)
    gc.collect()
    # Otherwise a collection in a fork copies all pages.
    gc.freeze()
    gc.enable()
    return _serve(socket.socket(fileno=int(sys.argv[1])))


if __name__ == "__main__":
    _main()()
