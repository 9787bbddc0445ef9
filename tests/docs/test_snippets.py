"""What pages quote is what the files say, and the Python they show runs."""

import sys
from pathlib import Path

import pytest
from tests import launching

from .pages import DOCS, PAGES, ROOT, STEPS, Block, blocks

TUTORIAL = sorted(page for page in (DOCS / "tutorial").glob("*.md") if page.stem != "README")
WITH_PYTHON = [page for page in PAGES if page.is_file() and blocks(page, "python")]
EXAMPLES = sorted((ROOT / "examples").glob("[0-9]*.py"))


def plain(text: str) -> list[str]:
    """Its lines without the indentation, which a quotation may lose."""
    return [line.strip() for line in text.splitlines() if line.strip()]


def is_excerpt(block: Block, files: list[Path]) -> bool:
    wanted = plain("\n".join(block.lines))
    for file in files:
        lines = plain(file.read_text())
        starts = range(len(lines) - len(wanted) + 1)
        if any(lines[start : start + len(wanted)] == wanted for start in starts):
            return True
    return False


@pytest.mark.parametrize("page", TUTORIAL, ids=lambda page: page.stem)
def test_the_tutorial_quotes_its_files(page: Path) -> None:
    folder = STEPS / page.stem
    files = [file for file in folder.rglob("*") if file.is_file()]
    assert files, f"{page.name} has no files under steps/{page.stem}"
    quoted = blocks(page, "xml")
    assert quoted, f"{page.name} shows no file"
    for block in quoted:
        assert is_excerpt(block, files), f"{block} is in no file of steps/{page.stem}"


def test_a_changed_quotation_is_noticed() -> None:
    block = Block(page=TUTORIAL[0], line=1, language="xml", lines=['<mass value="-1"/>'])
    assert not is_excerpt(block, list((STEPS / TUTORIAL[0].stem).rglob("*.xacro")))


def test_every_step_has_its_page() -> None:
    assert [page.stem for page in TUTORIAL] == sorted(folder.name for folder in STEPS.iterdir())


@pytest.mark.parametrize("page", WITH_PYTHON, ids=lambda page: str(page.relative_to(ROOT)))
def test_the_python_of_a_page_runs(page: Path, tmp_path: Path) -> None:
    """All of a page's blocks together, one after the other, as a reader would type them."""
    script = tmp_path / f"{page.stem}.py"
    parts = []
    for block in blocks(page, "python"):
        if "not run" not in block.notes:
            parts += [f"# {block}", *block.lines]
    script.write_text("\n".join(parts) + "\n")
    run(script, tmp_path)


@pytest.mark.parametrize("script", EXAMPLES, ids=lambda script: script.stem)
def test_an_example_runs(script: Path, tmp_path: Path) -> None:
    run(script, tmp_path)


def test_the_examples_are_numbered_from_one() -> None:
    assert [int(script.name[:2]) for script in EXAMPLES] == list(range(1, len(EXAMPLES) + 1))


def run(script: Path, folder: Path) -> None:
    done = launching.run(
        [sys.executable, str(script)],
        cwd=folder,
        capture_output=True,
        text=True,
        timeout=240,
        check=False,
    )
    assert done.returncode == 0, f"{done.stdout}\n{done.stderr}"
