"""Pause, step, reset and speed in a real browser."""

from tests.viewer.conftest import eventually

from cartwheel.simulation.snapshot import RunState


def time_ns(arena):
    return arena.ask(lambda: arena.simulation.time_ns)


def shown_ns(page):
    return int(page.locator(".cw-clock[data-time-ns]").get_attribute("data-time-ns"))


def test_space_holds_time_and_lets_it_go(page, arena):
    page.keyboard.press(" ")
    eventually(lambda: arena.ask(lambda: arena.simulation.run_state) is RunState.PAUSED)
    page.locator(".cw-paused").wait_for()
    held = time_ns(arena)
    eventually(lambda: shown_ns(page) == held, what="the time on the page")
    page.get_by_role("button", name="Resume").click()
    eventually(lambda: time_ns(arena) > held, what="time")
    page.locator(".cw-running").wait_for()


def test_step_is_one_step_of_physics(page, arena):
    page.get_by_role("button", name="Pause").click()
    page.locator(".cw-paused").wait_for()
    for expected in (1, 2):
        before = time_ns(arena)
        page.get_by_role("button", name="Step").click()
        eventually(lambda b=before: time_ns(arena) != b, what="the step")
        assert time_ns(arena) == before + arena.simulation.step_ns, expected
    eventually(lambda: shown_ns(page) == time_ns(arena), what="the time on the page")


def test_space_does_not_click_the_button_that_was_clicked_last(page, arena):
    page.get_by_role("button", name="Pause").click()
    page.locator(".cw-paused").wait_for()
    before = time_ns(arena)
    page.get_by_role("button", name="Step").click()
    # viser's page may send a click after a key that was pressed later.
    eventually(lambda: time_ns(arena) != before, what="the step")
    page.keyboard.press(" ")
    page.locator(".cw-running").wait_for()


def test_reset_takes_time_and_models_back(page, arena):
    page.keyboard.press("i")
    eventually(lambda: arena.pose().x > 0.2, what="the cart to drive")
    page.keyboard.press("k")
    page.get_by_role("button", name="Pause").click()
    page.locator(".cw-paused").wait_for()
    page.get_by_role("button", name="Reset").click()
    eventually(lambda: time_ns(arena) == 0, what="time zero")
    assert abs(arena.pose().x) < 1e-6
    eventually(lambda: shown_ns(page) == 0, what="the time on the page")


def test_the_speed_is_set_and_shown(page, arena):
    page.get_by_label("Speed", exact=True).click()
    page.get_by_role("option", name="0.1").click()
    eventually(lambda: arena.ask(lambda: arena.simulation.speed) == 0.1, what="the speed")
    factor = page.locator(".cw-factor")
    eventually(lambda: factor.inner_text().startswith("0.1"), what="the factor")


def test_a_speed_set_elsewhere_shows_here(page, arena):
    arena.ask(lambda: arena.simulation.set_speed(5.0))
    eventually(
        lambda: page.get_by_label("Speed", exact=True).input_value() == "5", what="the speed"
    )
