"""``cartwheel test``: exit status, reports, and runs that are continued."""

from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
import time
from collections.abc import Callable
from pathlib import Path
from xml.etree import ElementTree

import pytest
from tests import launching

from cartwheel.cli.main import run as run_command
from cartwheel.scenarios import find_scenarios, schema_text

from .conftest import CART, DRIVE

GO = f"steps: [{{publish: {DRIVE}, message: {{linear: {{x: '${{v}}'}}}}}}]\n"
MIXED = (
    f"name: drive\n{CART}{GO}parameters: {{v: [0.1, 0.5]}}\n"
    "expect: [{reaches: cart, x: 0.5, y: 0, timeout: 2}]\n"
)
Command = Callable[..., int]


@pytest.fixture
def command(monkeypatch, tmp_path: Path) -> Command:
    """Runs the command in a folder and returns its status."""
    monkeypatch.chdir(tmp_path)

    def run(*words: str) -> int:
        monkeypatch.setattr(sys, "argv", ["cartwheel", "test", *words])
        return run_command()

    return run


def write(text: str, name: str = "drive.yaml") -> None:
    Path(name).write_text(text)


def results() -> list[dict]:
    return json.loads(Path("cartwheel-results/results.json").read_text())["cases"]


def test_failed_cases_have_reports(command, capsys):
    write(MIXED)
    assert command("drive.yaml", "-j2", "--junit", "out.xml") == 1
    assert [case["status"] for case in results()] == ["failed", "passed"]
    out = capsys.readouterr().out
    assert "drive.yaml:5" in out and "1 passed, 1 failed" in out
    suite = ElementTree.parse("out.xml").getroot()[0]
    assert (suite.get("tests"), suite.get("failures")) == ("2", "1")
    page = Path("cartwheel-results/report.html").read_text()
    assert page.count("<article") == 1 and "data:image/jpeg;base64," in page and "<svg" in page
    assert "http://" not in page and "https://" not in page and 'src="files' not in page
    (recording,) = Path("cartwheel-results/files").glob("*.mcap")
    assert recording.name in page
    monkeyed = ["cartwheel", "info", str(recording)]
    sys.argv = monkeyed
    assert run_command() == 0


def test_random_parameters_are_in_the_report_for_servers(command):
    write(
        f"{CART}parameters: {{v: {{uniform: [0.2, 0.3]}}, w: [1, 2]}}\nseeds: [7]\n"
        "duration: 0.1\nexpect: [{publishes: /clock}]\n"
    )
    assert command("drive.yaml", "--junit", "out.xml") == 0
    cases = ElementTree.parse("out.xml").getroot()[0]
    for case, result in zip(cases, results(), strict=True):
        found = {each.get("name"): each.get("value") for each in case.iter("property")}
        assert found == {
            "v": str(result["parameters"]["v"]),
            "w": str(result["parameters"]["w"]),
            "seed": "7",
        }
    assert {case.find("properties")[1].get("value") for case in cases} == {"1", "2"}


def test_names_from_files_are_escaped_in_the_report(command):
    write("name: <script>alert(1)</script>\nexpect: [{expression: \"'<img>' == ''\"}]\n")
    assert command("drive.yaml") == 1
    page = Path("cartwheel-results/report.html").read_text()
    assert "<script>alert" not in page and "<img>" not in page


def test_all_cases_that_pass_give_status_0(command, capsys):
    write(MIXED)
    assert command("drive.yaml", "-k", "v=0.5", "--json") == 0
    data = json.loads(capsys.readouterr().out)
    assert data["summary"] == {"passed": 1, "failed": 0, "error": 0}


def test_cases_can_be_listed_and_selected(command, capsys):
    write(MIXED)
    assert command("drive.yaml", "--list", "--seeds", "2", "--seed", "4", "-k", "*v=0.5*") == 0
    assert capsys.readouterr().out.split() == ["drive[v=0.5,seed=4]", "drive[v=0.5,seed=5]"]


def test_other_yaml_files_in_a_folder_are_ignored(command, capsys):
    write("controller_manager:\n  ros__parameters: {update_rate: 100}\n", "controllers.yaml")
    write("{{ template }}: [\n", "template.yml")
    write("- a list\n", "list.yaml")
    for folder in (".github", "install"):
        Path(folder).mkdir()
        write(MIXED.replace("0.1", "0.2"), f"{folder}/drive.yaml")
    assert command(".", "--list") == 2
    assert "CW038" in capsys.readouterr().err
    write(MIXED)
    assert command(".", "--list") == 0
    out, err = capsys.readouterr()
    assert len(out.splitlines()) == 2
    assert all(name in err for name in ("controllers.yaml", "template.yml", "list.yaml"))


@pytest.mark.parametrize(
    "text",
    [
        "expect: [{moves: cart}\nrobots: []\n",
        f"{CART}{GO}expects: []\n",
        CART,
        "expect: []\nfoo: 1\n",
    ],
)
def test_a_mistake_in_a_scenario_of_a_folder_is_reported(command, capsys, text):
    write(text)
    assert command(".") == 2
    assert "CW036" in capsys.readouterr().err


def test_the_schema_is_printed(command, capsys):
    assert command("--schema") == 0
    assert json.loads(capsys.readouterr().out) == json.loads(schema_text())


@pytest.mark.parametrize(
    "words",
    [
        (), ("missing.yaml",), ("empty",), ("drive.yaml", "-k", "none"), ("broken.yaml",),
        ("drive.yaml", "--record", "some"), ("drive.yaml", "-j", "0"), ("drive.yaml", "--view"),
    ],
)  # fmt: skip
def test_mistakes_give_status_2(command, words):
    write(MIXED)
    write("expcet: []", "broken.yaml")
    Path("empty").mkdir()
    assert command(*words) == 2


def test_a_program_needs_permission(command):
    write(
        "launch: {command: [touch, started]}\nexpect: [{expression: 'True'}]\n",
    )
    assert command("drive.yaml") == 1
    assert results()[0]["findings"][0]["code"] == "CW039"
    assert not Path("started").exists()
    assert command("drive.yaml", "--allow-launch") == 0


def test_the_output_of_the_program_of_a_failed_case_is_shown(command, capsys):
    write("launch: {command: [seq, '30']}\nduration: 0.1\nexpect: [{expression: 'False'}]\n")
    for _ in range(20):
        assert command("drive.yaml", "--allow-launch") == 1
        shown = capsys.readouterr().out
        if results()[0]["output"].endswith("\n30\n"):  # it may end later than the case
            break
    assert "output of the program:\n    …\n    21\n" in shown and "\n    30\n" in shown


def test_arguments_of_the_program_can_be_parameters(command):
    """Numbers and truth values, also within texts, as ROS writes them."""
    write(
        "parameters: {speed: [0.5], fast: [true]}\n"
        "launch: {command: [printf, '%s|', '${speed}', '${fast}', 'v:=${2 * speed}', 7]}\n"
        "duration: 0.1\nexpect: [{expression: 'False'}]\n"
    )
    for _ in range(20):
        assert command("drive.yaml", "--allow-launch") == 1
        if results()[0]["output"]:  # it may end later than the case
            break
    assert results()[0]["output"].strip() == "0.5|true|v:=1.0|7|"


def test_resume_runs_only_what_has_not_passed(command, capsys):
    write(MIXED)
    command("drive.yaml")
    first = {case["id"]: case["wall"] for case in results()}
    assert command("drive.yaml", "--resume") == 1
    second = {case["id"]: case["wall"] for case in results()}
    assert second["drive[v=0.5]"] == first["drive[v=0.5]"]
    assert second["drive[v=0.1]"] != first["drive[v=0.1]"]
    write(MIXED.replace("timeout: 2", "timeout: 9"))
    assert command("drive.yaml", "--resume") == 0


def test_resume_accepts_an_incomplete_line_and_refuses_others(command):
    write(MIXED)
    command("drive.yaml")
    file = Path("cartwheel-results/results.jsonl")
    whole = file.read_text()
    file.write_text(whole + '{"schema": 1, "id"')
    assert command("drive.yaml", "--resume", "-k", "v=0.5") == 0
    assert all(json.loads(line) for line in file.read_text().splitlines())
    file.write_text("nonsense\n" + whole)
    assert command("drive.yaml", "--resume") == 2


def test_fail_fast_stops_at_the_first_failure(command):
    write(MIXED)
    assert command("drive.yaml", "-x", "-j1") == 1
    assert [case["id"] for case in results()] == ["drive[v=0.1]"]


def test_a_case_that_takes_too_long_is_ended(command):
    write(f"{CART}duration: 100000\nexpect: [{{stays_within: cart, z: [-1, 1]}}]")
    begin = time.monotonic()
    assert command("drive.yaml", "--timeout", "5") == 1
    assert time.monotonic() - begin < 60
    assert results()[0]["status"] == "error"


def test_ctrl_c_keeps_the_results(tmp_path):
    path = tmp_path / "drive.yaml"
    path.write_text(f"{CART}seeds: 1000\nduration: 1\nexpect: [{{stays_within: cart, z: [-1, 1]}}]")
    process = launching.Popen(
        [sys.executable, "-m", "cartwheel", "test", path.name, "-j1"],
        cwd=tmp_path, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL,
        start_new_session=True,
    )  # fmt: skip
    lines = tmp_path / "cartwheel-results" / "results.jsonl"
    deadline = time.monotonic() + 120
    while not (lines.exists() and lines.read_text().count("\n") > 2):
        assert time.monotonic() < deadline and process.poll() is None
        time.sleep(0.05)
    os.killpg(process.pid, signal.SIGINT)
    assert process.wait(60) == 130
    assert (tmp_path / "cartwheel-results" / "report.html").exists()
    while is_there(process.pid):
        assert time.monotonic() < deadline
        time.sleep(0.05)


def is_there(group: int) -> bool:
    try:
        os.killpg(group, 0)
    except ProcessLookupError:
        return False
    return True


def test_a_crashed_process_is_an_error_of_its_case(scenario, tmp_path, monkeypatch):
    from cartwheel.scenarios import Options, Workers, cases_of, digests

    loaded = scenario(f"{CART}seeds: 2\nduration: 0.1\nexpect: [{{moves: cart, distance: 0}}]")
    cases = list(digests(loaded, cases_of(loaded)))
    workers = Workers([loaded], Options(folder=tmp_path), 1, 60.0)
    found = []
    for outcome in workers.run(cases):
        found.append(outcome.status)
        for worker in workers._workers._workers:
            worker.process.kill()
    assert found == ["passed", "error"]


def test_a_long_file_in_a_folder_does_not_take_long(tmp_path):
    (tmp_path / "blank.yaml").write_text("{" + "\n" * 300_000)
    (tmp_path / "wide.yaml").write_text("{\n" + " " * 300_000 + "\nexpect" + " " * 300_000)
    (tmp_path / "broken.yaml").write_text("{\n  'expect' : 1")
    begin = time.process_time()
    scenarios, others = find_scenarios(tmp_path)
    assert time.process_time() - begin < 5.0  # with the square of the length, minutes
    assert [each.name for each in scenarios] == ["broken.yaml"]
    assert [each.name for each in others] == ["blank.yaml", "wide.yaml"]
