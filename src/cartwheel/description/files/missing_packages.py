"""What to do about a missing file, package or model."""

from __future__ import annotations

import os
from collections.abc import Mapping
from typing import NamedTuple


class Advice(NamedTuple):
    """What to do about a missing file, package or model."""

    meant: str
    """The likely name, or an empty string."""
    hint: str


def how_to_install(package: str, environment: Mapping[str, str] | None = None) -> str:
    """A sentence on how to install a package.

    Args:
        package: The package.
        environment: For tests; `os.environ` otherwise.
    """
    distribution = (os.environ if environment is None else environment).get("ROS_DISTRO")
    if distribution:
        debian = f"ros-{distribution}-{package.replace('_', '-')}"
        return f"Run: sudo apt install {debian}. Or clone the source into the workspace."
    return "Install the package with apt as ros-<distribution>-<name>, or clone the source."
