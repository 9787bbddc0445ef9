"""A recording in a real browser: it is shown, held, and moved in time."""

import threading
from functools import partial

import pytest
from tests.viewer.conftest import eventually, new_page

import cartwheel as cw
from cartwheel.bridges.recording.opening import open_recording
from cartwheel.playback import PlaybackSession
from cartwheel.simulation.snapshot import RunState
from cartwheel.viewer import Viewer
from cartwheel.viewer.play_desk import PlayDesk

SECONDS = 4.0


class Cinema:
    """A recording that is played on a thread of its own, with the viewer."""

    def __init__(self, path):
        with cw.World("empty") as world:
            cart = world.spawn("rosbots.xacro")
            with world.record(path):
                cart.publish("/part2_cmr/cmd_vel", linear_x=0.5)
                world.run(SECONDS)
        self.session = PlaybackSession(open_recording(path))
        self.player = self.session.simulation
        self.player.pause()
        self.viewer = Viewer(self.session, port=0, desk=partial(PlayDesk, player=self.player))
        self.viewer.start(self.player)
        self._thread = threading.Thread(target=self.player.run)
        self._thread.start()

    def ask(self, function):
        return self.player.call(function).result(120)

    def close(self):
        self.viewer.close()
        self.player.post(self.player.stop)
        self._thread.join(120)

    @property
    def shown(self):
        return self.viewer._desk.stage.scene.snapshot


@pytest.fixture(scope="module")
def cinema(tmp_path_factory):
    made = Cinema(tmp_path_factory.mktemp("films") / "drive.mcap")
    yield made
    made.close()


@pytest.fixture(scope="module")
def page(browser, cinema):
    made = new_page(browser)
    faults = []
    made.on("pageerror", lambda error: faults.append(error.stack))
    made.goto(cinema.viewer.url)
    made.locator(".cw-clock").wait_for()
    eventually(lambda: cinema.shown, what="the scene")
    yield made
    made.close()
    assert faults == []


def shown_ns(page):
    return int(page.locator(".cw-clock[data-time-ns]").get_attribute("data-time-ns"))


def place(cinema):
    rows = [i for i, (model, _) in enumerate(cinema.shown.scene.links) if model == "rosbots"]
    return float(cinema.shown.positions[rows[0]][0])


def test_a_jump_by_hand_moves_the_robot(page, cinema):
    field = page.get_by_role("textbox").filter(visible=True)
    slider = page.get_by_role("slider").first
    assert float(slider.get_attribute("aria-valuemax")) == pytest.approx(SECONDS)
    for wanted in ("3", "1"):

        def jumped(wanted: str = wanted) -> bool:
            # A page that is drawn anew while it is typed into has the old number again.
            if shown_ns(page) != int(wanted) * 10**9:
                time_field = next(each for each in field.all() if _is_number(each.input_value()))
                time_field.fill(wanted)
                time_field.press("Enter")
            return shown_ns(page) == int(wanted) * 10**9

        eventually(jumped, what="the time")
        # It speeds up with 1 m/s² for half a second, and loses an eighth of a metre with that.
        expected = 0.5 * float(wanted) - 0.125
        eventually(lambda e=expected: abs(place(cinema) - e) < 0.03, what="the cart there")
    assert cinema.ask(lambda: cinema.player.run_state) is RunState.PAUSED


def test_a_browser_that_falls_silent_disturbs_nobody(page, cinema, caplog):
    made = cinema.viewer._page
    (number,) = made.clients
    done = threading.Event()
    made._silent(number)
    made.post(done.set)
    assert done.wait(60.0)
    assert "the web interface failed" not in caplog.messages


def _is_number(text):
    try:
        float(text)
    except ValueError:
        return False
    return True


def test_it_plays_and_holds(page, cinema):
    page.get_by_role("button", name="Reset").click()
    eventually(lambda: shown_ns(page) == 0, what="the start")
    # So slowly that a busy machine does not reach the end before it is held.
    cinema.ask(lambda: cinema.player.set_speed(0.05))
    page.get_by_role("button", name="Resume").click()
    eventually(lambda: shown_ns(page) > 50_000_000, what="time")
    page.get_by_role("button", name="Pause").click()
    page.locator(".cw-paused").wait_for()
    cinema.ask(lambda: cinema.player.set_speed(1.0))
    held = cinema.ask(lambda: cinema.player.time_ns)
    page.get_by_role("button", name="Step").click()
    eventually(lambda: shown_ns(page) == held + cinema.player.step_ns, what="a step")
    slider = page.get_by_role("slider").first
    eventually(
        # It has milliseconds.
        lambda: abs(float(slider.get_attribute("aria-valuenow")) - shown_ns(page) / 1e9) < 0.0011,
        what="the slider where time is",
    )


def test_the_image_is_the_one_of_that_time(page, cinema):
    cinema.ask(lambda: cinema.player.seek(2_000_000_000))
    page.get_by_text("320 × 240 rgb8").wait_for()
    assert "viewer" in cinema.session.graph.topic("/rosbots/camera1/image_raw").subscribers
