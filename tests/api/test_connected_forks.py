"""A process that is forked while its world has connections."""

import contextlib
import os
import select
import signal
import subprocess
import sys
from collections import Counter

import pytest

from cartwheel.bridges.recording.opening import open_recording

_WORLD = """
import faulthandler, os, sys
import cartwheel as cw

world = cw.World("empty", foxglove=0, viewer=0, record=sys.argv[1])
world.run(0.5)

def refused(function):
    try:
        function()
    except cw.CartwheelError as error:
        return error.code.name
    return None

def ended(child):
    return os.waitstatus_to_exitcode(os.waitpid(child, 0)[1])
"""
_CHILD = """
child = os.fork()
if not child:
    faulthandler.dump_traceback_later(40, exit=True)
    for function in (
        world.reset,
        lambda: world.run(0.5),
        lambda: world.spin(0.5),
        lambda: world.spawn("rosbots.xacro"),
        lambda: world.model("ground_plane"),
        lambda: world.publish("/clock"),
        world.show,
    ):
        assert refused(function) == "world-forked"
    assert world.time == 0.5
    world.close()
    with cw.World("empty") as own:
        own.run(0.1)
    sys.exit(7)
assert ended(child) == 7
world.run(0.5)
world.close()
assert world.time == 1.0
"""
_PAGE = """
import socket, urllib.request
from websockets.sync.client import connect
import viser

url = world.show()
def page_works():
    with urllib.request.urlopen(url, timeout=60) as answer:
        return answer.status == 200
def addresses():
    for name in os.listdir("/dev/fd"):
        try:
            with socket.socket(fileno=os.dup(int(name))) as each:
                yield each.getsockname()
        except OSError:
            pass
def ours():
    return [each for each in addresses() if each and each[0].startswith("127.")]

protocol = f"viser-v{viser.__version__}"
with connect(url.replace("http", "ws"), subprotocols=[protocol], max_size=None) as browser:
    browser.recv(60)
    # The gate, the server behind it, and both ends of two connections.
    assert len(ours()) >= 6, ours()
    child = os.fork()
    if not child:
        faulthandler.dump_traceback_later(40, exit=True)
        own = browser.socket.detach()
        os.close(own)
        assert ours() == [], ours()
        with cw.World("empty", viewer=0) as other:
            url = other.show()
            assert page_works()
            other.run(0.1)
        sys.exit(7)
    assert ended(child) == 7
    assert page_works()
    assert browser.ping().wait(60)
world.run(0.5)
world.close()
assert world.time == 1.0
"""
_IN_CALLBACK = """
parent = os.getpid()
children = []
def fork(clock):
    if not children:
        children.append(os.fork())
world.subscribe("/clock", fork)
world.run(0.5)
if os.getpid() != parent:
    assert world.time < 1.0, world.time
    world.close()
    os._exit(7)
assert ended(children[0]) == 7
world.close()
assert world.time == 1.0
"""
_ORPHAN = """
import signal
bridges = open(f"/proc/self/task/{os.getpid()}/children").read().split()
child = os.fork()
if not child:
    signal.pause()
print(child, *bridges, flush=True)
sys.stdin.read(1)
os.kill(os.getpid(), 9)
"""


def _started(script, file):
    return subprocess.Popen(
        [sys.executable, "-c", script, str(file)],
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
    )


@pytest.mark.parametrize(
    "script", [_CHILD, _IN_CALLBACK, _PAGE], ids=["between runs", "in a callback", "web interface"]
)
def test_a_fork_leaves_the_connections_to_the_parent(script, tmp_path):
    with _started(_WORLD + script, tmp_path / "drive.mcap") as parent:
        _, errors = parent.communicate(timeout=100)
    assert (parent.returncode, errors) == (0, "")
    recording = open_recording(tmp_path / "drive.mcap")
    assert recording.complete
    topics = Counter(recording.topics[each.number].name for each in recording.messages())
    recording.close()
    # 100 Hz: nothing is missing, and the child has added nothing.
    assert topics["/clock"] == 101


def test_bridges_end_with_the_parent_although_a_child_lives(tmp_path):
    with (
        _started(_WORLD + _ORPHAN, tmp_path / "drive.mcap") as parent,
        contextlib.ExitStack() as stack,
    ):
        child, *bridges = map(int, parent.stdout.readline().split())
        handles = [os.pidfd_open(each) for each in (child, *bridges)]
        for handle in handles:
            stack.callback(os.close, handle)
        # The parent kills itself after the next line.
        parent.stdin.write("x")
        parent.stdin.flush()
        assert parent.wait(60) == -signal.SIGKILL
        try:
            assert len(bridges) == 2
            for handle in handles[1:]:
                assert select.select([handle], [], [], 20)[0]
            assert not select.select([handles[0]], [], [], 0)[0]
        finally:
            signal.pidfd_send_signal(handles[0], signal.SIGKILL)
