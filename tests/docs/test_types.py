"""The Python that the pages and examples show has types that a strict checker accepts."""

import json
import subprocess
import sys
from pathlib import Path

from .pages import ROOT, blocks
from .test_snippets import EXAMPLES, WITH_PYTHON

SETTINGS = {"typeCheckingMode": "strict", "pythonVersion": "3.11"}


def checked(folder: Path) -> list[str]:
    """What pyright's strict mode finds in the files of a folder, by its fork on PyPI."""
    settings = {**SETTINGS, "extraPaths": [str(ROOT / "src")]}
    (folder / "pyrightconfig.json").write_text(json.dumps(settings))
    done = subprocess.run(
        [sys.executable, "-m", "basedpyright", "-p", ".", "--pythonpath", sys.executable,
         "--outputjson"],
        cwd=folder, capture_output=True, text=True, timeout=300, check=False,
    )  # fmt: skip
    report = json.loads(done.stdout)
    assert report["summary"]["filesAnalyzed"] == len(list(folder.glob("*.py")))
    return [
        f"{Path(found['file']).name}:{found['range']['start']['line'] + 1}: {found['message']}"
        for found in report["generalDiagnostics"]
        if found["severity"] == "error"
    ]


def test_what_pages_and_examples_show_passes_in_strict_mode(tmp_path: Path) -> None:
    for page in WITH_PYTHON:
        # A block that is not run may be a part of a file, or a file of its own.
        shown = [block for block in blocks(page, "python") if "not run" not in block.notes]
        if not shown:
            continue
        lines: list[str] = []
        for block in shown:
            lines += [f"# {block}", *block.lines]
        name = "_".join(page.relative_to(ROOT).with_suffix("").parts).replace("-", "_")
        (tmp_path / f"{name}.py").write_text("\n".join(lines) + "\n")
    for script in EXAMPLES:
        (tmp_path / f"example_{script.name}").write_text(script.read_text())
    assert checked(tmp_path) == []


def test_an_error_is_found(tmp_path: Path) -> None:
    (tmp_path / "user.py").write_text(
        "import cartwheel as cw\nworld = cw.World('empty')\nworld.run('a second')\nworld.fly()\n"
    )
    assert {line.split(":")[1] for line in checked(tmp_path)} == {"3", "4"}
