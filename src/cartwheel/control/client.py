"""The end of the control socket that a command holds."""

from __future__ import annotations

import contextlib
import socket
import time
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Any

from cartwheel.codes.command import SIMULATION_ENDED, SIMULATION_SILENT
from cartwheel.control.faults import refused
from cartwheel.control.protocol import PATIENCE, Connection, Frame
from cartwheel.control.registry import Running, find
from cartwheel.errors import ControlError

_HUNG_UP = "the simulation has ended, or too many clients are connected"


@dataclass(frozen=True, kw_only=True, slots=True)
class Sample:
    """One message of a topic."""

    topic: str
    type: str
    data: bytes
    """CDR; empty where only the times were asked for."""
    time_ns: int
    """Simulation time of its publication."""
    dropped: int
    """Messages lost so far because they were not read fast enough."""


class ControlClient:
    """Asks things of a running simulation.

    Args:
        simulation: Which; the only one that runs when None.

    Raises:
        ControlError: There is none, or it does not answer.
    """

    def __init__(self, simulation: Running | None = None) -> None:
        self.simulation = simulation or find()
        self._connection = _connect(self.simulation)

    def __enter__(self) -> ControlClient:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def close(self) -> None:
        """Ends the connection."""
        self._connection.close()

    def request(self, name: str, *, payload: bytes = b"", **parameters: Any) -> dict[str, Any]:
        """Asks for one thing and waits for the answer.

        Args:
            name: Of the request; see `Operations`.
            payload: Bytes that go with it.
            parameters: Of the request.

        Raises:
            ControlError: It was refused, with the simulation's own words, or the
                simulation has ended.
        """
        return _ask(self._connection, name, parameters, payload)

    def wait_for_end(self) -> None:
        """Returns when the simulation has ended; nothing is asked meanwhile."""
        with contextlib.suppress(OSError, ControlError):
            self._connection.receive()

    def subscribe(self, topic: str, *, data: bool = True, queue: int | None = None) -> Subscription:
        """The messages of a topic, over a connection of their own.

        Args:
            topic: Its name.
            data: Whether the messages themselves are wanted, or only their times.
            queue: How many unread messages the simulation holds.

        Raises:
            ControlError: There is no such topic.
        """
        parameters: dict[str, Any] = {"topic": topic, "data": data}
        if queue is not None:
            parameters["queue"] = queue
        connection = _connect(self.simulation)
        try:
            answer = _ask(connection, "subscribe", parameters)
        except BaseException:
            connection.close()
            raise
        return Subscription(connection, answer["topic"], answer["type"])

    def publish(
        self,
        topic: str,
        type_name: str,
        message: Mapping[str, Any] | list[Any],
        *,
        at_end: Mapping[str, Any] | None = None,
    ) -> int:
        """Publishes a message; returns how many read it.

        Args:
            topic: Its name.
            type_name: Of the message.
            message: Its fields.
            at_end: What the simulation publishes on that topic when this connection ends, in
                whatever manner; None withdraws it.
        """
        answer = self.request(
            "publish", topic=topic, type=type_name, message=message, at_end=at_end
        )
        return int(answer["subscribers"])


class Subscription:
    """Yields the messages of a topic until it is closed or the simulation ends."""

    def __init__(self, connection: Connection, topic: str, type_name: str) -> None:
        self._connection = connection
        self.topic = topic
        self.type = type_name

    def __enter__(self) -> Subscription:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def __iter__(self) -> Iterator[Sample]:
        while (sample := self.get()) is not None:
            yield sample

    def get(self, timeout: float | None = None) -> Sample | None:
        """The next message; None where the simulation has ended.

        Raises:
            TimeoutError: None came in `timeout` seconds.
        """
        try:
            frame = self._connection.receive(timeout)
        except TimeoutError:
            raise
        except OSError:
            return None
        if frame is None:
            return None
        return Sample(
            topic=self.topic,
            type=self.type,
            data=frame.payload,
            time_ns=frame.header["time_ns"],
            dropped=frame.header["dropped"],
        )

    def close(self) -> None:
        """Ends the subscription."""
        self._connection.close()


def _connect(simulation: Running) -> Connection:
    deadline = time.monotonic() + 5.0
    while True:
        sock = socket.socket(socket.AF_UNIX, socket.SOCK_STREAM)
        sock.settimeout(1.0)
        try:
            sock.connect(str(simulation.path))
        except OSError as error:
            sock.close()
            # A full queue shows at once, whatever the time allowed.
            if isinstance(error, BlockingIOError) and time.monotonic() < deadline:
                time.sleep(0.01)
                continue
            raise ControlError(
                f"simulation {simulation.pid} does not respond: {error}",
                code=SIMULATION_SILENT,
                values={"pid": simulation.pid},
            ) from error
        return Connection(sock)


def _ask(
    connection: Connection, name: str, parameters: Mapping[str, Any], payload: bytes = b""
) -> dict[str, Any]:
    try:
        with contextlib.suppress(BrokenPipeError):  # Why may stand in what is received.
            connection.send({"request": name, "parameters": dict(parameters)}, payload)
        # Longer than the simulation itself waits, so that its own words arrive.
        frame: Frame | None = connection.receive(None if name == "step" else PATIENCE + 60)
    except TimeoutError as error:
        raise ControlError("the simulation does not respond", code=SIMULATION_SILENT) from error
    except OSError as error:
        raise ControlError(_HUNG_UP, code=SIMULATION_ENDED) from error
    if frame is None:
        raise ControlError(_HUNG_UP, code=SIMULATION_ENDED)
    if "error" in frame.header:
        raise refused(frame.header)
    answer: dict[str, Any] = frame.header["ok"]
    return answer
