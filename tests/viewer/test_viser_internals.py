"""Messages that several threads send to browsers at once."""

import contextlib
import threading
import types
import zipfile
from concurrent.futures import ThreadPoolExecutor

import pytest
from viser import _icons

from cartwheel.gate.access import Access
from cartwheel.gate.listening import listen
from cartwheel.options import PORT
from cartwheel.viewer import viser_internals
from cartwheel.viewer.page import Page

from .browsing import browsing
from .conftest import eventually

THREADS = 4
MESSAGES = 100
BROWSERS = 3


@pytest.fixture
def page():
    made = Page(
        listen("127.0.0.1", 0, title="a test", option=PORT),
        Access(host="127.0.0.1"),
        title="Test",
    )
    stopped = threading.Event()
    thread = threading.Thread(target=made.run, args=(stopped,))
    thread.start()
    yield made
    stopped.set()
    made.wake()
    thread.join(60)
    made.close()


def test_threads_send_messages_while_the_loop_waits(page):
    # In debug mode, asyncio raises an error for each call from a wrong thread. Otherwise, such a
    # call fails only if the loop changes the list of waiting tasks at the same time.
    page.server.get_event_loop().set_debug(True)
    port = int(page.url.rpartition(":")[2].strip("/"))
    with contextlib.ExitStack() as stack:
        browsers = [stack.enter_context(browsing(port)) for _ in range(BROWSERS)]
        for browser in browsers:
            browser.look()
        eventually(lambda: len(page.clients) == BROWSERS, what="the browsers")
        clients = list(page.server.get_clients().values())
        started = threading.Barrier(THREADS)

        def send(thread):
            started.wait(60)
            for count in range(MESSAGES):
                viser_internals.run_in_new_browsers(page.gui, f"all {thread} {count}")
                for client in clients:
                    viser_internals.run_in_browser(client, f"one {thread} {count}")

        with ThreadPoolExecutor(THREADS) as pool:
            list(pool.map(send, range(THREADS)))
        for browser in browsers:
            for kind in ("all", "one"):
                for thread in range(THREADS):
                    prefix = f"{kind} {thread} "
                    last = f"{prefix}{MESSAGES - 1}"
                    browser.hear(lambda message, last=last: message.get("source") == last)
                    sources = [message.get("source", "") for message in browser.messages]
                    arrived = [source for source in sources if source.startswith(prefix)]
                    assert arrived == [f"{prefix}{count}" for count in range(MESSAGES)]


def test_each_icon_is_that_of_viser(page):
    assert isinstance(_icons.zipfile, types.SimpleNamespace)
    with zipfile.ZipFile(_icons.ICONS_DIR / "tabler-icons.zip") as archive:
        for name in (page.viser.Icon.CAMERA, page.viser.Icon.TRASH):
            expected = archive.read(f"{name}.svg").decode()
            assert _icons.svg_from_icon.__wrapped__(name) == expected
            assert _icons.svg_from_icon.__wrapped__(name) == expected
