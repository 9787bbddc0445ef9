"""The repository contains only its own files."""

import shutil
import subprocess
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]


def test_no_link_leads_out_of_the_repository():
    """Such a link, added by mistake, replaces the folder of that name in other clones."""
    if shutil.which("git") is None or not (ROOT / ".git").exists():
        pytest.skip("no git repository")
    done = subprocess.run(
        ["git", "ls-files", "-z"], cwd=ROOT, capture_output=True, text=True, check=True
    )
    files = [ROOT / name for name in done.stdout.split("\0") if name]
    assert len(files) > 1000
    links = [file for file in files if file.is_symlink()]
    outside = [file for file in links if not file.resolve().is_relative_to(ROOT)]
    absolute = [file for file in links if file.readlink().is_absolute()]
    assert not outside + absolute, "remove them with git rm --cached"
