"""Notes of the page: each states its code."""

from types import SimpleNamespace

import pytest
from tests.coded import coded

from cartwheel.codes.recording import SCAN_NOT_SHOWN, UPLOAD_REFUSED
from cartwheel.errors import UNCLASSIFIED, Diagnostic
from cartwheel.viewer.page import Page
from cartwheel.viewer.scans import Scans


@pytest.fixture
def notes():
    """What a page shows, and that page."""
    shown = []
    page = SimpleNamespace(notify=lambda title, body, **how: shown.append((title, body, how)))
    page.show = lambda diagnostic: Page.show(page, diagnostic)
    return shown, page


def test_a_note_has_the_code_the_message_and_the_hint(notes):
    shown, page = notes
    refused = UPLOAD_REFUSED.diagnostic("it is empty", hint="Choose another file.")
    page.show(refused)
    page.show(Diagnostic(severity="error", message="m", code=UNCLASSIFIED))
    (title, body, how), (plain, *_) = shown
    assert (title, plain) == ("Error CW921", "Error")
    assert body == f"{refused.message}\n{refused.hint}"
    assert how["color"] == "red"


def test_data_of_an_unknown_frame_is_reported_once(notes):
    shown, page = notes
    reported = []
    show = page.show
    page.show = lambda diagnostic: (reported.append(diagnostic), show(diagnostic))
    scans = SimpleNamespace(page=page, _reported=set())
    for _ in range(3):
        Scans._tell(scans, "/scan", "lasr", "robot")
    ((title, body, how),) = shown
    assert title == f"Warning {SCAN_NOT_SHOWN.number}"
    assert coded(reported, SCAN_NOT_SHOWN, topic="/scan", frame="lasr", model="robot")
    assert [body] == [each.message for each in reported]
    assert how["color"] is None
