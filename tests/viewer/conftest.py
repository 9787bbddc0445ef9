"""A running simulation with its page, and a real browser to look at it."""

from __future__ import annotations

import base64
import contextlib
import io
import shutil
import threading
import time
from pathlib import Path

import numpy as np
import pytest

from cartwheel.description import load_robot, load_world
from cartwheel.description.files.package_folders import share
from cartwheel.geometry import Pose, matrix_from_quat
from cartwheel.session import Session
from cartwheel.viewer import Viewer
from cartwheel.viewer.panels.world import WorldPanel

BROWSERS = ("chromium-headless-shell", "chromium", "chromium-browser")
"""The first has no windows, and needs half as many packages."""
CHROMIUM = next(filter(None, map(shutil.which, BROWSERS)), None)
FLAGS = [
    "--no-sandbox",
    "--use-gl=angle",
    "--use-angle=swiftshader",
    "--enable-unsafe-swiftshader",
    # OpenGL for the scene alone: in software, it takes far longer for the rest of the page.
    "--disable-gpu-compositing",
    "--disable-quic",
    "--no-first-run",
    "--disable-background-networking",
    "--disable-component-update",
    "--disable-sync",
]
SIZE = {"width": 1000, "height": 720}
"""CSS pixels; half as many are drawn, as no GPU helps here."""
LEFT, RIGHT = 306, 674
"""Columns between which the scene lies."""
CART = "rosbots"
TWIST = "/part2_cmr/cmd_vel"


def eventually(condition, *, seconds=240.0, what="it"):
    """Waits for a condition, and gives what it returned."""
    deadline = time.monotonic() + seconds
    while time.monotonic() < deadline:
        found = condition()
        if found:
            return found
        time.sleep(0.02)
    raise AssertionError(f"{what} did not come within {seconds} s")


class Arena:
    """A session on a thread of its own, with the viewer."""

    def __init__(self, world="post.world"):
        self.session = Session(load_world(share() / "worlds" / world))
        self.session.spawn(
            load_robot(share() / "robots/rosbots_description/urdf/rosbots.xacro"),
            pose=Pose((0.0, 0.0, 0.1)),
        )
        self.graph = self.session.graph
        self.simulation = self.session.simulation
        self.twists = []
        self.graph.subscribe(
            TWIST, lambda m: self.twists.append((m.linear.x, m.angular.z)), node="test"
        )
        self.viewer = Viewer(self.session, port=0)
        pacer = self.session.pacer()
        self.viewer.start(pacer)
        self._thread = threading.Thread(target=self._run, args=(pacer,), daemon=True)
        self._thread.start()
        self.url = self.viewer.url

    def _run(self, pacer):
        try:
            pacer.run()
        finally:
            # On the thread that rendered: an OpenGL context belongs to one.
            self.session.close()

    def ask(self, function):
        """Runs a function on the simulation's thread."""
        return self.simulation.call(function).result(120)

    def pose(self, name=CART):
        return self.ask(lambda: self.simulation.pose(name))

    def models(self):
        return self.ask(lambda: self.simulation.models)

    def start_over(self):
        """The state that each test begins with."""

        def run():
            for name in self.simulation.models:
                if name not in ("ground_plane", "post", CART):
                    self.simulation.delete(name)
            self.simulation.reset()
            self.simulation.set_speed(1.0)
            self.simulation.resume()

        self.ask(run)
        self.twists.clear()

    def readers(self, topic):
        return self.graph.topic(topic).subscribers

    def camera(self):
        """The one browser's camera, as it reports it."""
        clients = self.viewer._page.server.get_clients()
        return next(iter(clients.values())).camera

    def close(self):
        self.viewer.close()
        self.ask(self.simulation.stop)
        self._thread.join(120)


@pytest.fixture(scope="session")
def browser():
    if CHROMIUM is None:
        pytest.skip("no Chromium: apt-get install chromium-headless-shell")
    api = pytest.importorskip("playwright.sync_api")
    with api.sync_playwright() as playwright:
        made = playwright.chromium.launch(executable_path=CHROMIUM, args=FLAGS)
        yield made
        made.close()


@pytest.fixture(scope="module")
def arena():
    made = Arena()
    yield made
    made.close()


PATIENCE_MS = 240_000
"""ms for a page that other programs leave hardly any time."""
CALM = """
window.requestAnimationFrame = (draw) => setTimeout(() => draw(performance.now()), 250);
window.cancelAnimationFrame = clearTimeout;
const made = HTMLCanvasElement.prototype.getContext;
HTMLCanvasElement.prototype.getContext = function (kind, options) {
  return made.call(this, kind, kind.startsWith("webgl") ? {...options, antialias: false} : options);
};
"""
"""Draws at most 4 images a second, without antialiasing: without a GPU, more takes a processor."""
UNDRAWN = """
for (const name of ["drawArrays", "drawArraysInstanced", "drawElements", "drawElementsInstanced",
                    "drawRangeElements"])
  WebGL2RenderingContext.prototype[name] = () => {};
"""
"""Leaves the scene empty, and clicks in it without effect. Without a GPU, the first image takes a
third of what a page takes to open."""


def new_page(browser, *, drawn=False):
    """A page that is patient, small, and draws seldom, or all of the page but the scene."""
    page = browser.new_page(viewport=SIZE, device_scale_factor=0.5)
    page.set_default_timeout(PATIENCE_MS)
    page.add_init_script(CALM if drawn else CALM + UNDRAWN)
    return page


def open_page(browser, arena, *, drawn=False):
    """A page at which a camera stands that sees the cart and the post."""
    page = new_page(browser, drawn=drawn)
    page.faults = []
    page.on("pageerror", lambda error: page.faults.append(error.stack))
    page.goto(arena.url)
    page.locator("[data-key='i']").wait_for()
    page.get_by_role("button", name=CART, exact=True).wait_for()
    eventually(lambda: arena.viewer._page.clients, what="the browser")
    # The stage between the panels is narrow here: step back until cart and post stand in it.
    for client in arena.viewer._page.server.get_clients().values():
        client.camera.position = (-4.4, -5.2, 3.4)
        client.camera.look_at = (1.3, 0.0, 0.3)
    return page


@contextlib.contextmanager
def opened_page(browser, arena, **options):
    """A page that tests share. It may raise no error until it is closed."""
    page = open_page(browser, arena, **options)
    yield page
    page.close()
    assert page.faults == []


@pytest.fixture
def page(shared_page, arena):
    """The shared page, at the start of a new run."""
    close_search(shared_page)
    arena.twists.clear()
    shared_page.keyboard.press("k")
    # A command of the test before may arrive only now; the last of all is the stop.
    eventually(lambda: arena.twists and arena.twists[-1] == (0.0, 0.0), what="the stop")
    arena.start_over()
    yield shared_page


def close_search(page):
    """Puts the list of commands away; the key again where it met the list still unfolding."""
    search = page.get_by_placeholder("Search commands...")

    def gone():
        if not search.is_visible():
            return True
        page.keyboard.press("Escape")
        return False

    eventually(gone, what="the end of the list of commands")


def close_notes(page):
    """Uncovers the scene."""

    def gone():
        # All at once and in the page: one that goes by itself meanwhile is no error.
        return page.evaluate(
            """() => {
              const buttons = document.querySelectorAll(".mantine-Notification-root button");
              buttons.forEach(button => button.click());
              return buttons.length === 0;
            }"""
        )

    eventually(gone, what="the scene uncovered")


def row(page, name):
    """The button of a model in the list."""
    return page.get_by_role("button", name=name, exact=True)


def world_panel(arena):
    return arena.viewer._desk.panel(WorldPanel)


def screenshot(page):
    """What the page shows, shape (height, width, 3)."""
    from PIL import Image

    return np.asarray(Image.open(io.BytesIO(page.screenshot(scale="css"))).convert("RGB")).astype(
        int
    )


def stage(picture):
    """The part of the page between its panels."""
    return picture[:, LEFT:RIGHT]


def count(picture, channel):
    """Pixels that are plainly of one channel's colour."""
    others = [c for c in range(3) if c != channel]
    own = picture[:, :, channel]
    return int(((own > 90) & (own > 2.2 * picture[:, :, others].max(axis=2))).sum())


def project(camera, point, box):
    """Where a point of the world is on the screen, in pixels.

    Args:
        camera: viser's: looks along z, y down; `fov` is vertical.
        point: m.
        box: The canvas: x, y, width, height.
    """
    w, x, y, z = camera.wxyz
    local = matrix_from_quat((x, y, z, w)).T @ (np.asarray(point) - camera.position)
    focal = box["height"] / 2 / np.tan(camera.fov / 2)
    return (
        box["x"] + box["width"] / 2 + focal * local[0] / local[2],
        box["y"] + box["height"] / 2 + focal * local[1] / local[2],
    )


def picture_of(page):
    """The camera panel's image as the browser decoded it, shape (height, width, 3)."""
    from PIL import Image

    found = page.evaluate(
        """() => {
          const image = [...document.querySelectorAll("img")].find(i => i.src.startsWith("blob:"));
          if (!image || !image.complete || !image.naturalWidth) return null;
          const canvas = document.createElement("canvas");
          canvas.width = image.naturalWidth; canvas.height = image.naturalHeight;
          canvas.getContext("2d").drawImage(image, 0, 0);
          return canvas.toDataURL("image/png");
        }"""
    )
    if found is None:
        return None
    data = base64.b64decode(found.partition(",")[2])
    return np.asarray(Image.open(io.BytesIO(data)).convert("RGB")).astype(int)


def write(folder: Path, name: str, text: str) -> Path:
    path = folder / name
    path.write_text(text)
    return path
