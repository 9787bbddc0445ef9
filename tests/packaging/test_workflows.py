"""The workflows call what exists, on the Python versions that the package states."""

import re
import tomllib
from pathlib import Path

import pytest
import yaml

ROOT = Path(__file__).parents[2]
WORKFLOWS = sorted((ROOT / ".github" / "workflows").glob("*.yml"))


def commands(path):
    workflow = yaml.safe_load(path.read_text())
    return [
        step["run"] for job in workflow["jobs"].values() for step in job["steps"] if "run" in step
    ]


@pytest.mark.parametrize("path", WORKFLOWS, ids=lambda path: path.name)
def test_targets_and_files_exist(path):
    targets = re.findall(r"^(\w+):", (ROOT / "Makefile").read_text(), re.MULTILINE)
    for command in commands(path):
        for target in re.findall(r"^make (\w+)", command, re.MULTILINE):
            assert target in targets, command
        for name in re.findall(r"(?:--ignore |^)(tests/\w+|\.ci/run)", command, re.MULTILINE):
            assert (ROOT / name).exists(), command


def test_everything_that_ci_runs_is_a_workflow():
    assert ".ci/run" in commands(ROOT / ".github" / "workflows" / "ci.yml")


def test_each_stated_python_is_tested():
    project = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]
    stated = [c.rpartition(" ")[2] for c in project["classifiers"] if ":: Python :: 3." in c]
    workflow = yaml.safe_load((ROOT / ".github" / "workflows" / "ci.yml").read_text())
    assert workflow["jobs"]["python"]["strategy"]["matrix"]["python"] == stated


@pytest.mark.parametrize(
    "path", sorted((ROOT / ".github" / "ISSUE_TEMPLATE").glob("[!c]*.yml")), ids=lambda p: p.name
)
def test_forms_have_fields_with_labels(path):
    form = yaml.safe_load(path.read_text())
    assert form["name"] and form["description"]
    names = [field["id"] for field in form["body"]]
    assert len(names) == len(set(names))
    assert all(field["attributes"]["label"] for field in form["body"])
