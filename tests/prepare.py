"""Builds the other projects' programs that tests use, before the tests need them.

Run ``python -m tests.prepare`` beside anything else. It prints what it built, or why not. The tests
build what is missing, wait for what is being built, and report what fails.
"""

import shutil
import subprocess
import sys
import time
from collections.abc import Callable

from tests.bridges import foxglove_client, ros2_peers
from tests.ros1 import conftest as ros1


def _timed(name: str, build: Callable[[], str]) -> bool:
    """Builds, and prints the time and the reason of a failure; returns whether it is built."""
    begin = time.monotonic()
    try:
        reason = build()
    except (OSError, subprocess.SubprocessError) as error:
        reason = str(error)
    seconds = f"{time.monotonic() - begin:.0f} s"
    print(f"{name}: {f'failed after {seconds}: {reason}' if reason else seconds}", flush=True)
    return not reason


def _foxglove() -> str:
    found = foxglove_client.modules()
    return found if isinstance(found, str) else ""


def _fastdds() -> str:
    ros2_peers.fastdds_peer()
    return ""


def _ros1() -> str:
    done = ros1.build()
    return done.stderr if done.returncode else ""


def _main() -> int:
    built = [_timed("Foxglove's client", _foxglove)]
    if not ros2_peers.REASON:
        built.append(_timed("Fast DDS peer", _fastdds))
    if shutil.which("catkin_make") is not None:
        built.append(_timed("ROS 1 workspace", _ros1))
    return 0 if all(built) else 1


if __name__ == "__main__":
    sys.exit(_main())
