"""Reports of checks for other programs."""

from __future__ import annotations

import json
from pathlib import Path
from xml.etree import ElementTree

import jsonschema
import pytest
from tests.cli.test_check import ERROR, GOOD, NOTE, WARNING

from cartwheel.codes.command import OUTPUT_NOT_WRITTEN

SARIF = {
    # What code scanning needs of SARIF 2.1.0; the names and types are the standard's.
    "type": "object",
    "required": ["version", "runs", "$schema"],
    "properties": {
        "version": {"const": "2.1.0"},
        "runs": {
            "type": "array",
            "minItems": 1,
            "items": {
                "type": "object",
                "required": ["tool", "results"],
                "additionalProperties": False,
                "properties": {
                    "columnKind": {"enum": ["utf16CodeUnits", "unicodeCodePoints"]},
                    "invocations": {
                        "items": {
                            "required": ["executionSuccessful"],
                            "properties": {"executionSuccessful": {"type": "boolean"}},
                        }
                    },
                    "tool": {
                        "required": ["driver"],
                        "properties": {
                            "driver": {
                                "required": ["name"],
                                "properties": {
                                    "name": {"type": "string"},
                                    "version": {"type": "string"},
                                    "rules": {"items": {"required": ["id"]}, "uniqueItems": True},
                                },
                            }
                        },
                    },
                    "results": {
                        "items": {
                            "required": ["message", "ruleId", "ruleIndex", "level", "locations"],
                            "additionalProperties": False,
                            "properties": {
                                "ruleId": {"pattern": "^CW[0-9]{3}$"},
                                "ruleIndex": {"type": "integer", "minimum": 0},
                                "level": {"enum": ["none", "note", "warning", "error"]},
                                "message": {"required": ["text"]},
                                "locations": {
                                    "items": {
                                        "required": ["physicalLocation"],
                                        "properties": {
                                            "physicalLocation": {
                                                "required": ["artifactLocation"],
                                                "properties": {
                                                    "artifactLocation": {"required": ["uri"]},
                                                    "region": {
                                                        "required": ["startLine"],
                                                        "properties": {
                                                            "startLine": {"minimum": 1},
                                                            "startColumn": {"minimum": 1},
                                                        },
                                                    },
                                                },
                                            }
                                        },
                                    }
                                },
                            },
                        }
                    },
                },
            },
        },
    },
}


@pytest.fixture
def checked(program):
    def run(text, *options, status, name="bar.urdf"):
        (Path(program.folder) / name).write_text(text)
        return program("check", name, *options, status=status)

    return run


@pytest.mark.parametrize(("text", "status"), [(ERROR, 1), (NOTE, 0), (GOOD, 0), ("<robot", 2)])
def test_sarif_has_what_the_standard_requires(checked, text, status):
    done = checked(text, "--format", "sarif", status=status)
    log = json.loads(done.stdout)
    jsonschema.validate(log, SARIF)
    (run,) = log["runs"]
    rules = run["tool"]["driver"]["rules"]
    for result in run["results"]:
        assert rules[result["ruleIndex"]]["id"] == result["ruleId"]
        (place,) = result["locations"]
        assert place["physicalLocation"]["artifactLocation"]["uri"] == "bar.urdf"
    assert len(run["results"]) == (text != GOOD)


def test_annotations_of_github_are_one_line_each(checked):
    lines = checked(ERROR, "--format", "github", status=1).stdout.splitlines()
    (line,) = lines
    assert line.startswith("::error file=bar.urdf,title=CW220 inertia-impossible,line=6::")


def test_a_name_of_a_stranger_makes_no_command_of_github(checked):
    text = NOTE.replace("colour=", "a=").replace('"blue"', '"x&#10;::error::y"')
    text = text.replace('name="bar"', 'name="&#10;::stop-commands::x"')
    done = checked(text, "--format", "github", "--strict", status=None)
    assert all(
        line.startswith(("::notice file=", "::warning file=", "::error file="))
        for line in done.stdout.splitlines()
    )


def test_junit_has_a_case_for_each_description(checked, program):
    done = checked(WARNING, "--format", "junit", status=1)
    suite = ElementTree.fromstring(done.stdout).find("testsuite")
    assert (suite.get("tests"), suite.get("failures")) == ("1", "1")
    failure = suite.find("testcase/failure")
    assert "[CW221" in failure.text
    suite = ElementTree.fromstring(checked(GOOD, "--format", "junit", status=0).stdout).find(
        "testsuite"
    )
    assert (suite.get("failures"), suite.find("testcase/failure")) == ("0", None)


def test_a_baseline_is_written_and_used(checked, program):
    checked(ERROR, "--write-baseline", "accepted.json", status=0)
    out = checked(ERROR, "--baseline", "accepted.json", status=0).stdout
    assert "1 in the baseline" in out
    checked(ERROR.replace('"bar"', '"foo"'), "--baseline", "accepted.json", status=1)


def test_a_folder_is_checked_as_a_whole(program):
    folder = Path(program.folder) / "robots"
    folder.mkdir(exist_ok=True)
    (folder / "one.urdf").write_text(ERROR)
    (folder / "two.urdf").write_text(NOTE)
    report = json.loads(program("check", "robots", "--format", "json", status=1).stdout)
    assert [each["file"] for each in report["descriptions"]] == [
        "robots/one.urdf",
        "robots/two.urdf",
    ]
    assert report["summary"]["error"] == 1 and report["summary"]["info"] == 1


def test_selections_are_read(checked):
    checked(ERROR, "--select", "CW4", status=0)
    checked(ERROR, "--select", "CW2,CW4", status=1)
    checked(ERROR, "--ignore", "CW2", status=0)


def test_a_diff_changes_nothing_and_a_fix_does(checked, program):
    text = GOOD.replace("<geometry>", '<origin rpy="0 0 90"/><geometry>')
    path = Path(program.folder) / "bar.urdf"
    shown = checked(text, "--diff", status=1).stdout
    assert '+      <origin rpy="0 0 1.5708"/>' in shown and path.read_text() == text
    checked(text, "--fix", status=0)
    assert path.read_text() == text.replace("0 0 90", "0 0 1.5708")


@pytest.mark.parametrize("form", ["json", "sarif"])
def test_json_is_valid_whatever_a_name_holds(checked, form):
    text = ERROR.replace('name="bar"', 'name="&#127;&#133;\N{SNOWMAN}"')
    done = checked(text, "--format", form, "--strict", status=None)
    assert json.loads(done.stdout)


@pytest.mark.wording
def test_a_name_of_a_stranger_makes_no_command_in_plain_text_either(checked):
    text = ERROR.replace('name="bar"', 'name="x&#10;  ::stop-commands::x"')
    done = checked(text, status=1)
    assert "stop-commands" in done.stdout
    assert not any(line.strip().startswith("::") for line in done.stdout.splitlines())


def test_of_a_file_on_one_line_the_place_is_shown(checked):
    filler = "<!-- " + "x" * 100_000 + " -->"
    text = filler + ERROR.replace('<?xml version="1.0"?>', "").replace("\n", "") + filler
    done = checked(text, status=1)
    assert len(done.stdout) < 3000
    source, caret = done.stdout.splitlines()[1:3]
    start = caret.index("^")
    assert source[start:].startswith("<robot") and len(source) < 300


def test_a_baseline_that_cannot_be_written_is_an_error_of_the_user(checked):
    done = checked(ERROR, "--write-baseline", "nowhere/base.json", status=2)
    assert f"[{OUTPUT_NOT_WRITTEN}]" in done.stderr
