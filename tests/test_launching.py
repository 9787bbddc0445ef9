"""The launcher starts programs as `subprocess` does."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest
from tests import launching

TRACE = "Traceback (most recent call last):\n"
WAYS = pytest.mark.parametrize("way", [subprocess, launching], ids=lambda way: way.__name__)


def done(way: Any, code: str, *words: str, **options: Any) -> tuple[int, str, str]:
    found = way.run(
        [sys.executable, "-c", code, *words], capture_output=True, text=True, timeout=120, **options
    )
    return found.returncode, found.stdout, found.stderr


def test_the_launcher_starts_them() -> None:
    code = "import os; print(os.getppid())"
    assert done(subprocess, code)[1] == f"{os.getpid()}\n"
    first, second = (int(done(launching, code)[1]) for _ in range(2))
    assert first == second != os.getpid()


@WAYS
def test_a_start_gets_what_it_is_given(way: Any, tmp_path: Path) -> None:
    code = """
import os, sys
print(sys.argv, os.getcwd(), os.environ["FIRST"], "HOME" in os.environ, sys.stdin.read())
print(sys.stdout.name, sys.stdout.encoding, sys.stdout.line_buffering, sys.path[0] == "")
print(os.getsid(0) == os.getpid(), __name__, sorted(os.listdir("/dev/fd")), file=sys.stderr)
"""
    environment = {name: value for name, value in os.environ.items() if name != "HOME"}
    options = {"cwd": tmp_path, "env": {**environment, "FIRST": "ä b"}, "input": "typed"}
    status, output, errors = done(way, code, "a", "ü", start_new_session=True, **options)
    assert status == 0, errors
    assert output.splitlines() == [
        f"['-c', 'a', 'ü'] {tmp_path} ä b False typed",
        "<stdout> utf-8 False True",
    ]
    # The listing itself has a descriptor.
    assert errors == "True __main__ ['0', '1', '2', '3']\n"


@WAYS
@pytest.mark.parametrize(
    ("code", "status", "errors"),
    [
        ("", 0, ""),
        ("import sys; sys.exit(3)", 3, ""),
        ("import sys; sys.exit('no')", 1, "no\n"),
        ("import os, signal; os.kill(os.getpid(), signal.SIGKILL)", -signal.SIGKILL, ""),
        ("import atexit, sys; atexit.register(print, 'end', file=sys.stderr)", 0, "end\n"),
        ("1 +", 1, '  File "<string>", line 1\n    1 +\n'),
        ("\n1 / 0", 1, f'{TRACE}  File "<string>", line 2, in <module>\n'),
    ],
    ids=["nothing", "status", "text", "signal", "atexit", "syntax", "error"],
)  # fmt: skip
def test_it_ends_in_the_same_way(way: Any, code: str, status: int, errors: str) -> None:
    found, output, said = done(way, code)
    assert (found, output) == (status, "")
    assert said.startswith(errors) and bool(said) == bool(errors)
    assert "launching" not in said


@WAYS
def test_it_is_interrupted_waited_for_and_killed(way: Any) -> None:
    code = """
import time
print("up", flush=True)
try: time.sleep(600)
except KeyboardInterrupt: print("x")
"""
    options = {"stdout": subprocess.PIPE, "text": True}
    with way.Popen([sys.executable, "-c", code], **options) as process:
        assert process.stdout.readline() == "up\n"
        assert process.poll() is None
        with pytest.raises(subprocess.TimeoutExpired):
            process.wait(0.01)
        process.send_signal(signal.SIGINT)
        assert process.communicate(timeout=120) == ("x\n", None)
    assert process.returncode == 0
    with way.Popen([sys.executable, "-c", code], **options) as process:
        assert process.stdout.readline() == "up\n"
        process.kill()
        assert process.wait(120) == process.poll() == -signal.SIGKILL


@WAYS
def test_a_script_is_run(way: Any, tmp_path: Path) -> None:
    (tmp_path / "beside.py").write_text("VALUE = 4\n")
    script = tmp_path / "script.py"
    script.write_text("import sys, beside\nprint(beside.VALUE, sys.argv, __file__, __name__)\n")
    found = way.run([sys.executable, script, "x"], capture_output=True, text=True, check=True)
    assert found.stdout == f"4 {[str(script), 'x']} {script} __main__\n"


@WAYS
def test_a_module_is_run(way: Any, tmp_path: Path) -> None:
    (tmp_path / "beside.py").write_text("VALUE = 4\n")
    text = "import sys, beside\nprint(beside.VALUE, sys.argv, __file__, __name__, __package__)\n"
    (tmp_path / "module.py").write_text(text)
    command = [sys.executable, "-m", "module", "x"]
    found = way.run(command, cwd=tmp_path, capture_output=True, text=True, check=True)
    file = tmp_path / "module.py"
    assert found.stdout == f"4 {[str(file), 'x']} {file} __main__ \n"


@WAYS
def test_the_program_is_run(way: Any) -> None:
    found = way.run([launching.PROGRAM, "--nonsense"], capture_output=True, text=True, check=False)
    assert found.returncode == 2 and found.stderr.startswith("error: ")
    with pytest.raises(subprocess.CalledProcessError):
        way.run([launching.PROGRAM, "--nonsense"], capture_output=True, check=True)


def test_variables_that_are_read_at_the_start_need_a_process_of_its_own() -> None:
    code = "import os; print(os.getppid())"
    for name in ("MUJOCO_GL", "PYTHONHASHSEED", "LD_BIND_NOW"):
        found = done(
            launching, code, env={**os.environ, name: "1" if name != "MUJOCO_GL" else "egl"}
        )
        assert found[1] == f"{os.getpid()}\n", name


@WAYS
def test_output_is_unbuffered_on_request(way: Any) -> None:
    code = "import os; print('first'); os._exit(0)"
    for value, output in (("", ""), ("1", "first\n")):
        assert done(way, code, env={**os.environ, "PYTHONUNBUFFERED": value})[1] == output


def test_a_command_of_a_shell_starts_the_program_or_a_shell() -> None:
    program = str(launching.PROGRAM)
    assert launching.shell("cartwheel check 'a b'") == [program, "check", "a b"]
    assert launching.shell("cartwheel check a > b")[:2] == ["bash", "-c"]
    assert launching.shell("python a.py")[:2] == ["bash", "-c"]
