"""Models of Gazebo's Fuel server that Gazebo downloaded to this machine before.

Nothing is downloaded here: a run must not depend on a network. Source: gz-fuel-tools, LocalCache.
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
"""The server's new name and its old one: a model is the same under both."""
_VARIABLES = ("GZ_FUEL_CACHE_PATH", "IGN_FUEL_CACHE_PATH")
_CACHES = ("~/.gz/fuel", "~/.ignition/fuel")


def model_name(uri: str) -> str | None:
    """The name of the model that a Fuel URL means; None where it is no such URL."""
    found = _URL.fullmatch(uri.strip())
    return unquote(found["name"]) if found is not None else None


def cached(uri: str, environment: Mapping[str, str]) -> Path | None:
    """The model's folder, or the file in it that the URL names, in Gazebo's caches.

    Args:
        uri: ``https://fuel.gazebosim.org/1.0/<owner>/models/<name>``, perhaps with a version
            and a file.
        environment: Its ``GZ_FUEL_CACHE_PATH`` comes before the caches of the home folder.

    Returns:
        None where it is no such URL or was not downloaded. Without a stated version, the newest.
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
    """Gazebo's caches, the one that a variable names first."""
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
