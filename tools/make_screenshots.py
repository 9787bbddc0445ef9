"""Makes docs/images/browser.png: the page, with the cart driving towards a box.

Run: python tools/make_screenshots.py
"""

from __future__ import annotations

import io
import shutil
import sys
import threading
import time
from pathlib import Path
from typing import Any

from cartwheel.description import load_robot, load_world
from cartwheel.description.files.package_folders import share
from cartwheel.geometry import Pose, quat_from_rpy
from cartwheel.session import Session
from cartwheel.viewer import Viewer

ROOT = Path(__file__).resolve().parent.parent
TARGET = ROOT / "docs" / "images" / "browser.png"
LARGEST = 400_000
"""Size limit of the image, bytes."""
FLAGS = ["--no-sandbox", "--use-gl=angle", "--use-angle=swiftshader", "--enable-unsafe-swiftshader"]


def make_session() -> Session:
    """A world with the cart, a post in front of it, and some objects around it."""
    session = Session(load_world(share() / "worlds" / "post.world"))
    cart = load_robot(share() / "robots" / "rosbots_description" / "urdf" / "rosbots.xacro")
    session.spawn(cart, pose=Pose((0.0, 0.0, 0.1)))
    models = share() / "models"
    for path, pose in (
        (models / "traffic_cone" / "model.sdf", Pose((1.7, -1.0, 0.01))),
        (models / "barrel.urdf", Pose((2.6, 1.4, 0.01))),
        (models / "box_medium.urdf", Pose((0.5, 1.6, 0.01), quat_from_rpy(0, 0, 0.5))),
    ):
        session.spawn(load_robot(path), pose=pose)
    return session


def take(page: Any, session: Session) -> bytes:
    """Drives the cart along a curve, then takes the screenshot."""
    simulation = session.simulation
    page.locator("[data-key='i']").wait_for()
    notes = page.locator(".mantine-Notification-root button")
    notes.first.wait_for()
    notes.first.evaluate("button => button.click()")
    # The page disables shadows without a GPU; a screenshot has time for them.
    page.wait_for_timeout(4000)
    page.keyboard.press("F9")
    page.get_by_text("View", exact=True).click()
    page.get_by_label("Trail").click()
    page.get_by_text("World", exact=True).click()
    simulation.call(simulation.reset).result(10)
    for key, seconds in (("u", 1.0), ("o", 1.3), ("i", 0.5), ("k", 0.0)):
        page.keyboard.press(key)
        until = simulation.time_ns + int(seconds * 1e9)
        while simulation.time_ns < until:
            time.sleep(0.01)
    page.mouse.move(720, 880)
    page.wait_for_timeout(2500)
    return bytes(page.screenshot(timeout=300_000))


def write(png: bytes) -> None:
    """Writes the image, with the number of colours that the size limit allows."""
    from PIL import Image

    image = Image.open(io.BytesIO(png)).convert("RGB")
    for colours in (None, 256, 128, 64):
        made = image if colours is None else image.quantize(colours)
        out = io.BytesIO()
        made.save(out, "PNG", optimize=True)
        if out.tell() <= LARGEST:
            TARGET.parent.mkdir(parents=True, exist_ok=True)
            TARGET.write_bytes(out.getvalue())
            print(f"{TARGET.relative_to(ROOT)}: {out.tell()} bytes")
            return
    raise SystemExit("the picture is too large in any number of colours")


def main() -> None:
    """Entry point."""
    from playwright.sync_api import sync_playwright

    chromium = shutil.which("chromium-headless-shell") or shutil.which("chromium")
    if chromium is None:
        sys.exit("Chromium is missing: apt-get install chromium-headless-shell")
    session = make_session()
    viewer = Viewer(session, port=0)
    pacer = session.pacer()
    viewer.start(pacer)

    def run() -> None:
        pacer.run()
        session.close()

    thread = threading.Thread(target=run)
    thread.start()
    try:
        with sync_playwright() as playwright:
            browser = playwright.chromium.launch(executable_path=chromium, args=FLAGS)
            page = browser.new_page(viewport={"width": 1440, "height": 900})
            page.set_default_timeout(300_000)
            page.goto(viewer.url)
            write(take(page, session))
            browser.close()
    finally:
        viewer.close()
        session.simulation.call(session.simulation.stop).result(10)
        thread.join()


if __name__ == "__main__":
    main()
