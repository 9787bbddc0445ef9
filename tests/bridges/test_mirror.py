"""Copies of the graph's topics and services, and the warning about types that ROS lacks."""

from __future__ import annotations

from collections.abc import Callable

from tests.coded import coded

from cartwheel.bridges.loop import Coalesced, Loop
from cartwheel.bridges.mirror import Copies, is_available
from cartwheel.codes.wires import TYPE_UNSUPPORTED
from cartwheel.errors import Diagnostic
from cartwheel.messages.ros2.types import ros2_service


class Copy:
    """Knows its original, and whether it was closed."""

    def __init__(self, name: str, properties: object) -> None:
        self.original = (name, properties)
        self.closed = False

    def close(self) -> None:
        self.closed = True


def test_copies_follow_their_originals() -> None:
    copies: Copies[Copy] = Copies()
    copies.synchronise({"/a": 1, "/b": 1}, Copy)
    a, b = copies["/a"], copies["/b"]
    copies.synchronise({"/b": 2, "/c": 1}, Copy)
    assert [one.original for one in copies.values()] == [("/b", 2), ("/c", 1)]
    assert a.closed
    assert b.closed
    c = copies["/c"]
    copies.synchronise({"/b": 2, "/c": 1}, Copy)
    assert copies["/c"] is c
    assert not c.closed


def test_a_copy_without_an_original_stays_and_takes_the_name() -> None:
    own = Copy("/rosout", None)
    copies: Copies[Copy] = Copies()
    copies["/rosout"] = own
    copies.synchronise({"/rosout": 1, "/a": 1}, Copy)
    copies.synchronise({}, Copy)
    assert copies == {"/rosout": own}
    assert not own.closed


def test_a_type_that_ros_lacks_is_reported_with_its_topic_or_service() -> None:
    reports: list[Diagnostic] = []

    def known(type_name: str) -> bool:
        return is_available(
            "service", "/s", type_name, ros="ROS 2", find=ros2_service, warn=reports.append
        )

    assert known("std_srvs/srv/Trigger")
    assert not reports
    assert not known("roscpp/srv/GetLoggers")
    assert coded(reports, TYPE_UNSUPPORTED, service="/s", type="roscpp/srv/GetLoggers")


def test_a_coalesced_function_runs_once_for_several_calls() -> None:
    due: list[tuple[float, Callable[[], None]]] = []

    class Later(Loop):
        def after(self, seconds: float, function: Callable[[], None]) -> None:
            due.append((seconds, function))

    runs: list[int] = []
    call = Coalesced(Later(runs.append, name="test"), 0.5, lambda: runs.append(1))  # type: ignore[arg-type]
    for count in (1, 2):
        call()
        call()
        ((seconds, function),) = due
        assert seconds == 0.5
        due.clear()
        function()
        assert len(runs) == count
