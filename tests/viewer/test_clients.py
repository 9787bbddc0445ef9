"""Clients of the page that are no browsers: slow ones, and what is done for none."""

import contextlib
import threading

import msgspec
import pytest
import viser
from websockets.sync.client import connect

from cartwheel.viewer.panels.drive import DrivePanel

from .conftest import TWIST, eventually

IMAGE = "/rosbots/camera1/image_raw"
STAGE = (0.75, 0.0, 0.4)
"""Where an empty world is looked at."""


@contextlib.contextmanager
def client(arena):
    """A connection that reads nothing: its buffers fill, and then the server's."""
    with connect(
        arena.url.replace("http", "ws"),
        subprotocols=[f"viser-v{viser.__version__}"],
        max_queue=1,
        max_size=None,
        close_timeout=0.1,
    ) as connection:
        # A browser counts from the moment it says how large its canvas is.
        camera = {
            "type": "ViewerCameraMessage",
            "wxyz": (1.0, 0.0, 0.0, 0.0),
            "position": (-2.0, 0.0, 1.0),
            "fov": 0.8,
            "near": 0.01,
            "far": 1000.0,
            "image_height": 600,
            "image_width": 800,
            "look_at": (0.0, 0.0, 0.0),
            "up_direction": (0.0, 0.0, 1.0),
        }
        connection.send(msgspec.msgpack.encode(camera))
        yield connection


@pytest.fixture
def fresh(arena):
    arena.start_over()
    return arena


def messages_sent(arena):
    return arena.viewer._page.server._websock_server._broadcast_buffer.message_counter


def wait(arena, seconds):
    """Lets simulated time pass."""
    until = arena.ask(lambda: arena.simulation.time_ns) + int(seconds * 1e9)
    eventually(lambda: arena.simulation.time_ns >= until, what="time")


def test_nobody_looks_nothing_is_read_or_sent(fresh):
    eventually(lambda: not fresh.viewer._page.clients, what="an empty house")
    # Only the view is aimed, once: at the cart, whether it still falls by then or has landed.
    camera = fresh.viewer._page.server.initial_camera
    eventually(lambda: tuple(camera.look_at) != STAGE, what="the first view")
    aimed = threading.Event()
    fresh.viewer._page.post(aimed.set)
    assert aimed.wait(120.0)
    before = messages_sent(fresh)
    wait(fresh, 0.5)
    assert messages_sent(fresh) == before
    for topic in fresh.graph.topics():
        assert "viewer" not in topic.subscribers, topic.name


def test_sensors_are_read_while_somebody_looks(fresh):
    with client(fresh):
        for topic in (IMAGE, "/imu/data", "/bumpers"):
            eventually(lambda t=topic: "viewer" in fresh.readers(t), what=topic)
    for topic in (IMAGE, "/imu/data", "/bumpers"):
        eventually(lambda t=topic: "viewer" not in fresh.readers(t), what=f"the end of {topic}")


def test_a_client_that_does_not_read_stalls_nobody(fresh):
    with client(fresh):
        eventually(lambda: fresh.viewer._desk._places, what="the client")
        drive = fresh.viewer._desk.panel(DrivePanel)
        fresh.viewer._page.post(lambda: drive.press("j"))
        wait(fresh, 2.0)
        # The page's own thread keeps up, and keeps one state of each thing, not a queue of them.
        assert fresh.viewer._page._jobs.qsize() < 10
        buffer = fresh.viewer._page.server._websock_server._broadcast_buffer
        held = len(buffer.message_from_id)
        wait(fresh, 1.0)
        assert len(buffer.message_from_id) < held + 20
        assert fresh.twists[0] == (0.0, 1.0)
    eventually(lambda: fresh.twists[-1] == (0.0, 0.0), what=f"the stop on {TWIST}")


def test_nothing_is_sent_of_a_world_that_stands_still(fresh):
    with client(fresh):
        eventually(lambda: fresh.viewer._page.clients, what="the client")
        fresh.ask(fresh.simulation.pause)

        def quiet():
            """Two beats, a second apart, in which nothing else is sent."""
            before, beats = messages_sent(fresh), fresh.viewer._page._beats
            eventually(lambda: fresh.viewer._page._beats >= beats + 3, what="the beats")
            return messages_sent(fresh) == before

        # The last figures of a second ago may still be on their way.
        eventually(quiet, what="quiet")
        assert quiet()
