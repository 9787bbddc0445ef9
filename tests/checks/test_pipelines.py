"""The GitHub action and the hook for pre-commit run a check that works."""

from __future__ import annotations

import json
import os
import shlex
import subprocess
import sys
from pathlib import Path

import pytest
import yaml

ROOT = Path(__file__).parents[2]
BAD = '<robot name="bar"><link name="a"/><link name="b"/></robot>\n'


@pytest.fixture
def folder(tmp_path):
    (tmp_path / "bar.urdf").write_text(BAD)
    return tmp_path


def run(command, folder, **variables):
    path = f"{Path(sys.executable).parent}{os.pathsep}{os.environ['PATH']}"
    return subprocess.run(
        command,
        cwd=folder,
        env={**os.environ, "PATH": path, **variables},
        capture_output=True,
        text=True,
        check=False,
    )


def test_the_action_writes_its_report(folder):
    action = yaml.safe_load((ROOT / "action.yml").read_text())
    step = action["runs"]["steps"][-1]
    variables = {
        name: action["inputs"][name.removeprefix("CHECK_").lower()]["default"]
        for name in step["env"]
    }
    variables |= {"CHECK_FORMAT": "json", "CHECK_OUTPUT": "$(touch bad).json"}
    variables["CHECK_ARGUMENTS"] = "--strict --select CW2"
    done = run(["bash", "-eo", "pipefail", "-c", step["run"]], folder, **variables)
    assert done.returncode == 1, done.stderr
    assert not (folder / "bad").exists(), "an input is never a command"
    report = json.loads((folder / "$(touch bad).json").read_text())
    assert "CW208" in {finding["code"] for finding in report["findings"]}


def test_the_hook_checks_the_working_directory(folder):
    (hook,) = yaml.safe_load((ROOT / ".pre-commit-hooks.yaml").read_text())
    done = run([*shlex.split(hook["entry"]), *hook["args"]], folder)
    assert done.returncode == 1, done.stderr
    assert "[CW208 multiple-roots]" in done.stdout
    assert hook["pass_filenames"] is False
