"""Several browsers at one page: each has its own choices, and what it drives ends with it."""

from __future__ import annotations

import contextlib
import signal
import subprocess
import sys
import threading
from pathlib import Path

import pytest
from tests.viewer.browsing import browsing
from tests.viewer.conftest import TWIST, eventually, new_page

import cartwheel as cw
from cartwheel.messages import from_dict
from cartwheel.viewer.page import Page
from cartwheel.viewer.panels.camera import CameraPanel
from cartwheel.viewer.panels.topics import TopicsPanel
from cartwheel.viewer.panels.world import WorldPanel

GO, TURN, STOP = (0.5, 0.0), (0.0, 1.0), (0.0, 0.0)


@pytest.fixture
def fresh(arena):
    eventually(lambda: not arena.viewer._desk._places, what="an empty house")
    arena.start_over()
    return arena


@contextlib.contextmanager
def seated(arena, **options):
    """A browser that is connected, and its number."""
    before = set(arena.viewer._desk._places)
    with browsing(int(arena.url.rpartition(":")[2]), **options) as browser:
        browser.look()
        (number,) = eventually(lambda: set(arena.viewer._desk._places) - before, what="the seat")
        yield browser, number


def settle(arena):
    """Returns when the page and the simulation have done what was asked until now."""
    done = threading.Event()
    arena.viewer._page.post(done.set)
    assert done.wait(60)
    arena.ask(lambda: None)


def press(arena, browser, label, twist):
    browser.send({"type": "CommandTriggerMessage", "uuid": browser.control(f"Drive: {label}")})
    eventually(lambda: arena.twists and arena.twists[-1] == twist, what=label)


def change(browser, label, value):
    uuid = browser.control(label)
    browser.send({"type": "GuiUpdateMessage", "uuid": uuid, "updates": {"value": value}})


def test_what_a_browser_drives_stops_with_it_while_another_is_open(fresh):
    with seated(fresh) as (other, _):
        with seated(fresh) as (browser, _):
            press(fresh, browser, "forward", GO)
        eventually(lambda: fresh.twists[-1] == STOP, what="the stop")
        # And the other one still drives.
        press(fresh, other, "turn left", TURN)


def test_what_another_browser_drives_by_then_goes_on(fresh):
    with seated(fresh) as (other, number):
        with seated(fresh) as (browser, _):
            press(fresh, browser, "forward", GO)
            press(fresh, other, "turn left", TURN)
        eventually(lambda: set(fresh.viewer._desk._places) == {number}, what="one browser")
        settle(fresh)
        assert fresh.twists == [GO, TURN]


def test_who_drives_by_ros_drives_on(fresh):
    with seated(fresh):
        message = from_dict("geometry_msgs/msg/Twist", {"linear": {"x": 0.3}})
        fresh.graph.publish(TWIST, "geometry_msgs/msg/Twist", message)
        eventually(lambda: fresh.twists, what="the command")
    eventually(lambda: not fresh.viewer._desk._places, what="an empty house")
    settle(fresh)
    assert fresh.twists == [(0.3, 0.0)]


SILENT = """
import sys
from browsing import browsing
with browsing(int(sys.argv[1])) as browser:
    browser.look()
    browser.send({"type": "CommandTriggerMessage", "uuid": browser.control("Drive: forward")})
    print("driving", flush=True)
    browser.hear(lambda _: False, 600)
"""


def test_a_browser_that_falls_silent_drives_no_longer(fresh):
    """As where the network is gone: the connection stands, and nothing comes over it."""
    port = fresh.url.rpartition(":")[2]
    with subprocess.Popen(
        [sys.executable, "-c", SILENT, port], cwd=Path(__file__).parents[1], stdout=subprocess.PIPE
    ) as process:
        try:
            assert process.stdout.readline() == b"driving\n"
            eventually(lambda: fresh.twists == [GO], what="the command")
            process.send_signal(signal.SIGSTOP)
            eventually(lambda: fresh.twists == [GO, STOP], what="the stop")
            assert fresh.viewer._page.clients, "it is still connected"
        finally:
            process.kill()


def test_selection_toggles_and_choices_are_each_browsers_own(fresh):
    desk = fresh.viewer._desk
    with seated(fresh) as (one, first), seated(fresh) as (two, second):
        change(one, "post", True)
        change(one, "Collision shapes", True)
        change(one, "Visual shapes", False)
        change(one, "Echo", "/imu/data")
        change(one, "Show the image", False)
        one.hear(lambda m: str(m.get("name", "")).startswith("/models/post/collision_"))
        # The page hears of each change at its own time.
        eventually(lambda: desk.panel(WorldPanel, first).selected == "post", what="it selected")
        eventually(lambda: desk.panel(TopicsPanel, first)._tap is not None, what="the echo")
        eventually(lambda: desk.panel(CameraPanel, first)._tap is None, what="no image")
        settle(fresh)
        assert desk.panel(WorldPanel, second).selected is None
        seats = desk.stage.seats
        assert (seats[first].display.collision, seats[second].display.collision) == (True, False)
        assert (seats[first].display.visual, seats[second].display.visual) == (False, True)
        assert desk.panel(TopicsPanel, second)._tap is None
        assert desk.panel(CameraPanel, second)._tap is not None
        # What has been sent up to now: a last thing that only the second one does.
        change(two, "Link names", True)
        two.hear(lambda m: str(m.get("name", "")).endswith("/name"))
        own = [m for m in two.messages if m.get("owner", "") != ""]
        assert own
        assert {m["owner"] for m in own} == {str(second)}
        assert not [m for m in own if "collision_" in m["name"] or "visual_" in m["name"]]


def test_a_browser_keeps_its_toggles(fresh):
    with seated(fresh) as (browser, _):
        change(browser, "Collision shapes", True)
        change(browser, "Camera frustum", False)
        script = browser.hear(lambda m: "camera;" in str(m.get("source")))["source"]
    cookie = script.partition('"')[2].partition(";")[0]
    port = fresh.url.rpartition(":")[2]
    assert cookie == f"cartwheel-view-{port}=collision.camera"
    with seated(fresh, additional_headers={"Cookie": f"a=b; {cookie}.unknown"}) as (again, number):
        display = fresh.viewer._desk.stage.seats[number].display
        assert (display.collision, display.camera, display.visual) == (True, False, True)
        uuid = again.control("Collision shapes")
        assert again.hear(lambda m: m.get("uuid") == uuid)["value"]
        again.hear(lambda m: str(m.get("name", "")).startswith("/models/post/collision_"))
    with seated(fresh) as (_, number):
        assert not fresh.viewer._desk.stage.seats[number].display.collision


def test_what_a_browser_holds_in_the_air_falls_when_it_is_gone(fresh):
    with seated(fresh) as (browser, number):
        world = fresh.viewer._desk.panel(WorldPanel, number)
        change(browser, "post", True)
        eventually(lambda: world._gizmo is not None, what="the gizmo")
        drag = {"name": "/gizmo", "owner": str(number)}
        browser.send({"type": "TransformControlsDragStartMessage", **drag})
        pose = fresh.pose("post")
        browser.send(
            {
                "type": "TransformControlsUpdateMessage",
                **drag,
                "wxyz": [1, 0, 0, 0],
                "position": [pose.x, pose.y, 1.0],
            }
        )
        eventually(lambda: fresh.pose("post").z > 0.9, what="the post in the air")
    eventually(lambda: fresh.pose("post").z < 0.05, what="the fall")


def test_a_program_waits_for_a_browser(browser):
    with cw.World("empty") as world:
        url = world.show(port=0)
        assert not world.wait_for_browser(timeout=0)
        page = new_page(browser)
        try:
            page.goto(url)
            assert world.wait_for_browser(timeout=60)
        finally:
            page.close()


RENDERER = """
const ask = WebGL2RenderingContext.prototype.getParameter;
WebGL2RenderingContext.prototype.getParameter = function (what) {
  return what === 0x9246 ? "NVIDIA" : ask.call(this, what);
};
"""
"""Claims a GPU: UNMASKED_RENDERER_WEBGL."""


def test_only_a_browser_with_a_gpu_draws_shadows(browser, arena, monkeypatch):
    shown = []
    real = Page._show_shadows

    def note(page, client, **choice):
        shown.append((client.client_id, choice["shown"]))
        real(page, client, **choice)

    monkeypatch.setattr(Page, "_show_shadows", note)
    numbers = []
    for script in ("", RENDERER):
        page = new_page(browser)
        page.add_init_script(script)
        before = set(arena.viewer._desk._places)
        page.goto(arena.url)
        (number,) = eventually(lambda b=before: set(arena.viewer._desk._places) - b, what="it")
        page.locator("canvas[data-engine]").wait_for()
        numbers.append(number)
        if script:
            eventually(lambda: shown, what="the shadows")
        else:
            # Longer than a browser with a GPU waits.
            page.wait_for_timeout(2500)
        page.close()
    assert shown == [(numbers[1], True)]
