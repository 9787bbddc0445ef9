"""Clients of the page that are no browsers: slow ones, and what is done for none."""

import contextlib
import logging
import threading

import msgspec
import pytest
import viser
from websockets.sync.client import connect

from cartwheel.viewer.overlays import Overlays
from cartwheel.viewer.panels.camera import CameraPanel
from cartwheel.viewer.panels.drive import DrivePanel
from cartwheel.viewer.panels.insert import UploadPanel
from cartwheel.viewer.panels.topics import TopicsPanel
from cartwheel.viewer.panels.view import ViewPanel
from cartwheel.viewer.panels.world import WorldPanel
from cartwheel.viewer.seat import Seat

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


@pytest.mark.parametrize(
    ("kind", "method"),
    [
        (Seat, "__init__"),
        *((kind, "__init__") for kind in (DrivePanel, WorldPanel, UploadPanel, CameraPanel)),
        (ViewPanel, "__init__"),
        (TopicsPanel, "__init__"),
        *((kind, "show_topics") for kind in (DrivePanel, CameraPanel, TopicsPanel)),
        *((kind, "show_models") for kind in (DrivePanel, WorldPanel)),
        *((kind, "watch") for kind in (CameraPanel, TopicsPanel)),
        *((kind, "update") for kind in (WorldPanel, CameraPanel, TopicsPanel)),
        (Overlays, "update"),
    ],
)
def test_a_browser_may_leave_at_any_moment(fresh, monkeypatch, caplog, kind, method):
    """Also while what belongs to it is made or updated; another browser stays."""
    page, desk = fresh.viewer._page, fresh.viewer._desk

    def wait_for(clients):
        """Until these are connected and the page has dealt with it."""
        eventually(lambda: page.clients == clients, what=f"the browsers {clients}")
        done = threading.Event()
        page.post(done.set)
        assert done.wait(60.0)

    def controls():
        """How many the tabs hold when no browser is there any more."""
        wait_for(set())
        return sum(len(tab._children) for tab in desk._tabs.values())

    before = controls()
    opened, left, gone = threading.Event(), threading.Event(), threading.Event()
    leaving = []

    async def disconnected(handle):
        if leaving and handle.client_id == leaving[0]:
            gone.set()

    page.server.on_client_disconnect(disconnected)
    original = getattr(kind, method)
    with client(fresh) as staying, contextlib.ExitStack() as stack:
        eventually(lambda: desk._places, what="the browser that stays")
        (number,) = desk._places

        def leave(*arguments, **options):
            # What is shared, and what belongs to the browser that stays, is not what is tested.
            new = page.clients - {number}
            if new and not left.is_set():
                left.set()
                leaving.extend(new)
                # The page can deal with it before this test's thread has the connection.
                assert opened.wait(60.0)
                going.close()
                assert gone.wait(60.0)
            return original(*arguments, **options)

        monkeypatch.setattr(kind, method, leave)
        with caplog.at_level(logging.ERROR, logger="cartwheel.viewer"):
            going = stack.enter_context(client(fresh))
            opened.set()
            assert left.wait(60.0)
            wait_for({number})
        # A busy machine may have other loggers warn.
        assert [each for each in caplog.records if each.levelno >= logging.ERROR] == []
        assert set(desk._places) == set(desk.stage.seats) == {number}
        assert staying.protocol.close_code is None
    assert controls() == before
    eventually(lambda: "viewer" not in fresh.readers(IMAGE), what="the end of the images")
