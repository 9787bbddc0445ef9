"""What is published when a client goes away."""

import subprocess
import sys
from unittest.mock import Mock

import pytest
from tests import launching
from tests.coded import raises

from cartwheel.codes.command import CONTROL_LIMIT
from cartwheel.codes.graph import TOPIC_TYPE_MISMATCH
from cartwheel.control import ControlClient
from cartwheel.control.wills import MOST, Wills
from cartwheel.errors import ControlError, GraphError

TWIST = "geometry_msgs/msg/Twist"
GO = {"linear": {"x": 0.5}}
STOP = {"linear": {"x": 0.0}}


def speeds(commands):
    return [message.linear.x for message in commands]


def test_a_client_that_is_gone_leaves_a_stop(server, commands, eventually):
    with ControlClient() as client:
        assert client.publish("/cmd_vel", TWIST, GO, at_end=STOP) == 1
        eventually(lambda: speeds(commands) == [0.5])
    eventually(lambda: speeds(commands) == [0.5, 0.0])


PROGRAM = """
import os, sys
from cartwheel.control import ControlClient
client = ControlClient()
client.publish("/cmd_vel", "geometry_msgs/msg/Twist", {"linear": {"x": 0.5}}, at_end={})
print("published", flush=True)
sys.stdin.read()
"""


def test_a_killed_process_leaves_a_stop(server, commands, eventually):
    with launching.Popen(
        [sys.executable, "-c", PROGRAM], stdin=subprocess.PIPE, stdout=subprocess.PIPE
    ) as process:
        assert process.stdout.readline() == b"published\n"
        eventually(lambda: speeds(commands) == [0.5])
        process.kill()
    eventually(lambda: speeds(commands) == [0.5, 0.0])


def test_a_will_is_replaced_and_withdrawn(server, commands, eventually):
    with ControlClient() as client:
        client.publish("/cmd_vel", TWIST, GO, at_end=STOP)
        client.publish("/cmd_vel", TWIST, GO, at_end=GO)
        client.publish("/cmd_vel", TWIST, STOP)
    with ControlClient() as client:
        client.publish("/cmd_vel", TWIST, {"linear": {"x": 9.0}})
    eventually(lambda: not server._clients)
    eventually(lambda: 9.0 in speeds(commands))
    with ControlClient() as client:
        client.request("status")
    assert speeds(commands) == [0.5, 0.5, 0.0, 9.0]


def test_who_publishes_without_one_drives_on(server, commands, eventually):
    with ControlClient() as client:
        client.request("publish", topic="/cmd_vel", type=TWIST, message=GO)
    eventually(lambda: not server._clients)
    with ControlClient() as client:
        client.request("status")
    assert speeds(commands) == [0.5]


def test_a_last_message_that_cannot_be_published_is_reported(
    server, commands, session, eventually, monkeypatch
):
    with ControlClient() as client:
        client.publish("/cmd_vel", TWIST, GO, at_end=STOP)
        eventually(lambda: speeds(commands) == [0.5])
        error = GraphError("no", code=TOPIC_TYPE_MISMATCH, values={"topic": "/cmd_vel"})
        monkeypatch.setattr(Wills, "execute", Mock(side_effect=error))
    eventually(lambda: any(each.code is TOPIC_TYPE_MISMATCH for each in session.diagnostics))


def test_wrong_and_too_many_are_refused(server, commands, session, eventually):
    for index in range(MOST):
        session.graph.subscribe(f"/other_{index}", commands.append, type_name=TWIST)
    with ControlClient() as client:
        with pytest.raises(ControlError):
            client.publish("/cmd_vel", TWIST, GO, at_end={"linear": 5})
        for index in range(MOST):
            client.publish(f"/other_{index}", TWIST, GO, at_end=STOP)
        with raises(CONTROL_LIMIT, most=MOST):
            client.publish("/cmd_vel", TWIST, GO, at_end=STOP)
        # A refused one has not moved anything.
        eventually(lambda: len(commands) >= MOST)
        client.request("status")
        assert len(commands) == MOST
