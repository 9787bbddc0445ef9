"""The site has a place for each page, and pages for each command, option, code and public name."""

import os
import re
import sys
import tomllib
from pathlib import Path

import pytest
import typer
from tests import launching

import cartwheel
from cartwheel.cli.app import app
from cartwheel.codes import all_codes

from .pages import DOCS, ROOT
from .pages import commands as shown_commands

sys.path.insert(0, str(ROOT / "tools"))
import make_site
import site_pages


@pytest.fixture(scope="module")
def staged(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("site")
    make_site.stage(folder)
    return folder


def entries(navigation: list) -> list[str]:
    found = []
    for entry in navigation:
        value = entry if isinstance(entry, str) else next(iter(entry.values()))
        found += [value] if isinstance(value, str) else entries(value)
    return found


def test_the_navigation_has_each_page_once(staged: Path) -> None:
    navigation = tomllib.loads((staged / "zensical.toml").read_text())["project"]["nav"]
    pages = [path.relative_to(staged / "docs").as_posix() for path in staged.rglob("*.md")]
    assert sorted(entries(navigation)) == sorted(pages)
    assert [next(iter(group)) for group in navigation] == [
        "Home", "Tutorials", "How-to", "Reference", "Explanation",
    ]  # fmt: skip


def test_a_page_without_a_place_is_an_error() -> None:
    with pytest.raises(make_site.SiteError, match=r"lost\.md"):
        make_site.navigation({"index.md": "", "lost.md": ""})


def test_a_new_guide_has_a_place() -> None:
    assert '"how-to/new-guide.md"' in make_site.navigation({"how-to/new-guide.md": ""})


def test_links_to_moved_pages_follow() -> None:
    places = make_site.site_places()

    def link(target: str, source: str) -> str:
        return make_site.link(target, source, places)

    assert link("docs/ros2.md#time", "README.md") == "ros2.md#time"
    assert link("../plugins.md", "docs/plugins/imu-sensor.md") == "index.md"
    assert link("../README.md", "docs/index.md") == "index.md"
    assert link("../../README.md", "docs/tutorial/README.md") == "../index.md"
    assert link("../benchmarks/README.md#bridges", "docs/ros2.md") == "benchmarks.md#bridges"
    assert link("docs/images/browser.png", "README.md") == "images/browser.png"
    assert link("https://example.org/a.md", "README.md") == "https://example.org/a.md"
    with pytest.raises(make_site.SiteError, match=r"docs/ros2\.md: images/nothing\.png"):
        link("images/nothing.png", "docs/ros2.md")


def test_links_to_other_files_lead_to_the_repository(monkeypatch: pytest.MonkeyPatch) -> None:
    places = make_site.site_places()
    assert make_site.link("../examples", "docs/python.md", places) == ""
    monkeypatch.setattr(make_site, "REPOSITORY", "https://example.org/cartwheel")
    link = make_site.link("../examples", "docs/python.md", places)
    assert link == "https://example.org/cartwheel/tree/main/examples"


def test_codes_in_pages_link_to_their_pages() -> None:
    text = make_site.moved("docs/how-to/troubleshooting.md", make_site.site_places())
    assert "[`CW101 file-missing`](../codes/CW101.md)" in text
    assert "$ cartwheel explain CW101" in text


def commands(program: object, words: tuple[str, ...] = ()) -> dict[tuple[str, ...], object]:
    found = {}
    for name, command in program.commands.items():
        if hasattr(command, "commands"):
            found |= commands(command, (*words, name))
        else:
            found[*words, name] = command
    return found


def test_each_option_of_each_command_is_on_its_page(staged: Path) -> None:
    every = commands(typer.main.get_command(app))
    assert ("topic", "echo") in every and ("run",) in every
    for words, command in every.items():
        page = (staged / "docs" / "commands" / f"{words[0]}.md").read_text()
        _, heading, text = page.partition(f"# cartwheel {' '.join(words)}\n")
        assert heading, words
        text = re.split(r"^##? cartwheel ", text, flags=re.MULTILINE)[0]
        for option in command.params:
            if option.param_type_name == "option" and not option.hidden:
                assert all(name in text for name in option.opts), (words, option.opts)


def test_the_page_of_a_command_has_the_groups_of_its_help(staged: Path) -> None:
    page = (staged / "docs" / "commands" / "run.md").read_text()
    shown = launching.run(
        [sys.executable, "-m", "cartwheel", "run", "--help"],
        capture_output=True,
        text=True,
        check=True,
        env={**os.environ, "COLUMNS": "100"},
    ).stdout
    groups = re.findall(r"^(\w.*):$", shown, re.MULTILINE)
    assert len(groups) > 4
    assert re.findall(r"^## (.*)$", page, re.MULTILINE) == groups


def test_each_code_has_a_page_and_a_row(staged: Path) -> None:
    index = (staged / "docs" / site_pages.CODES).read_text()
    for code in all_codes():
        page = (staged / "docs" / site_pages.code_page(code)).read_text()
        assert page.startswith(f"# {code}\n")
        assert re.findall(r"^#+ .*$", page, re.MULTILINE)[1:3] == [
            "## Why it matters",
            "## Example",
        ]
        assert f"({code.number}.md) | `{code.name}` |" in index


def test_each_public_name_is_in_the_api(staged: Path) -> None:
    page = (staged / "docs" / site_pages.API).read_text()
    assert set(re.findall(r"^::: cartwheel\.(\w+)$", page, re.MULTILINE)) == {*cartwheel.__all__}


def test_the_commands_of_written_pages_work(staged: Path) -> None:
    """Without those of the codes: many of them show what fails."""
    ran = []
    path = f"{Path(sys.executable).parent}:{os.environ['PATH']}"
    for name in site_pages.pages():
        if not name.startswith("codes/CW"):
            for command in shown_commands(staged / "docs" / name):
                words = launching.shell(command.text)
                launching.run(words, check=True, env={**os.environ, "PATH": path})
                ran.append(command.text)
    assert "cartwheel explain CW204" in ran


def test_no_page_has_a_tag_that_a_browser_would_hide(staged: Path) -> None:
    """Such as a <gazebo> outside of code."""
    code = re.compile(r"```.*?```|(`+)(?!`).*?(?<!`)\1(?!`)|\\<|<!--.*?-->", re.DOTALL)
    shown = {"a", "br", "div", "img", "kbd", "p", "picture", "source", "sub", "sup"}
    for page in (staged / "docs").rglob("*.md"):
        tags = re.findall(r"</?([A-Za-z][\w.-]*)(?=[\s/>])", code.sub("", page.read_text()))
        assert set(tags) <= shown, page.relative_to(staged)


def test_written_pages_are_not_in_the_repository() -> None:
    assert not [name for name in site_pages.pages() if (DOCS / name).exists()]
