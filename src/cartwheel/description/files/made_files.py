"""Files that a build makes, and that a repository does not contain therefore."""

from __future__ import annotations

import contextlib
import re
from pathlib import Path

from cartwheel.description.files.regular_files import read_regular_text

_TEMPLATES = (".jinja", ".jinja2", ".j2", ".erb", ".em", ".in")
"""Ends of the names of the files from which a build makes others."""
_BUILDS = "CMakeLists.txt"
_NEAREST = 4
"""Number of folders above a file that are searched for the build."""
_MOST_BYTES = 400_000


def maker_of(file: Path) -> Path | None:
    """The template from which a build makes a file, or the CMakeLists.txt that names it.

    Args:
        file: A file that does not exist, such as ``models/arm/arm.sdf``.
    """
    for end in _TEMPLATES:
        template = Path(f"{file}{end}")
        if template.is_file():
            return template
    named = re.compile(rf"(?<![\w.-]){re.escape(f'{file.parent.name}/{file.name}')}(?![\w.-])")
    for folder in list(file.parents)[:_NEAREST]:
        builds = folder / _BUILDS
        with contextlib.suppress(OSError):
            if named.search(read_regular_text(builds, _MOST_BYTES)):
                return builds
    return None
