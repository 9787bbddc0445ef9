"""Keys and buttons in a real browser drive the cart."""

import math
from urllib.parse import urlsplit

import pytest
from tests.viewer.browsing import browsing
from tests.viewer.conftest import TWIST, close_search, eventually

from cartwheel.geometry import Pose
from cartwheel.viewer.panels.drive import DrivePanel


def press(page, arena, key, count=1):
    """Presses a key and waits for its message."""
    before = len(arena.twists)
    page.keyboard.press(key)
    eventually(lambda: len(arena.twists) >= before + count, what=f"the Twist of {key}")
    return arena.twists[-1]


def test_every_key_sends_the_twist_of_ros(page, arena):
    sent = [press(page, arena, key) for key in "uiojklm,."]
    expected = [(0.5, 1.0), (0.5, 0.0), (0.5, -1.0), (0.0, 1.0), (0.0, 0.0), (0.0, -1.0),
                (-0.5, -1.0), (-0.5, 0.0), (-0.5, 1.0)]  # fmt: skip
    assert sent == expected


def test_i_drives_forward_and_comma_backward(page, arena):
    # Out of the way: on a busy computer the cart drives far before the next key is pressed.
    arena.ask(lambda: arena.simulation.set_pose("post", Pose((0.0, 6.0, 0.0))))
    press(page, arena, "i")
    eventually(lambda: arena.pose().x > 0.3, what="30 cm forward")
    press(page, arena, ",")
    eventually(lambda: arena.pose().x < 0.2, what="the way back")
    assert abs(arena.pose().y) < 0.05
    page.keyboard.press("k")


def test_j_turns_left(page, arena):
    press(page, arena, "j")
    eventually(lambda: arena.pose().yaw > 0.5, what="a turn to the left")
    page.keyboard.press("k")


def test_the_camera_does_not_fly_along_with_the_speed_keys(page, arena):
    press(page, arena, "i")
    before = arena.camera().position.copy()
    for key in "wxeczq":
        press(page, arena, key)
    # A held key would move it in each picture: ten of them.
    page.evaluate(
        """async () => {
          for (let i = 0; i < 10; i++) await new Promise(requestAnimationFrame);
        }"""
    )
    assert arena.camera().position == pytest.approx(before, abs=1e-6)
    x, turn = arena.twists[-1]
    assert x == pytest.approx(0.5 * (1.1 * 0.9) ** 2)
    assert turn == 0.0
    press(page, arena, "j")
    assert arena.twists[-1][1] == pytest.approx((1.1 * 0.9) ** 2)
    # Back to the speeds that the other tests expect.
    teleop = arena.viewer._desk.panel(DrivePanel)._teleop
    teleop.linear_speed, teleop.angular_speed = 0.5, 1.0
    press(page, arena, "k")


def test_any_other_key_stops(page, arena):
    press(page, arena, "i")
    assert press(page, arena, "g") == (0.0, 0.0)


def test_a_button_is_its_key(page, arena):
    page.locator("[data-key='u']").click()
    eventually(lambda: arena.twists and arena.twists[-1] == (0.5, 1.0), what="the button's Twist")
    page.locator("[data-key='k']").click()
    eventually(lambda: arena.twists[-1] == (0.0, 0.0), what="the stop")


def test_a_button_that_is_drawn_anew_while_it_is_held_is_its_key(page, arena):
    """Each command draws all buttons anew, after the time that its way to the page takes."""
    page.locator("[data-key='u']").hover()
    page.mouse.down()
    press(page, arena, "i")
    page.locator("[data-key='i'].cw-active").wait_for()
    page.mouse.up()
    eventually(lambda: arena.twists[-1] == (0.5, 1.0), what="the button's Twist")


def test_a_button_that_is_left_or_clicked_by_a_program(page, arena):
    page.locator("[data-key='u']").hover()
    page.mouse.down()
    page.locator("[data-key='o']").hover()
    page.mouse.up()
    # Found and clicked at once: between the two, another one could take its place.
    page.evaluate("""document.querySelector("[data-key='l']").click()""")
    eventually(lambda: arena.twists and arena.twists[-1] == (0.0, -1.0), what="the button's Twist")
    assert (0.5, 1.0) not in arena.twists and (0.5, -1.0) not in arena.twists


def test_a_focused_control_does_not_take_the_keys(page, arena):
    page.get_by_role("button", name="Step").focus()
    assert press(page, arena, "l") == (0.0, -1.0)
    page.get_by_label("Speed", exact=True).click()
    page.get_by_role("option", name="2", exact=True).click()
    eventually(lambda: arena.ask(lambda: arena.simulation.speed) == 2.0, what="the speed")
    assert press(page, arena, "i") == (0.5, 0.0)


def test_typing_does_not_drive(page, arena):
    page.keyboard.press("Control+k")
    search = page.get_by_placeholder("Search commands...")
    search.wait_for()
    search.press_sequentially("jilo,.")
    assert search.input_value() == "jilo,."
    close_search(page)
    # A key after it arrives after all that typing would have sent.
    assert press(page, arena, "k") == (0.0, 0.0)
    assert arena.twists == [(0.0, 0.0)]


def test_the_cart_stops_when_the_last_browser_closes(page, arena):
    press(page, arena, "i")
    with browsing(urlsplit(arena.url).port) as second:
        second.look()
        eventually(lambda: len(arena.viewer._page.clients) == 2, what="the second")
    eventually(lambda: len(arena.viewer._page.clients) == 1, what="the second to go")
    assert arena.twists[-1] == (0.5, 0.0), "one browser is still there"
    page.goto("about:blank")
    eventually(lambda: arena.twists[-1] == (0.0, 0.0), what="the stop")
    assert "viewer" not in arena.readers("/imu/data")
    page.goto(arena.url)
    page.locator("[data-key='i']").wait_for()
    assert math.isfinite(arena.pose().x)
    assert arena.graph.topic(TWIST).type == "geometry_msgs/msg/Twist"
