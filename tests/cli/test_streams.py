"""Programs that are started without standard streams, or under limits of the system."""

import resource
import subprocess

import pytest
from tests.cli.conftest import PROGRAM

from cartwheel.codes.command import INTERNAL_FAULT, SYSTEM_LIMIT

RUN = ("run", "--headless", "--for", "0.2", "--speed", "max")


def start_without(program, numbers, *arguments):
    """Runs the command with some of its standard streams closed."""
    script = 'exec "$@" ' + " ".join(f"{number}>&-" for number in numbers)
    return subprocess.run(
        ["sh", "-c", script, "sh", str(PROGRAM), *arguments],
        capture_output=True,
        text=True,
        env=program.environment,
        cwd=program.folder,
        check=False,
        timeout=200,
    )


@pytest.mark.parametrize("numbers", [(1,), (0, 1, 2)])
def test_missing_streams_are_nobodys(program, numbers):
    done = start_without(program, numbers, *RUN, "--record", "a.mcap")
    assert (done.returncode, "Traceback" in done.stderr) == (0, False), done.stderr
    info = program("info", "a.mcap").stdout
    assert "/clock" in info


@pytest.fixture
def limited(program):
    """What is said by a run that may open too few files."""

    def limit():
        resource.setrlimit(resource.RLIMIT_NOFILE, (16, 16))

    process = program.start(*RUN, "--ros2", "--record", "a.mcap", preexec_fn=limit)
    _, said = process.communicate(timeout=200)
    assert process.returncode == 2
    return said


def test_a_limit_of_the_system_is_named(limited):
    assert f"[{SYSTEM_LIMIT}]" in limited
    assert INTERNAL_FAULT.number not in limited


@pytest.mark.wording
def test_a_limit_of_the_system_comes_with_its_remedy(limited):
    assert "ulimit -n" in limited
