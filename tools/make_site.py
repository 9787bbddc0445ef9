#!/usr/bin/env python3
"""Build the documentation's site from docs/ and from the program, into the folder site/.

    python tools/make_site.py                           # what `make docs` does
    python tools/make_site.py --serve                   # shows it on http://localhost:8000
    python tools/make_site.py --publish 0.2 --latest    # commits it to the branch gh-pages

The pages are copied to build/site first: with those of `site_pages`, with the README as the first
page, and with links that lead out of docs/ set to where their target is on the site. A link that
leads nowhere, a warning and a page without a place in `NAVIGATION` fail the build.

Zensical builds the site. It is the successor of Material for MkDocs, which is supported until May
2027. Zensical has no hooks, so this program prepares the pages before it runs Zensical.
"""

from __future__ import annotations

import argparse
import fnmatch
import json
import os
import re
import shutil
import subprocess
import sys
from collections.abc import Mapping
from pathlib import Path, PurePosixPath

import site_pages
from cartwheel.codes import MODULES, all_codes

ROOT = Path(__file__).resolve().parent.parent
DOCS = ROOT / "docs"
SITE = ROOT / "site"
STAGE = ROOT / "build" / "site"
CONFIGURATION = ROOT / "tools" / "site" / "zensical.toml"

ELSEWHERE = {
    "README.md": "index.md",
    "docs/index.md": "pages.md",
    "CHANGELOG.md": "changelog.md",
    "CONTRIBUTING.md": "contributing.md",
    "SECURITY.md": "security-policy.md",
    "benchmarks/README.md": "benchmarks.md",
    "docs/plugins.md": "plugins/index.md",
}
"""Pages whose place on the site is not that below docs/."""

Entry = str | tuple[str, "str | list[Entry]"]
"""A pattern, a page with a title, or a section."""
_CODES: list[Entry] = [(title, [f"codes/CW{n}*.md"]) for n, title in enumerate(MODULES.values())]
NAVIGATION: list[tuple[str, list[Entry]]] = [
    (
        "Home",
        [
            "index.md",
            ("All pages", "pages.md"),
            "changelog.md",
            "contributing.md",
            "security-policy.md",
        ],
    ),
    ("Tutorials", ["quickstart.md", "tutorial/README.md", "tutorial/[0-9]*.md", "tutorial/*.md"]),
    (
        "How-to",
        [
            "how-to/index.md",
            "how-to/README.md",
            "check.md",
            "python.md",
            "testing.md",
            "scenarios.md",
            "python/state.md",
            "python/messages.md",
            "python/save-restore.md",
            "python/learning.md",
            "python/datasets.md",
            "ros1.md",
            "ros2.md",
            "foxglove.md",
            "recording.md",
            "corpus.md",
            "how-to/*.md",
        ],
    ),
    (
        "Reference",
        [
            ("Plugins and sensors", ["plugins/index.md", "plugins/*.md"]),
            ("Commands", ["commands/index.md", "commands/*.md"]),
            ("Diagnostic codes", ["codes/index.md", *_CODES]),
            "topics.md",
            "api.md",
            "plugin-api.md",
            "gazebo-tags.md",
            "controllers.md",
            "worlds.md",
            "stand-ins.md",
            "conventions.md",
            "reference/*.md",
        ],
    ),
    (
        "Explanation",
        [
            "physics.md",
            "gazebo-differences.md",
            "architecture.md",
            "decisions.md",
            "security.md",
            "performance.md",
            "benchmarks.md",
            "explanation/*.md",
        ],
    ),
]
"""The four kinds of pages. A pattern stands for those that match it and come nowhere before."""

REPOSITORY = os.environ.get("REPOSITORY_URL", "")
"""Where the repository can be read, without a branch. Links to files that are not on the site lead
there; without it they are plain text."""

_FENCED = re.compile(r"(^ *```.*?^ *```)", re.MULTILINE | re.DOTALL)
_CODE = re.compile(r"`[^`\n]+`")
_LINK = re.compile(r"(?<!!)\[([^\[\]]*)\]\(([^)\s]+)\)")
_TARGET = re.compile(
    r"(?<=\]\()[^)\s]+(?=\))|(?<= src=\")[^\"]+|(?<= srcset=\")[^\"]+|(?<= href=\")[^\"]+"
)
_CODE_NAME = re.compile(r"(?<!\[)`(CW\d{3})(?: [a-z0-9-]+)?`(?!\])")
"""A diagnostic code, which has a page of its own on the site."""
_COMMENT = re.compile(r"^<!--.*?-->\n", re.MULTILINE | re.DOTALL)


class SiteError(Exception):
    """A page that the site cannot hold."""


def main() -> int:
    """Builds, shows or publishes the site; returns the exit status."""
    parser = argparse.ArgumentParser(description="Build the documentation's site.")
    parser.add_argument("--serve", action="store_true", help="show it while it is written")
    parser.add_argument("--publish", metavar="VERSION", help="commit it to the branch gh-pages")
    parser.add_argument("--latest", action="store_true", help="show this version by default")
    arguments = parser.parse_args()
    try:
        stage(STAGE, versioned=bool(arguments.publish))
        if arguments.serve:
            generate("serve")
        elif arguments.publish:
            publish(arguments.publish, latest=arguments.latest)
        else:
            build()
    except SiteError as error:
        print(error, file=sys.stderr)
        return 1
    except subprocess.CalledProcessError as error:
        return error.returncode
    except KeyboardInterrupt:  # which ends --serve
        return 130
    return 0


def build() -> None:
    """Builds the site from what is staged; any warning is an error."""
    generate("build", "--clean", "--strict")
    shutil.rmtree(SITE, ignore_errors=True)
    shutil.copytree(STAGE / "site", SITE)


def publish(version: str, *, latest: bool) -> None:
    """Builds the site and commits it to the local branch gh-pages, beside the other versions."""
    from mike import commands

    site = {"site_dir": str(SITE), "use_directory_urls": True}
    aliases = ["latest"] if latest else []
    message = f"Documentation of {version}"
    with commands.deploy(
        site, version, aliases=aliases, update_aliases=True, message=message, allow_empty=True
    ):
        build()
    # Until there is a latest version, the first page leads to this one.
    released = any("latest" in info.aliases for info in commands.list_versions())
    commands.set_default("latest" if released else version, allow_empty=True)


def generate(*words: str) -> None:
    """Runs the generator on what is staged."""
    command = [sys.executable, "-m", "zensical", *words, "-f", "zensical.toml"]
    subprocess.run(command, cwd=STAGE, check=True)


def stage(folder: Path, *, versioned: bool = False) -> None:
    """Writes all that the generator reads to a folder.

    Args:
        folder: Is replaced.
        versioned: The pages offer a choice of versions.

    Raises:
        SiteError: A page has no place in the navigation, or a link no target.
    """
    shutil.rmtree(folder, ignore_errors=True)
    target = folder / "docs"
    shutil.copytree(DOCS, target, ignore=shutil.ignore_patterns("*.md"))
    shutil.copytree(CONFIGURATION.parent / "assets", target / "assets")
    places = site_places()
    pages = {place: moved(source, places) for source, place in places.items()}
    written = site_pages.pages()
    if both := pages.keys() & written.keys():
        raise SiteError(f"written from the program, and in docs/ too: {', '.join(sorted(both))}")
    pages |= written
    for place, text in pages.items():
        write(target / place, text)
    configuration = CONFIGURATION.read_text().replace("nav = []", f"nav = {navigation(pages)}")
    if versioned:
        configuration += '\n[project.extra.version]\nprovider = "mike"\n'
    write(folder / "zensical.toml", configuration.replace("@src@", str(ROOT / "src")))


def write(path: Path, text: str) -> None:
    """Writes a file, and the folders that it needs."""
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(text, encoding="utf-8")


def site_places() -> dict[str, str]:
    """The path on the site of each page of the repository, by its path there."""
    pages = [path.relative_to(ROOT).as_posix() for path in sorted(DOCS.rglob("*.md"))]
    found = {page: page.removeprefix("docs/") for page in pages}
    return found | {name: place for name, place in ELSEWHERE.items() if (ROOT / name).is_file()}


def moved(source: str, places: dict[str, str]) -> str:
    """The text of a page, with links that hold at its place on the site, and links from codes."""
    place = places[source]
    known = {code.number: code for code in all_codes()}

    def whole(match: re.Match[str]) -> str:
        return match[0] if link(match[2], source, places) else match[1]

    def explained(match: re.Match[str]) -> str:
        code = known.get(match[1])
        return f"[{match[0]}]({relative(site_pages.code_page(code), place)})" if code else match[0]

    def target(match: re.Match[str]) -> str:
        return link(match[0], source, places)

    parts = _FENCED.split((ROOT / source).read_text(encoding="utf-8"))
    for index in range(0, len(parts), 2):
        # In code the generator keeps the backslash, which other readers of tables need.
        part = _CODE.sub(lambda match: match[0].replace("\\|", "|"), _COMMENT.sub("", parts[index]))
        parts[index] = _CODE_NAME.sub(explained, _TARGET.sub(target, _LINK.sub(whole, part)))
    return "".join(parts)


def link(target: str, source: str, places: dict[str, str]) -> str:
    """Where a link of a page leads on the site; empty if to a file that only the repository has.

    Raises:
        SiteError: The target does not exist.
    """
    name, mark, anchor = target.partition("#")
    if not name or ":" in name:
        return target
    path = Path(os.path.normpath(ROOT / Path(source).parent / name))
    # The generator looks for pages and headings alone, not for images and other files.
    if not path.exists() or not path.is_relative_to(ROOT):
        raise SiteError(f"{source}: {target} does not exist")
    if path.is_dir() and (path / "README.md").is_file():
        path /= "README.md"
    inside = path.relative_to(ROOT).as_posix()
    if inside in places or (path.is_file() and path.is_relative_to(DOCS)):
        place = places.get(inside, inside.removeprefix("docs/"))
        return f"{relative(place, places[source])}{mark}{anchor}"
    if not REPOSITORY:
        return ""
    return f"{REPOSITORY}/{'tree' if path.is_dir() else 'blob'}/main/{inside}{mark}{anchor}"


def relative(place: str, start: str) -> str:
    """The link from one page of the site to another."""
    return os.path.relpath(place, PurePosixPath(start).parent)


def navigation(pages: Mapping[str, str]) -> str:
    """`NAVIGATION` with its patterns replaced by pages, as TOML.

    Raises:
        SiteError: A page comes nowhere.
    """
    left = sorted(pages)

    def taken(pattern: str) -> list[str]:
        found = fnmatch.filter(left, pattern)
        left[:] = [page for page in left if page not in found]
        return found

    def titled(title: str, value: str) -> str:
        return f"{{ {json.dumps(title, ensure_ascii=False)} = {value} }}"

    def listed(entries: list[Entry]) -> str:
        parts = []
        for entry in entries:
            if isinstance(entry, str):
                parts += [json.dumps(page) for page in taken(entry)]
            elif isinstance(entry[1], str):
                parts += [titled(entry[0], json.dumps(page)) for page in taken(entry[1])]
            else:
                parts.append(titled(entry[0], f"[{listed(entry[1])}]"))
        return ", ".join(parts)

    text = f"[{', '.join(titled(title, f'[{listed(entries)}]') for title, entries in NAVIGATION)}]"
    if left:
        raise SiteError(f"not in NAVIGATION of tools/make_site.py: {', '.join(left)}")
    return text


if __name__ == "__main__":
    raise SystemExit(main())
