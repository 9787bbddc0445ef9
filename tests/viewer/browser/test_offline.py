"""What the page says when the simulation cannot be reached any more."""

import signal

import pytest
from tests.viewer.conftest import eventually, new_page
from tests.viewer.running import running

NOTICE = ".cw-offline-notice"
SHOWN = "getComputedStyle(document.querySelector('.cw-state'), '::after').content"


@pytest.fixture(scope="module")
def simulation(tmp_path_factory):
    with running(tmp_path_factory.mktemp("offline")) as started:
        yield started


@pytest.fixture(scope="module")
def shared_page(browser, simulation):
    page = new_page(browser)
    page.goto(f"http://127.0.0.1:{simulation.port}")
    yield page
    page.close()


@pytest.fixture
def page(shared_page):
    shared_page.locator(".cw-running").wait_for()
    assert not shared_page.locator(NOTICE).is_visible()
    return shared_page


def test_a_silent_simulation_is_not_shown_as_running(page, simulation):
    """Frozen, it says nothing and does not close the connection: as a network that is gone."""
    simulation.process.send_signal(signal.SIGSTOP)
    try:
        page.locator(NOTICE).wait_for()
        assert "Connection lost" in page.locator(NOTICE).inner_text()
        assert page.evaluate(SHOWN) == '"not connected"'
    finally:
        simulation.process.send_signal(signal.SIGCONT)
    page.locator(NOTICE).wait_for(state="hidden")
    eventually(lambda: page.evaluate(SHOWN) == "none", what="the state")


def test_a_simulation_that_is_gone_is_not_shown_as_running(page, simulation):
    simulation.process.kill()
    page.locator(NOTICE).wait_for()
    assert "start it again" in page.locator(NOTICE).inner_text()
    assert page.evaluate(SHOWN) == '"not connected"'
    # The word itself takes no room any more.
    assert page.evaluate("getComputedStyle(document.querySelector('.cw-state')).fontSize") == "0px"
