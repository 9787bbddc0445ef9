"""Services that a program offers, and the names of a model in its namespace."""

from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
from tests.coded import raises

import cartwheel as cw
from cartwheel.codes.command import OPTION_INVALID
from cartwheel.codes.graph import (
    FIELD_UNKNOWN,
    FIELD_VALUE_INVALID,
    GRAPH_NAME_INVALID,
    MESSAGE_TYPE_UNKNOWN,
    SERVICE_FAILED,
    SERVICE_TAKEN,
    SERVICE_TIMED_OUT,
    SERVICE_UNKNOWN,
)
from cartwheel.codes.world import RUN_NESTED, SIMULATION_CLOSED
from cartwheel.dataset import Dataset
from cartwheel.errors import UnknownNameError
from cartwheel.messages import message_class
from cartwheel.msgs.std_srvs import SetBool_Request, SetBool_Response

SET_BOOL = "std_srvs/srv/SetBool"


def test_a_service_responds_to_the_program() -> None:
    with cw.World("empty") as world:
        requests: list[bool] = []

        def enable(request: SetBool_Request) -> SetBool_Response:
            requests.append(request.data)
            return SetBool_Response(success=True, message="done")

        service = world.serve("/enable", SetBool_Request, enable)
        assert (service.name, service.type) == ("/enable", SET_BOOL)
        assert "/enable" in world.services
        response = world.call("/enable", data=True)
        assert (response.success, response.message, requests) == (True, "done", [True])
        service.close()
        assert "/enable" not in world.services
        with raises(SERVICE_UNKNOWN, UnknownNameError):
            world.call("/enable")
        # The name is free again, and the first object does not withdraw the second service.
        world.serve("/enable", "std_srvs/SetBool", lambda _: {"success": True})
        service.close()
        response = world.call("/enable", data=False)
        assert (response.success, response.message) == (True, "")


def test_a_response_without_fields_may_be_none() -> None:
    with cw.World("empty") as world:
        world.serve("/nothing", "std_srvs/srv/Empty", lambda _: None)
        assert world.call("/nothing").__msgtype__ == "std_srvs/srv/Empty_Response"
        world.serve("/forgotten", SET_BOOL, lambda _: None)
        with raises(SERVICE_TIMED_OUT, service="/forgotten"):
            world.call("/forgotten")


@pytest.mark.parametrize(
    ("given", "code"),
    [
        ({"succes": True}, FIELD_UNKNOWN),
        ({"success": "perhaps"}, FIELD_VALUE_INVALID),
        (SetBool_Request(), FIELD_VALUE_INVALID),
        (True, FIELD_VALUE_INVALID),
    ],
)
def test_a_wrong_response_is_an_error_of_the_call(given: Any, code: Any) -> None:
    with cw.World("empty") as world:
        world.serve("/enable", SET_BOOL, lambda _: given)
        with raises(code):
            world.call("/enable")
        world.run(0.1)


def test_an_error_of_the_handler_is_raised_by_the_call() -> None:
    def fail(_: object) -> None:
        raise ValueError("out of order")

    with cw.World("empty") as world:
        world.serve("/enable", SET_BOOL, fail)
        with pytest.raises(ValueError, match="out of order"):
            world.call("/enable")
        world.run(0.1)


def test_an_error_for_another_program_stops_the_run() -> None:
    def fail(_: object) -> None:
        raise ValueError("out of order")

    with cw.World("empty") as world:
        world.serve("/enable", SET_BOOL, fail)
        request = message_class(f"{SET_BOOL}_Request")()
        # Bridges call services so.
        future = world.graph.call("/enable", request)
        with pytest.raises(ValueError, match="out of order"):
            world.run(1.0)
        assert world.time < 0.1
        with raises(SERVICE_FAILED, service="/enable", error="ValueError"):
            future.result(timeout=0)
        world.run(0.1)


def test_another_thread_is_answered_while_the_world_runs(
    on_thread: Callable[[Callable[[], object]], object],
) -> None:
    with cw.World("empty") as world:
        times: list[float] = []

        def stamp(_: object) -> dict[str, Any]:
            times.append(world.time)
            return {"success": True}

        world.serve("/stamp", SET_BOOL, stamp)
        answers: list[bool] = []

        def ask() -> None:
            future = world.graph.call("/stamp", SetBool_Request())
            answers.append(future.result(30).success)

        thread: Any = on_thread(ask)
        while thread.is_alive():
            world.run(0.01)
        assert answers == [True]
        assert len(times) == 1


def test_a_handler_uses_the_world_but_cannot_run_it() -> None:
    with cw.World("empty") as world:
        cart = world.spawn("rosbots.xacro")

        def move(_: object) -> dict[str, Any]:
            cart.pose = cw.Pose((2.0, 0.0, 0.0))
            return {"success": True}

        def run(_: object) -> dict[str, Any]:
            world.run(0.1)
            return {"success": True}

        world.serve("/move", SET_BOOL, move)
        world.serve("/run", SET_BOOL, run)
        world.call("/move")
        assert cart.pose.x == pytest.approx(2.0)
        world.graph.call("/run", SetBool_Request())
        with raises(RUN_NESTED):
            world.run(0.1)


def test_wrong_services_are_refused() -> None:
    with cw.World("empty") as world:
        world.spawn("rosbots.xacro")
        with raises(SERVICE_TAKEN, name="/imu/service"):
            world.serve("/imu/service", SET_BOOL, lambda _: {})
        with raises(MESSAGE_TYPE_UNKNOWN, UnknownNameError):
            world.serve("/enable", "std_srvs/srv/SetBoole", lambda _: {})
        with raises(GRAPH_NAME_INVALID):
            world.serve("/en able", SET_BOOL, lambda _: {})
        with raises(OPTION_INVALID, name="handler"):
            world.serve("/enable", SET_BOOL, "enable")  # type: ignore[call-overload]
        with raises(OPTION_INVALID, name="name"):
            world.serve(1, SET_BOOL, lambda _: {})  # type: ignore[call-overload]
    with raises(SIMULATION_CLOSED):
        world.serve("/enable", SET_BOOL, lambda _: {})


def test_a_type_of_the_workspace(tmp_path: Path) -> None:
    package = tmp_path / "lamp_msgs"
    (package / "srv").mkdir(parents=True)
    (package / "package.xml").write_text("<package><name>lamp_msgs</name></package>")
    (package / "srv" / "Dim.srv").write_text("float64 level\n---\nfloat64 before\n")
    with cw.World("empty", package_path=[tmp_path]) as world:
        levels = [1.0]

        def dim(request: Any) -> Any:
            levels.append(request.level)
            return message_class("lamp_msgs/srv/Dim_Response")(before=levels[-2])

        world.serve("/dim", "lamp_msgs/srv/Dim", dim)
        assert world.call("/dim", level=0.5).before == 1.0
        assert world.call("/dim", level=0.2).before == 0.5


def test_names_are_in_the_namespace_of_the_model() -> None:
    with cw.World("empty") as world:
        left = world.spawn("rosbots.xacro", name="left", namespace="left")
        right = world.spawn("rosbots.xacro", name="right", namespace="right", y=2.0)
        assert "/left/imu/service" in left.services
        assert "/left/imu/service" not in right.services
        assert set(left.services) | set(right.services) <= set(world.services)
        assert left.actions == ()
        left.call("imu/service")
        left.call("/right/imu/service")
        with raises(SERVICE_UNKNOWN, UnknownNameError):
            left.call("/imu/service")
        box = left.mailbox("odom")
        seen: list[Any] = []
        left.subscribe("odom", seen.append)
        world.run(0.1)
        assert len(box.drain()) == len(seen) == 11
        assert left.serve("enable", SetBool_Request, lambda _: {}).name == "/left/enable"
        assert "/left/enable" in world.services
        # It belongs to the program, as topics that a program advertises do.
        assert "/left/enable" not in left.services
        with raises(OPTION_INVALID, name="service"):
            left.call(3)  # type: ignore[arg-type]


def test_cameras_have_the_names_that_a_dataset_takes(tmp_path: Path) -> None:
    with cw.World("empty") as world:
        assert world.cameras == ()
        cart = world.spawn("rosbots.xacro")
        assert cart.cameras == world.cameras == ("rosbots::camera1",)
        post = world.spawn("object.urdf", name="post", x=3.0)
        assert post.cameras == ()
        Dataset(tmp_path / "data", world, cameras=world.cameras).close()


@pytest.mark.wording
def test_the_type_of_an_action_is_not_that_of_a_service():
    with cw.World() as world, raises(MESSAGE_TYPE_UNKNOWN) as caught:
        world.serve("/go", "control_msgs/action/FollowJointTrajectory", print)
    assert "action" in str(caught.value) and "Did you mean" not in str(caught.value)


@pytest.mark.wording
def test_a_value_that_is_no_request_is_that_of_a_service() -> None:
    with cw.World() as world:
        world.serve("/enable", SetBool_Request, lambda _: {"success": True})
        with raises(FIELD_VALUE_INVALID) as caught:
            world.call("/enable", True)
        assert 'service "/enable" requires' in caught.value.message
