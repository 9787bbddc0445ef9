"""What a client may ask, over the real socket."""

import itertools
import math

import pytest
from tests.coded import raises

from cartwheel.codes.command import (
    CONTROL_REQUEST_INVALID,
    INTERNAL_FAULT,
    SIMULATION_ENDED,
    SIMULATION_NOT_RUNNING,
)
from cartwheel.codes.graph import (
    FIELD_UNKNOWN,
    MESSAGE_NOT_DECODABLE,
    SERVICE_UNKNOWN,
    TOPIC_TYPE_MISMATCH,
    TOPIC_UNKNOWN,
)
from cartwheel.codes.tags import VALUE_INVALID
from cartwheel.codes.world import MODEL_NAME_TAKEN, UNKNOWN_MODEL
from cartwheel.control import ControlClient
from cartwheel.errors import ControlError
from cartwheel.messages import decode_cdr, encode_cdr, from_dict


@pytest.fixture
def client(server):
    with ControlClient() as made:
        yield made


def test_status_says_what_runs(client):
    status = client.request("status")
    assert status["world"] == "test_world"
    assert status["state"] == "running"
    assert status["speed"] == 1.0
    assert status["time"] * 1e9 == pytest.approx(status["time_ns"])


def test_pause_step_resume(client):
    assert client.request("pause")["state"] == "paused"
    before = client.request("status")
    after = client.request("step", count=25)
    assert after["time"] - before["time"] == pytest.approx(25 * before["step"])
    assert client.request("status")["state"] == "paused"
    assert client.request("resume")["state"] == "running"


def test_reset_takes_time_back(client, eventually):
    eventually(lambda: client.request("status")["time"] > 0.2)
    assert client.request("reset")["time"] == 0
    assert client.request("status")["time"] < 0.2


def test_speed(client):
    client.request("speed", speed=4)
    assert client.request("status")["speed"] == 4
    client.request("speed", speed=None)
    assert client.request("status")["speed"] is None
    client.request("speed", speed=1)
    for wrong in (0, -1, math.nan, math.inf, 1e308, 10**400, 1e-300, "fast", True):
        with pytest.raises(ControlError):
            client.request("speed", speed=wrong)
    assert client.request("status")["speed"] == 1


def test_spawn_list_delete(client, tmp_path):
    client.request("pause")  # or the one falls upon the other
    file = str(tmp_path / "crate.urdf")
    answer = client.request("spawn", file=file, x=1.0, z=0.5, yaw=math.pi / 2)
    assert answer["name"] == "crate"
    client.request("spawn", file=file, model="other", arguments={"name": "x"})
    one, other = client.request("models")["models"]
    assert one["name"] == "crate"
    assert one["position"][:2] == [1.0, 0.0]
    assert one["rpy"][2] == pytest.approx(math.pi / 2, abs=1e-3)
    assert one["mass"] == 1.0
    assert other["name"] == "other"
    with raises(MODEL_NAME_TAKEN, ControlError, name="crate"):
        client.request("spawn", file=file)
    client.request("delete", model="crate")
    assert client.request("status")["models"] == ["other"]
    with raises(UNKNOWN_MODEL, ControlError, name="crate"):
        client.request("delete", model="crate")


def test_what_is_wrong_with_a_file_comes_back_in_full(client):
    with raises(VALUE_INVALID, ControlError, name="mass") as caught:
        client.request("spawn", file="/tmp/bad.urdf")
    assert str(caught.value.origin) == "/tmp/bad.urdf:7"
    with raises(INTERNAL_FAULT, ControlError):
        client.request("spawn", file="/tmp/broken.urdf")
    with raises(CONTROL_REQUEST_INVALID):
        client.request("spawn", file="crate.urdf")
    assert client.request("status")["models"] == []


@pytest.mark.wording
def test_what_is_wrong_with_a_file_comes_back_in_the_same_words(client):
    with raises(VALUE_INVALID, ControlError) as caught:
        client.request("spawn", file="/tmp/bad.urdf")
    assert str(caught.value) == "/tmp/bad.urdf:7: it is bad\n  Mend it."


def test_topics(client, commands):
    names = {topic["name"]: topic for topic in client.request("topics")["topics"]}
    assert set(names) == {"/clock", "/cmd_vel", "/twist"}
    assert names["/twist"]["rate"] == 50
    assert client.request("topic", topic="twist")["type"] == "geometry_msgs/msg/Twist"
    with raises(TOPIC_UNKNOWN, meant="/twist"):
        client.request("topic", topic="/twits")


def test_messages_come_with_their_times(client):
    with client.subscribe("/twist") as subscription:
        assert subscription.type == "geometry_msgs/msg/Twist"
        samples = [subscription.get(5) for _ in range(10)]
    times = [sample.time_ns for sample in samples]
    assert [later - sooner for sooner, later in itertools.pairwise(times)] == [20_000_000] * 9
    for sample in samples:
        assert decode_cdr(sample.data, sample.type).linear.x == sample.time_ns
        assert sample.dropped == 0


def test_times_alone_cost_no_bytes(client):
    with client.subscribe("/clock", data=False) as subscription:
        assert subscription.get(5).data == b""


def test_a_subscription_ends_with_its_client(client, session, eventually):
    with client.subscribe("/twist") as subscription:
        subscription.get(5)
        assert session.graph.topic("/twist").subscribers == ("cartwheel topic",)
    eventually(lambda: session.graph.topic("/twist").subscribers == ())
    # Also where nothing is published that would show that it is gone.
    client.request("pause")
    client.subscribe("/twist").close()
    eventually(lambda: session.graph.topic("/twist").subscribers == ())


def test_a_slow_reader_loses_the_oldest_and_is_reported(client, eventually):
    client.request("speed", speed=None)
    with client.subscribe("/twist", queue=5) as subscription:
        eventually(lambda: client.request("status")["time"] > 400)
        client.request("pause")
        sample = subscription.get(5)
        while sample.dropped == 0:
            sample = subscription.get(5)


def test_publish_is_checked(client, commands, eventually):
    assert client.publish("/cmd_vel", "geometry_msgs/Twist", {"linear": {"x": 0.5}}) == 1
    assert client.publish("cmd_vel", "geometry_msgs/msg/Twist", [[1, 2, 3], None]) == 1
    twist = from_dict("geometry_msgs/Twist", [None, [0, 0, 1]])
    client.request(
        "publish", topic="/cmd_vel", type="geometry_msgs/Twist", payload=encode_cdr(twist)
    )
    eventually(lambda: len(commands) == 3)
    assert [c.linear.x for c in commands] == [0.5, 1.0, 0.0]
    with raises(FIELD_UNKNOWN, field="linar"):
        client.publish("/cmd_vel", "geometry_msgs/Twist", {"linar": {}})
    with raises(TOPIC_TYPE_MISMATCH, type="geometry_msgs/msg/Twist"):
        client.publish("/cmd_vel", "std_msgs/Empty", {})
    with raises(MESSAGE_NOT_DECODABLE, bytes=3):
        client.request("publish", topic="/cmd_vel", type="geometry_msgs/Twist", payload=b"abc")
    assert len(commands) == 3


def test_publishing_where_nobody_reads_leaves_nothing_behind(client, session):
    answer = client.request("publish", topic="/nobody", type="geometry_msgs/Twist")
    assert answer == {"subscribers": 0, "topics": ["/clock", "/twist"]}
    assert "/nobody" not in session.graph._topics


def test_services(client, session):
    def handler(request):
        if request.data is None:
            raise ValueError
        return from_dict("std_srvs/srv/SetBool_Response", {"success": request.data, "message": "m"})

    session.graph.serve("/set", "std_srvs/srv/SetBool", handler)
    assert client.request("services")["services"][0]["name"] == "/set"
    answer = client.request("call", service="/set", request={"data": True})
    assert answer["response"] == {"success": True, "message": "m"}
    with raises(FIELD_UNKNOWN, field="date"):
        client.request("call", service="/set", request={"date": True})
    with raises(SERVICE_UNKNOWN, meant="/set"):
        client.request("call", service="/sett")


def test_an_unknown_request_lists_the_known(client):
    with raises(CONTROL_REQUEST_INVALID, meant="status"):
        client.request("statsu")


def test_the_end_of_the_simulation_is_said(client, server):
    subscription = client.subscribe("/twist")
    server.close()
    while subscription.get(5) is not None:
        pass
    with raises(SIMULATION_ENDED):
        client.request("status")
    with raises(SIMULATION_NOT_RUNNING):
        ControlClient()
