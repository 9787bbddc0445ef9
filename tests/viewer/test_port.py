"""A taken port is an error, as viser would take the next one without a word."""

import socket
import subprocess
import sys

from tests.coded import raises

from cartwheel.codes.wires import ADDRESS_UNAVAILABLE
from cartwheel.description.model import WorldDescription
from cartwheel.errors import ControlError
from cartwheel.session import Session
from cartwheel.viewer import Viewer


def test_a_port_in_use_is_refused_at_once():
    session = Session(WorldDescription(name="empty"))
    with socket.create_server(("127.0.0.1", 0)) as taken:
        port = taken.getsockname()[1]
        with raises(ADDRESS_UNAVAILABLE, ControlError, port=port):
            Viewer(session, port=port)
    session.close()


def test_a_port_that_is_none_is_refused():
    session = Session(WorldDescription(name="empty"))
    with raises(ADDRESS_UNAVAILABLE, ControlError, port=70000):
        Viewer(session, port=70000)
    session.close()


def test_making_a_viewer_does_not_import_viser():
    """It takes 0.2 s, which the simulation's first clock must not wait for."""
    code = "import sys, cartwheel.viewer; print('viser' in sys.modules)"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "False"
