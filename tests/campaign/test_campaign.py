"""The campaign finds faults that were planted, and saves what shows them."""

from __future__ import annotations

import contextlib
import json
import os
import signal
import subprocess
import sys
import time
from pathlib import Path
from random import Random
from types import SimpleNamespace

import pytest
from tests import launching
from tests.campaign import harness, mutating, registry, watching
from tests.campaign.finding import Finding
from tests.campaign.harness import Campaign, Counts, replay
from tests.campaign.watching import ROOT
from tests.campaign.worker import COUNTERS

KINDS = {
    "exception": "exception",
    "time": "time",
    "memory": "memory",
    "death": "death",
    "traceback": "traceback",
    "exit": "exception",
}


@pytest.mark.parametrize("fault", KINDS)
def test_a_planted_fault_is_found_and_fails_again(tmp_path, fault):
    campaign = Campaign(tmp_path, [registry.load(f"planted-{fault}")])
    campaign.run(0.01)
    (file,) = campaign.findings()
    finding = Finding.load(file)
    assert finding.kind == KINDS[fault]
    assert finding.inputs[-1] not in (b"good", b"also good")
    assert campaign.counts[f"planted-{fault}"].faulty > 0
    assert replay(file)


def test_refused_inputs_are_no_findings_and_counts_go_on(tmp_path):
    target = registry.load("planted-none")
    first = Campaign(tmp_path, [target])
    first.run(0.01)
    first.save()
    assert first.findings() == []
    counted = first.counts[target.name]
    assert counted.inputs == counted.accepted + counted.refused > 2
    second = Campaign(tmp_path, [target])
    second.run(0.01)
    assert second.counts[target.name].inputs > counted.inputs
    assert json.loads((tmp_path / "counts.json").read_text())["findings"] == []


def test_starting_workers_is_part_of_the_time(tmp_path, monkeypatch):
    now, slices = 0.0, []

    def read(campaign, target, seconds):
        nonlocal now
        now += 1.2 + seconds
        slices.append(seconds)
        campaign.counts[target.name] = Counts()

    monkeypatch.setattr(harness, "time", SimpleNamespace(monotonic=lambda: now))
    monkeypatch.setattr(Campaign, "_slice", read)
    Campaign(tmp_path, [registry.load("planted-none")] * 30).run(1.0)
    assert len(slices) == 30
    assert min(slices) > 0.5
    assert now == pytest.approx(60.0, abs=1.0)


def test_a_mended_finding_is_forgotten(tmp_path):
    campaign = Campaign(tmp_path, [registry.load("planted-none")])
    finding = Finding(
        target="planted-none", kind="exception", where="x", text="x", inputs=(b"good",)
    )
    finding.save(tmp_path / "findings")
    campaign.forget_mended()
    assert campaign.findings() == []


@pytest.mark.parametrize("mutate", [mutating.binary, mutating.text, mutating.xml])
def test_mutations_follow_from_the_seed(mutate):
    data = b'<robot name="r"><link name="a"><mass value="1.5"/></link></robot>'
    made = [[mutate(data, [data], Random(f"{i}")) for i in range(200)] for _ in range(2)]
    assert made[0] == made[1]
    assert len(set(made[0])) > 100


IN_A_RUN = ("live", "kills", "worlds-in-use")


def _accepted(folder, *names, mutations=0):
    """For each target the number of seeds, of inputs that it accepted, and of those tried."""
    run = launching.run(
        [sys.executable, "-m", "tests.campaign.accepting", str(folder), str(mutations), *names],
        cwd=ROOT,
        stdout=subprocess.PIPE,
        text=True,
        timeout=300,
        check=True,
    )
    return json.loads(run.stdout.splitlines()[-1])


@pytest.fixture(scope="module")
def accepted(tmp_path_factory):
    names = [name for name in registry.names() if name not in IN_A_RUN]
    return _accepted(tmp_path_factory.mktemp("accepting"), *names)


def test_every_target_has_seeds(accepted):
    assert all(count for count, *_ in accepted.values())
    for name in IN_A_RUN:
        assert registry.load(name).seeds(), name


@pytest.mark.parametrize("name", [name for name in registry.names() if name not in IN_A_RUN])
def test_a_target_accepts_what_is_like_its_seeds(name, accepted):
    """Where nothing is accepted, only what refuses is tried."""
    _, taken, tried = accepted[name]
    assert taken is not None, "the process failed"
    assert taken >= tried / 2


def test_a_good_part_of_mutated_definitions_is_accepted(tmp_path):
    """An input that is refused by what reads the message says nothing of the definition."""
    found = _accepted(tmp_path, "definitions", mutations=100)
    assert found["definitions"][1] > 15


def test_a_stopped_campaign_goes_on_where_it_was(tmp_path):
    """By Ctrl-C, by SIGTERM, and by a kill; no worker is left, and what was read is counted."""
    counted = 0
    for number in (signal.SIGINT, signal.SIGKILL, signal.SIGTERM):
        campaign = subprocess.Popen(
            [
                *(sys.executable, "-m", "tests.campaign", "--minutes", "60", "--resume"),
                *("--targets", "zenoh", "--folder", str(tmp_path)),
            ],
            cwd=ROOT,
            env={**os.environ, "PYTHONPATH": os.pathsep.join((str(ROOT), str(ROOT / "src")))},
            stdout=subprocess.PIPE,
            text=True,
        )
        try:
            wait_for(lambda: read_by(tmp_path) > 20, "inputs")
            workers = workers_of(tmp_path)
            assert workers
            campaign.send_signal(number)
            said, _ = campaign.communicate(timeout=60)
        finally:
            campaign.kill()
        wait_for(lambda: not workers_of(tmp_path), "the end of the worker")
        if number != signal.SIGKILL:
            assert "stopped; --resume goes on" in said
            assert campaign.returncode == 0
            state = json.loads((tmp_path / "counts.json").read_text())
            assert state["inputs"] > counted + 20
            counted = state["inputs"]
        (tmp_path / "zenoh" / "counters").unlink()


def read_by(folder):
    """Inputs that the worker at hand has begun to read."""
    file = folder / "zenoh" / "counters"
    return COUNTERS.unpack(file.read_bytes())[1] if file.exists() and file.stat().st_size else 0


def workers_of(folder):
    """Processes of workers whose room is in a folder."""
    found = []
    for process in Path("/proc").glob("[0-9]*"):
        with contextlib.suppress(OSError):
            words = (process / "cmdline").read_text()
            state = (process / "stat").read_text().rpartition(")")[2].split()[0]
            if "tests.campaign.worker" in words and str(folder) in words and state != "Z":
                found.append(int(process.name))
    return found


def wait_for(condition, what):
    deadline = time.monotonic() + 60
    while not condition():
        assert time.monotonic() < deadline, f"no {what} within 60 s"
        time.sleep(0.02)


def test_folders_of_workers_that_have_ended_are_removed(tmp_path, monkeypatch):
    monkeypatch.setattr(watching, "_SOCKETS", tmp_path)
    ended = subprocess.Popen([sys.executable, "-c", ""])
    ended.wait()
    left, used = tmp_path / f"cw{ended.pid}-a", tmp_path / f"cw{os.getpid()}-b"
    for folder in (left, used, tmp_path / "cw_other"):
        folder.mkdir()
    watching.sweep()
    assert sorted(tmp_path.iterdir()) == [used, tmp_path / "cw_other"]
