"""How clients find the simulations that run."""

import json
import os
import socket
import stat

from tests.coded import raises

from cartwheel.codes.command import (
    CONTROL_FOLDER_UNUSABLE,
    OPTION_INVALID,
    SIMULATION_AMBIGUOUS,
    SIMULATION_NOT_RUNNING,
)
from cartwheel.control import ControlClient, find, registry, running
from cartwheel.control.server import ControlServer

from .conftest import load


def test_none(runtime_folder):
    assert running() == []
    with raises(SIMULATION_NOT_RUNNING):
        find()
    assert stat.S_IMODE(runtime_folder.stat().st_mode) == 0o700


def test_one_is_found_by_itself(server):
    assert find() == find(os.getpid()) == server.entry
    server.announce(url="http://127.0.0.1:8080", port=8080)
    assert find().url == "http://127.0.0.1:8080"
    assert find().title == "nothing in test_world"
    with raises(SIMULATION_NOT_RUNNING, pid=1):
        find(1)


def test_of_several_one_must_be_named(server, session, monkeypatch):
    second = ControlServer(session, title="second", load=load)
    entry = json.loads(second.entry.path.with_suffix(".json").read_text())
    second.entry.path.with_suffix(".json").write_text(json.dumps({**entry, "pid": 17}))
    with raises(SIMULATION_AMBIGUOUS, pids=(17, os.getpid())) as caught:
        find()
    assert caught.value.hint
    assert find(17).title == "second"
    monkeypatch.setenv("CARTWHEEL_SIM", "17")
    assert find().title == "second"
    monkeypatch.setenv("CARTWHEEL_SIM", "x")
    with raises(OPTION_INVALID, option="CARTWHEEL_SIM", value="x"):
        find()
    second.close()


def test_what_dead_processes_left_is_removed(server, runtime_folder):
    for name, text in (("1", "{}"), ("2", "garbage"), ("3", json.dumps({"pid": 3}))):
        (runtime_folder / f"{name}.json").write_text(text)
    values = {"pid": 4, "title": "dead", "world": "w", "started": 0.0}
    (runtime_folder / "4.json").write_text(json.dumps(values))
    dead = socket.socket(socket.AF_UNIX)
    dead.bind(str(runtime_folder / "4.sock"))
    dead.close()
    assert [entry.pid for entry in running()] == [os.getpid()]
    assert {path.stem for path in runtime_folder.iterdir()} == {str(os.getpid())}


def test_a_dead_socket_of_the_same_number_is_replaced(session, runtime_folder):
    registry.folder()
    dead = socket.socket(socket.AF_UNIX)
    dead.bind(str(runtime_folder / f"{os.getpid()}.sock"))
    dead.close()
    server = ControlServer(session, title="t", load=load)
    assert server.entry.path.stem == str(os.getpid())
    server.close()


def test_nothing_is_left_after_the_end(server, runtime_folder):
    with ControlClient() as client:
        client.request("status")
    server.close()
    server.close()
    assert list(runtime_folder.iterdir()) == []


def test_a_folder_that_is_a_link_is_refused(tmp_path, runtime_folder):
    (tmp_path / "elsewhere").mkdir()
    runtime_folder.symlink_to(tmp_path / "elsewhere")
    with raises(CONTROL_FOLDER_UNUSABLE):
        running()


def test_an_open_folder_is_closed_to_others(runtime_folder):
    runtime_folder.mkdir(mode=0o755)
    running()
    assert stat.S_IMODE(runtime_folder.stat().st_mode) == 0o700
