"""The plugin of the page about plugins, installed as a package of its own."""

import os
import re
import shutil
import subprocess
import sys

from .pages import DOCS, ROOT, blocks
from .test_snippets import is_excerpt

EXAMPLE = ROOT / "examples" / "plugin"


def test_the_template_is_installed_and_passes_its_own_test(tmp_path):
    source, installed = tmp_path / "source", tmp_path / "installed"
    shutil.copytree(EXAMPLE, source)
    pip = [sys.executable, "-m", "pip", "install", "-q", "--no-deps", "--no-build-isolation"]
    subprocess.run([*pip, "--target", installed, source], check=True, timeout=300)
    (source / "tilt_alarm.py").unlink()
    path = os.pathsep.join((str(installed), os.environ.get("PYTHONPATH", "")))
    done = subprocess.run(
        [sys.executable, "-m", "pytest", "-q", "-p", "no:cacheprovider", source],
        cwd=source,
        env={**os.environ, "PYTHONPATH": path},
        capture_output=True,
        text=True,
        timeout=300,
        check=False,
    )
    assert done.returncode == 0, done.stdout + done.stderr
    assert "1 passed" in done.stdout


def test_how_to_pages_quote_their_files():
    for page in sorted((DOCS / "how-to").glob("*.md")):
        text = page.read_text()
        folders = [page.parent / name for name in re.findall(r"\]\((files/\w+)/", text)]
        if "examples/plugin/" in text:
            folders.append(EXAMPLE)
        files = [each for folder in folders for each in folder.rglob("*.*")]
        for block in blocks(page, "python", "xml", "toml"):
            reason = block.notes.get("not run", "an excerpt of a file")
            if reason.startswith("an excerpt of ") and files:
                assert is_excerpt(block, files), f"{block} is in none of {folders}"
