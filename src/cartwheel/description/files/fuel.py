"""Models from Gazebo's Fuel server that Gazebo has downloaded to this machine.

Nothing is downloaded here, because a simulation must not depend on the network. Source:
gz-fuel-tools, LocalCache.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping
from pathlib import Path
from urllib.parse import unquote

_URL = re.compile(
    r"https?://(?P<host>[^/]+)/(?:[\d.]+/)?(?P<owner>[^/]+)/models/(?P<name>[^/]+)"
    r"(?:/(?P<version>tip|\d+))?(?:/files)?(?:/(?P<file>.+?))?/?",
    re.IGNORECASE,
)
_HOSTS = ("fuel.gazebosim.org", "fuel.ignitionrobotics.org")
"""The server's current and former name: a model is the same on both."""
_VARIABLES = ("GZ_FUEL_CACHE_PATH", "IGN_FUEL_CACHE_PATH")
_CACHES = ("~/.gz/fuel", "~/.ignition/fuel")


def model_name(uri: str) -> str | None:
    """The model name in a Fuel URL; None for any other URL."""
    found = _URL.fullmatch(uri.strip())
    return unquote(found["name"]) if found is not None else None


def cached(uri: str, environment: Mapping[str, str]) -> Path | None:
    """The model's folder, or the file in the URL, in Gazebo's caches.

    Args:
        uri: ``https://fuel.gazebosim.org/1.0/<owner>/models/<name>``, optionally with a version and
            a file.
        environment: ``GZ_FUEL_CACHE_PATH`` takes precedence over the caches in the home folder.

    Returns:
        None for any other URL or if the model was not downloaded. Without a version, the newest
        one.
    """
    found = _URL.fullmatch(uri.strip())
    if found is None:
        return None
    for folder in _folders(found, environment):
        versions = {int(each.name): each for each in _numbered(folder)}
        stated = found["version"]
        if stated and stated.isdigit() and int(stated) in versions:
            chosen = versions[int(stated)]
        elif versions:
            chosen = versions[max(versions)]
        else:
            continue
        if not found["file"]:
            return chosen
        if (chosen / unquote(found["file"])).is_file():
            return chosen / unquote(found["file"])
    return None


def caches(environment: Mapping[str, str]) -> list[Path]:
    """Gazebo's caches; the folder in the environment variable comes first."""
    roots = [environment[each] for each in _VARIABLES if environment.get(each)]
    return [Path(root).expanduser() for root in (*roots, *_CACHES)]


def _folders(found: re.Match[str], environment: Mapping[str, str]) -> Iterator[Path]:
    owner, name = unquote(found["owner"]), unquote(found["name"])
    for root in caches(environment):
        for host in dict.fromkeys((found["host"].lower(), *_HOSTS)):
            for spelled in dict.fromkeys(((owner, name), (owner.lower(), name.lower()))):
                yield root / host / spelled[0] / "models" / spelled[1]


def _numbered(folder: Path) -> list[Path]:
    try:
        return [each for each in folder.iterdir() if each.name.isdigit()]
    except OSError:
        return []
