"""How clients find the simulations that run."""

import json
import os
import socket
import stat

from tests.coded import raises

from cartwheel.codes.command import (
    CONTROL_FOLDER_UNUSABLE,
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
    assert find() == find(str(os.getpid())) == find("test_world") == server.entry
    assert server.entry.selector == str(os.getpid())
    server.announce(url="http://127.0.0.1:8080", port=8080)
    assert find().url == "http://127.0.0.1:8080"
    assert find().title == "nothing in test_world"
    for selector in ("1", f"{os.getpid()}-2", "test", "-"):
        with raises(SIMULATION_NOT_RUNNING, sim=selector):
            find(selector)


def test_of_several_one_must_be_named(server, session, monkeypatch):
    second = ControlServer(session, title="second", load=load)
    entry = json.loads(second.entry.path.with_suffix(".json").read_text())
    second.entry.path.with_suffix(".json").write_text(json.dumps({**entry, "pid": 17}))
    with raises(SIMULATION_AMBIGUOUS, sims=tuple(sorted(("17", str(os.getpid()))))) as caught:
        find()
    assert caught.value.hint
    assert find("17").title == "second"
    monkeypatch.setenv("CARTWHEEL_SIM", "17")
    assert find().title == "second"
    monkeypatch.setenv("CARTWHEEL_SIM", "x")
    with raises(SIMULATION_NOT_RUNNING, sim="x"):
        find()
    second.close()


def test_several_simulations_of_one_process(server, session, monkeypatch):
    second = ControlServer(session, title="second", load=load, world="yard")
    third = ControlServer(session, title="third", load=load, world="17")
    fourth = ControlServer(session, title="fourth", load=load, world="17")
    pid = str(os.getpid())
    numbers = tuple(f"{pid}-{count}" for count in (1, 2, 3, 4))
    for selector, fitting in ((None, numbers), (pid, numbers), ("17", numbers[2:])):
        with raises(SIMULATION_AMBIGUOUS, sims=fitting):
            find(selector)
    for number, selected in zip(numbers, (server, second, third, fourth), strict=True):
        assert find(number).path == selected.entry.path
        assert find(number).selector == number
        assert str(find(number)).startswith(f"{number}: {selected.entry.title}")
    assert find("test_world").path == server.entry.path
    monkeypatch.setenv("CARTWHEEL_SIM", "yard")
    assert find().path == second.entry.path
    # A world keeps its number when another one ends.
    third.close()
    assert find("17").path == find(numbers[3]).path == fourth.entry.path
    fourth.close()
    server.close()
    assert find(pid).path == find(numbers[1]).path == second.entry.path
    assert find("yard").selector == pid
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
