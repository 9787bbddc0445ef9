"""Several browsers at one page: each has its own choices, and what it drives ends with it."""

from __future__ import annotations

import contextlib
import signal
import subprocess
import sys
import threading
import time
from pathlib import Path

import pytest
import viser
from tests.viewer.browsing import browsing
from tests.viewer.conftest import TWIST, eventually, new_page

import cartwheel as cw
from cartwheel.geometry import Pose
from cartwheel.messages import from_dict
from cartwheel.viewer.page import Page
from cartwheel.viewer.panels.camera import CameraPanel
from cartwheel.viewer.panels.topics import TopicsPanel
from cartwheel.viewer.panels.world import WorldPanel
from cartwheel.viewer.scene_view import pose_in

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


def select_post(browser):
    """Selects the post, and returns when the gizmo is there."""
    change(browser, "post", True)
    browser.hear(lambda m: m["type"] == "TransformControlsMessage" and m["name"] == "/gizmo")


def drag(browser, number, phase, **more):
    """Sends what a page sends of a drag: "DragStart", "Update" with a place, or "DragEnd"."""
    target = {"name": "/gizmo", "owner": str(number)}
    browser.send({"type": f"TransformControls{phase}Message", **target, **more})


def lift(browser, number, pose):
    """Drags the post 1 m up."""
    drag(browser, number, "DragStart")
    drag(browser, number, "Update", wxyz=[1, 0, 0, 0], position=[pose.x, pose.y, 1.0])


def test_what_a_browser_holds_in_the_air_falls_when_it_is_gone(fresh):
    with seated(fresh) as (browser, number):
        select_post(browser)
        lift(browser, number, fresh.pose("post"))
        eventually(lambda: fresh.pose("post").z > 0.9, what="the post in the air")
    eventually(lambda: fresh.pose("post").z < 0.05, what="the fall")


@pytest.mark.parametrize("ends", [False, True])
def test_a_drag_is_not_lost_while_the_page_is_busy(fresh, ends):
    """The gizmo follows the model until the page's thread learns of the drag."""
    fresh.ask(fresh.simulation.pause)
    go_on = threading.Event()
    moved = Pose((2.4, 0.5, 0.0))

    def waits():
        snapshot = fresh.viewer._slot
        return snapshot is not None and pose_in(snapshot, "post").y == pytest.approx(0.5)

    with seated(fresh) as (browser, number):
        select_post(browser)
        settle(fresh)
        gizmo = fresh.viewer._desk.panel(WorldPanel, number)._gizmo
        fresh.viewer._page.post(go_on.wait)
        try:
            fresh.ask(lambda: fresh.simulation.set_pose("post", moved))
            eventually(waits, what="the state that the page will show")
            lift(browser, number, moved)
            if ends:
                drag(browser, number, "DragEnd")
            eventually(lambda: gizmo.position[2] == 1.0, what="the drag")
        finally:
            go_on.set()
        eventually(lambda: fresh.pose("post").z == pytest.approx(1.0), what="the post in the air")
        eventually(lambda: gizmo.position[2] == pytest.approx(1.0), what="the gizmo at the post")


def test_what_a_browser_does_as_soon_as_it_can_is_not_lost(fresh, monkeypatch):
    """Controls come with their callbacks, however long the page takes to set these."""

    def slowly(real, wanted):
        def add(handle, callback):
            if wanted(handle):
                time.sleep(0.3)
            return real(handle, callback)

        return add

    for kind, name, wanted in (
        (viser.CommandHandle, "on_trigger", lambda handle: handle.label == "Drive: forward"),
        (viser.GuiButtonHandle, "on_click", lambda handle: handle.label == "post"),
        (viser.TransformControlsHandle, "on_update", lambda _: True),
    ):
        monkeypatch.setattr(kind, name, slowly(getattr(kind, name), wanted))
    with browsing(int(fresh.url.rpartition(":")[2])) as browser:
        browser.look()
        press(fresh, browser, "forward", GO)
        select_post(browser)
        (number,) = fresh.viewer._desk._places
        lift(browser, number, fresh.pose("post"))
        eventually(lambda: fresh.pose("post").z > 0.9, what="the post in the air")


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
