"""Sweeps: the same table for any number of processes, also after an interruption."""

from __future__ import annotations

import json
import signal
import subprocess
import sys
import time
from pathlib import Path

import numpy as np
import pytest
from tests import launching
from tests.coded import raises
from tests.sweeps.duties import counted, drive

import cartwheel as cw
from cartwheel.codes.command import RESULTS_INVALID
from cartwheel.codes.wires import PACKAGE_MISSING
from cartwheel.codes.world import SWEEP_INVALID
from cartwheel.sweeps.results import Results, Row

CASES = [{"speed": speed, "seed": seed} for speed in (0.2, 0.6) for seed in (0, 1, 2)]


def test_the_table_is_the_same_with_any_number_of_processes(built, tmp_path):
    tables = [
        cw.sweep(drive, CASES, built, jobs=jobs, results=tmp_path / f"{jobs}.jsonl").columns()
        for jobs in (0, 1, 2)
    ]
    # Results that are read from a file have the same bits.
    tables.append(cw.sweep(drive, CASES, built, jobs=0, results=tmp_path / "2.jsonl").columns())
    assert all(each == tables[0] for each in tables)
    table = tables[0]
    assert list(table) == ["speed", "seed", "x", "y", "rate", "error"]
    assert table["speed"] == [0.2] * 3 + [0.6] * 3 and table["error"] == [""] * 6
    assert len(set(table["rate"][:3])) == 3 and table["rate"][:3] == table["rate"][3:]
    assert table["x"][0] < table["x"][3]


@pytest.mark.parametrize("how", ["raise", "exit", "sleep"])
def test_a_case_that_fails_is_run_again(built, tmp_path, how):
    log = str(tmp_path / "log")
    cases = [{"n": n, "log": log, "how": how} for n in range(4)]
    # The others must be done in time on a busy machine, too.
    options = {"jobs": 1, "results": tmp_path / "results.jsonl", "timeout": 15.0}
    found = cw.sweep(counted, cases, built, **options)
    (failed,) = found.failed
    assert failed.case["n"] == 2 and failed.values == {}
    expected = {"raise": "no luck", "exit": "status 5", "sleep": "15 s"}[how]
    assert expected in failed.error
    assert found.column("result")[[0, 1, 3]].tolist() == [0.0, 1.0, 3.0]
    assert np.isnan(found.column("result")[2])
    with raises(SWEEP_INVALID, name="reslut"):
        found.column("reslut")
    assert np.isnan(found.failed.column("result")).all()
    Path(log + ".good").touch()
    again = cw.sweep(counted, cases, built, **options)
    assert not again.failed and again.column("result").tolist() == [0.0, 1.0, 2.0, 3.0]
    assert sorted(map(int, Path(log).read_text().split())) == [0, 1, 2, 2, 3]


def test_a_sweep_that_was_killed_continues(tmp_path):
    script = tmp_path / "study.py"
    script.write_text(
        "import sys, cartwheel as cw\n"
        "def far(world, case):\n"
        "    world.publish('/part2_cmr/cmd_vel', linear_x=case['speed'])\n"
        "    world.run(case['seconds'])\n"
        "    return {'x': world.model('rosbots').pose.x}\n"
        "if __name__ == '__main__':\n"
        "    built = cw.build('empty', ['rosbots.xacro'])\n"
        "    cases = [{'speed': i / 100, 'seconds': 2.0} for i in range(40)]\n"
        "    table = cw.sweep(far, cases, built, results='out.jsonl', jobs=int(sys.argv[1]))\n"
        "    import json; print(json.dumps(table.columns()))\n"
    )
    out = tmp_path / "out.jsonl"
    first = subprocess.Popen([sys.executable, script, "2"], cwd=tmp_path, stdout=subprocess.DEVNULL)
    end = time.monotonic() + 120
    while not (out.exists() and len(out.read_text().splitlines()) > 4):
        assert time.monotonic() < end and first.poll() is None
        time.sleep(0.02)
    first.send_signal(signal.SIGKILL)
    first.wait()
    done = len(out.read_text().splitlines()) - 1
    # The line that it wrote when it was killed.
    with out.open("a") as file:
        file.write('{"case": {"spe')
    options = {"cwd": tmp_path, "capture_output": True, "text": True, "check": True}
    second = launching.run([sys.executable, script, "2"], **options)
    rows = [json.loads(line) for line in out.read_text().splitlines()][1:]
    assert done >= 4 and len(rows) == 40
    assert len({json.dumps(row["case"]) for row in rows}) == 40
    table = json.loads(second.stdout)
    assert table["speed"] == [i / 100 for i in range(40)]
    assert table["x"] == sorted(table["x"]) and table["error"] == [""] * 40
    out.unlink()
    whole = launching.run([sys.executable, script, "0"], **options)
    assert whole.stdout == second.stdout


@pytest.mark.parametrize(
    "cases", [[1], [{"seed": -1}], [{"seed": "a"}], [{"f": print}], [{"seed": 1.0}]]
)
def test_invalid_cases_are_errors(built, cases):
    with raises(SWEEP_INVALID):
        cw.sweep(drive, cases, built, jobs=0)


def no_number(world, case):
    return {"world": world}


def test_an_invalid_result_is_the_error_of_its_case(built):
    found = cw.sweep(no_number, [{}, {}], built, jobs=0)
    assert len(found.failed) == 2 and SWEEP_INVALID.number in found[0].error


def test_the_file_of_another_sweep_is_refused(built, tmp_path):
    file = tmp_path / "results.jsonl"
    cw.sweep(drive, CASES[:1], built, jobs=0, results=file)
    with raises(RESULTS_INVALID):
        cw.sweep(no_number, [{}], built, jobs=0, results=file)
    before = file.read_text()
    file.write_text(before + "nonsense\n")
    with raises(RESULTS_INVALID):
        cw.sweep(drive, CASES[:1], built, jobs=0, results=file)
    assert file.read_text() == before + "nonsense\n"


def test_equal_cases_have_results_of_their_own(built, tmp_path):
    log = str(tmp_path / "log")
    cases = [{"n": 1, "log": log, "how": ""}] * 3
    file = tmp_path / "results.jsonl"
    assert len(cw.sweep(counted, cases, built, jobs=0, results=file)) == 3
    cw.sweep(counted, [*cases, *cases], built, jobs=0, results=file)
    assert Path(log).read_text() == "1\n" * 6


def test_tables_of_other_libraries(built):
    found = cw.sweep(drive, CASES[:2], built, jobs=0)
    columns = found.columns()
    frame, table = found.to_pandas(), found.to_arrow()
    assert list(frame.columns) == table.column_names == list(columns)
    for name, values in columns.items():
        assert list(frame[name]) == table[name].to_pylist() == values


def test_tables_that_cannot_be_made(monkeypatch):
    rows = [Row(case={"n": n}, values={"x": x}) for n, x in enumerate((1.5, "far"))]
    with raises(SWEEP_INVALID):
        Results(rows).to_arrow()
    for name, method in (("pandas", Results.to_pandas), ("pyarrow", Results.to_arrow)):
        monkeypatch.setitem(sys.modules, name, None)
        with raises(PACKAGE_MISSING, package=name):
            method(Results(rows))
