"""Builds the other projects' programs that tests use, before the tests need them.

Run ``python -m tests.prepare`` beside anything else. The tests build what is missing, wait for
what is being built, and report what fails.
"""

import contextlib
import shutil
import subprocess
from concurrent.futures import ThreadPoolExecutor

from tests.bridges import foxglove_client, ros2_peers, test_ros2_client
from tests.ros1 import conftest as ros1


def _build_others() -> None:
    foxglove_client.modules()
    if not ros2_peers.REASON:
        with contextlib.suppress(subprocess.CalledProcessError):
            ros2_peers.fastdds_peer()
    if shutil.which("catkin_make") is not None:
        ros1.build()


if __name__ == "__main__":
    with ThreadPoolExecutor() as pool:
        pool.submit(_build_others)
        if shutil.which("cargo") is not None:
            # The longest.
            test_ros2_client.build()
