"""Camera, IMU and bumper in a real browser."""

import numpy as np
from tests.viewer.conftest import CART, eventually, picture_of

from cartwheel.geometry import Pose, quat_from_rpy


def turn(arena, yaw, x=0.0):
    def run():
        z = arena.simulation.pose(CART).z
        arena.simulation.set_pose(CART, Pose((x, 0.0, z), quat_from_rpy(0.0, 0.0, yaw)))

    arena.ask(run)


def redness(picture):
    """The share of the picture that is plainly red."""
    red, rest = picture[:, :, 0], picture[:, :, 1:].max(axis=2)
    return float(((red > 60) & (red > 2 * rest)).mean())


def test_the_image_shows_the_post_and_loses_it_when_the_cart_turns(page, arena):
    eventually(lambda: (p := picture_of(page)) is not None and redness(p) > 0.02, what="the post")
    picture = picture_of(page)
    assert picture.shape == (240, 320, 3)
    # The post stands straight ahead: its red is in the middle.
    columns = ((picture[:, :, 0] > 60) & (picture[:, :, 0] > 2 * picture[:, :, 1])).nonzero()[1]
    assert abs(np.median(columns) - 160) < 12
    turn(arena, 1.6)
    eventually(lambda: redness(picture_of(page)) < 0.001, what="a picture without the post")
    assert picture_of(page).mean() > 30, "not black"


def test_the_caption_says_encoding_and_measured_rate(page):
    caption = page.locator(".cw-caption")
    eventually(lambda: "Hz" in caption.inner_text(), what="the rate")
    text = caption.inner_text()
    assert "320 × 240 rgb8" in text
    # 30 Hz of simulated time as stated, whatever the speed of this machine.
    eventually(
        lambda: abs(float(caption.inner_text().split("·")[1].split()[0]) - 30.0) < 1.5,
        what="30 Hz",
    )


def test_nothing_is_rendered_while_the_image_is_off(page, arena):
    topic = "/rosbots/camera1/image_raw"
    eventually(lambda: "viewer" in arena.readers(topic), what="the subscription")
    page.get_by_label("Show the image").click()
    eventually(lambda: "viewer" not in arena.readers(topic), what="the end of it")
    page.get_by_label("Show the image").click()
    eventually(lambda: "viewer" in arena.readers(topic), what="the subscription")


def test_the_bumper_names_what_it_hits_and_goes_out(page, arena):
    light = page.locator(".cw-bumper")
    assert "No contact" in light.inner_text()
    turn(arena, 0.0, x=1.2)
    page.keyboard.press("i")
    page.locator(".cw-bumper.cw-hit").wait_for()
    assert "post" in light.inner_text()
    assert "post::link::" in light.get_attribute("title")
    page.keyboard.press(",")
    page.locator(".cw-bumper:not(.cw-hit)").wait_for()
    page.keyboard.press("k")


def test_the_imu_is_drawn_and_goes_on(page):
    plot = page.locator(".uplot canvas").first
    plot.wait_for()
    inked = """canvas => {
        const d = canvas.getContext("2d").getImageData(0, 0, canvas.width, canvas.height).data;
        let hash = 0;
        for (let i = 0; i < d.length; i += 4)
          if (d[i + 3] > 0) hash = (hash * 31 + d[i] * 65536 + d[i + 1] * 256 + d[i + 2]) | 0;
        return hash;
    }"""
    first = plot.evaluate(inked)
    eventually(lambda: plot.evaluate(inked) != first, what="a new curve")


def test_a_topic_is_echoed(page, arena):
    page.get_by_text("Topics", exact=True).click()
    assert "/odom" in page.locator(".cw-list").first.inner_text()
    page.get_by_label("Echo").click()
    page.get_by_role("option", name="/imu/data").click()
    page.locator(".cw-echo").wait_for()
    assert "angular_velocity:" in page.locator(".cw-echo").inner_text()
    page.get_by_label("Echo").click()
    page.get_by_role("option", name="none").click()
    page.locator(".cw-echo").wait_for(state="detached")
    page.get_by_text("IMU", exact=True).click()
