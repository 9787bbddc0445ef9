"""A world with clients: its folder of sockets, and what must not be left behind."""

import os
import threading
from collections.abc import Callable, Iterator
from pathlib import Path
from types import SimpleNamespace

import pytest
from tests.bridges.ros1_peers import wait_for
from tests.processes import bridges_of


def bridges() -> list[int]:
    """The bridge processes of this process."""
    return bridges_of(SimpleNamespace(pid=os.getpid()))


@pytest.fixture
def isolated(monkeypatch: pytest.MonkeyPatch, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder of sockets in which only this test's simulations are."""
    folder = tmp_path_factory.mktemp("run")
    monkeypatch.setenv("XDG_RUNTIME_DIR", str(folder))
    monkeypatch.delenv("CARTWHEEL_SIM", raising=False)
    return folder


@pytest.fixture
def tidy(isolated: Path) -> Iterator[None]:
    """Fails if a test leaves a process, a socket or a thread."""
    before = set(threading.enumerate())
    yield
    wait_for(lambda: not bridges(), "the end of the bridges")
    wait_for(lambda: set(threading.enumerate()) <= before, "the end of the threads")
    assert list(isolated.rglob("*.json")) == []


@pytest.fixture
def on_thread() -> Iterator[Callable[[Callable[[], object]], threading.Thread]]:
    """Starts functions on threads, which must have ended after the test."""
    started: list[threading.Thread] = []

    def start(function: Callable[[], object]) -> threading.Thread:
        thread = threading.Thread(target=function, daemon=True)
        thread.start()
        started.append(thread)
        return thread

    yield start
    for thread in started:
        thread.join(60)
        assert not thread.is_alive()
