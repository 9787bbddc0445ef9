"""Finds the source files of a library, such as a plugin's, by the CMakeLists.txt that builds it."""

from __future__ import annotations

import contextlib
import functools
import itertools
import re
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path

from cartwheel.description.files.package_folders import is_file
from cartwheel.description.files.regular_files import read_start
from cartwheel.description.files.source_folders import source_folders

_LISTS = "CMakeLists.txt"
_COMMENT = re.compile(r"#[^\n]*")
_COMMAND = re.compile(
    r"\b(project|set|file|(?:rosbuild_|gz_|ament_auto_)?add_library)\s*\(([^()]*)\)",
    re.IGNORECASE,
)
_VARIABLE = re.compile(r"\$\{(\w+)\}")
_HERE = re.compile(r"\$\{(?:PROJECT|CMAKE)(?:_CURRENT)?_(?:SOURCE|LIST)_DIR\}/?")
_INCLUDE = re.compile(r'^[ \t]*#[ \t]*include[ \t]*[<"]([^<>"\n]+)[>"]', re.MULTILINE)
_SOURCES = (".cpp", ".cc", ".cxx", ".c", ".hpp", ".hh", ".h", ".hxx")
_PATTERN = "\0"
"""The first character of words that are patterns of file names."""
_MOST_FOLDERS = 2000
"""Maximum number of folders that are searched."""
_MOST_LISTS, _MOST_FILES = 200, 60
"""Maximum number of CMakeLists.txt that are read, and of source files."""
_MOST_PARENTS, _MOST_LISTED = 20, 1000
"""Maximum number of folders that patterns name, and of files that are listed in each."""
_LISTS_BYTES, _FILE_BYTES = 100_000, 500_000
"""Number of bytes that are read of each."""
_MOST_IN_LISTS, _MOST_LIBRARIES = 200_000, 500
"""Maximum number of words that are read in a CMakeLists.txt, with those of its variables, and of
libraries."""
_MOST_WORDS, _LONGEST = 1000, 500
"""Maximum number of words of a list in CMake, and of characters of a word."""


def library_sources(name: str, folder: Path) -> Iterator[str]:
    """The texts of the source files of a library, with the headers of the same package.

    Args:
        name: Its name, without ``lib`` and ``.so``.
        folder: The folder that is searched for the CMakeLists.txt which builds it.
    """
    lists = (
        here / _LISTS
        for here, names in itertools.islice(source_folders(folder), _MOST_FOLDERS)
        if _LISTS in names
    )
    for path in itertools.islice(lists, _MOST_LISTS):
        sources = _built(name, path, folder.resolve())
        if sources:
            yield from _read(sources, path.parent, folder.resolve())
            return


def _built(name: str, lists: Path, within: Path) -> list[Path]:
    """The source files from which a CMakeLists.txt builds a library; none if it does not."""
    try:
        state = lists.stat()
        words = _libraries(lists, state.st_mtime_ns, state.st_size).get(name, ())
    except OSError:
        return []
    stated = [word for word in words if not word.startswith(_PATTERN)]
    patterns = [word[1:] for word in words if word.startswith(_PATTERN)]
    globbed = itertools.islice(_globbed(lists.parent, patterns, within), _MOST_FILES)
    files = (lists.parent / word for word in (*stated, *globbed))
    return [path for path in itertools.islice(files, _MOST_FILES) if is_file(path)]


@functools.lru_cache(maxsize=_MOST_LISTS)
def _libraries(lists: Path, _changed: int, _size: int) -> Mapping[str, Sequence[str]]:
    """The words that state the source files of the libraries in a CMakeLists.txt, by their names.

    A robot may have many plugins, so that a file is read once. `_changed` and `_size` are its own.
    """
    text = read_start(lists, _LISTS_BYTES).decode("utf-8", "replace")
    found: dict[str, Sequence[str]] = {}
    known: dict[str, list[str]] = {}
    left = _MOST_IN_LISTS
    for command in _COMMAND.finditer(_COMMENT.sub("", text)):
        verb = command[1].lower()
        words = [_HERE.sub("", word.strip('"')) for word in command[2].split()[:_MOST_WORDS]]
        words = [*itertools.islice(_expanded(words, known), _MOST_WORDS)]
        left -= len(words)
        if left < 0:
            break
        if not words:
            continue
        if verb == "project":
            known["PROJECT_NAME"] = words[:1]
        elif verb == "set":
            known[words[0]] = words[1:]
        elif verb == "file" and words[0].upper() in ("GLOB", "GLOB_RECURSE") and words[1:]:
            # Folders are only listed for the library that is sought.
            known[words[1]] = [f"{_PATTERN}{word}" for word in words[2:]]
        elif verb.endswith("add_library") and len(found) < _MOST_LIBRARIES:
            files = (
                each for each in words[1:] if each.startswith(_PATTERN) or each.endswith(_SOURCES)
            )
            found.setdefault(words[0], [*itertools.islice(files, _MOST_FILES)])
    return found


def _expanded(words: list[str], known: Mapping[str, list[str]]) -> Iterator[str]:
    """Words of CMake with the values of its variables, which are lists."""
    for word in words:
        whole = _VARIABLE.fullmatch(word)
        if whole is not None:
            yield from known.get(whole[1], ())
        elif len(word) <= _LONGEST:
            yield _VARIABLE.sub(lambda found: "".join(known.get(found[1], ())[:1]), word)[:_LONGEST]


def _globbed(folder: Path, patterns: list[str], within: Path) -> Iterator[str]:
    """The source files in the folders that patterns such as ``src/*.cpp`` name."""
    parents = {
        parent: None
        for parent, _, name in (pattern.rpartition("/") for pattern in patterns)
        if "*" not in parent and name.startswith("*")
    }
    for parent in itertools.islice(parents, _MOST_PARENTS):
        with contextlib.suppress(OSError, ValueError):
            if not (folder / parent).resolve().is_relative_to(within):
                continue
            for path in sorted(itertools.islice((folder / parent).iterdir(), _MOST_LISTED)):
                if path.name.endswith(_SOURCES):
                    yield f"{parent}/{path.name}".lstrip("/")


def _read(sources: list[Path], package: Path, within: Path) -> Iterator[str]:
    """The texts of source files, and of the package's headers that they include, in a folder."""
    left, seen = [*reversed(sources)], set[Path]()
    headers: dict[str, Path] | None = None
    while left and len(seen) < _MOST_FILES:
        path = left.pop()
        if path in seen:
            continue
        seen.add(path)
        if not path.resolve().is_relative_to(within):
            continue
        try:
            text = read_start(path, _FILE_BYTES).decode("utf-8", "replace")
        except OSError:
            continue
        yield text
        included = [found.rpartition("/")[2] for found in _INCLUDE.findall(text)]
        if included and headers is None:
            headers = {
                name: here / name
                for here, names in itertools.islice(source_folders(package), _MOST_FOLDERS)
                for name in names
                if name.endswith(_SOURCES)
            }
        left += [headers[name] for name in included if headers and name in headers]
