"""The client side of the control socket."""

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
    """A message on a topic."""

    topic: str
    type: str
    data: bytes
    """CDR; empty if only timestamps were requested."""
    time_ns: int
    """Simulation time at which the message was published."""
    dropped: int
    """Number of messages dropped so far because the client was too slow."""


class ControlClient:
    """A connection to a running simulation.

    Args:
        simulation: The simulation; None for the only running one.

    Raises:
        ControlError: There is no such simulation, or it does not respond.
    """

    def __init__(self, simulation: Running | None = None) -> None:
        self.simulation = simulation or find()
        self._connection = _connect(self.simulation)

    def __enter__(self) -> ControlClient:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def close(self) -> None:
        """Closes the connection."""
        self._connection.close()

    def request(self, name: str, *, payload: bytes = b"", **parameters: Any) -> dict[str, Any]:
        """Sends a request and waits for the response.

        Args:
            name: Name of the request; see `Operations`.
            payload: Binary payload of the request.
            parameters: Parameters of the request.

        Raises:
            ControlError: The simulation rejected the request, with its reason, or has ended.
        """
        return _ask(self._connection, name, parameters, payload)

    def wait_for_end(self) -> None:
        """Waits until the simulation ends, without sending requests."""
        with contextlib.suppress(OSError, ControlError):
            self._connection.receive()

    def subscribe(self, topic: str, *, data: bool = True, queue: int | None = None) -> Subscription:
        """Subscribes to a topic, over a separate connection.

        Args:
            topic: Topic name.
            data: Whether to receive the messages, or only their timestamps.
            queue: Number of unread messages that the simulation buffers.

        Raises:
            ControlError: The topic does not exist.
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
        if answer["types"]:
            # Only then are libraries for messages needed, which take time to import.
            from cartwheel.control.types import register_types

            register_types(answer["types"])
        return Subscription(connection, answer["topic"], answer["type"])

    def publish(
        self,
        topic: str,
        type_name: str,
        message: Mapping[str, Any] | list[Any],
        *,
        at_end: Mapping[str, Any] | None = None,
    ) -> int:
        """Publishes a message; returns the number of subscribers.

        Args:
            topic: Topic name.
            type_name: Message type.
            message: The message's fields.
            at_end: A message that the simulation publishes on this topic when the connection ends
                for any reason; None withdraws it.
        """
        answer = self.request(
            "publish", topic=topic, type=type_name, message=message, at_end=at_end
        )
        return int(answer["subscribers"])


class Subscription:
    """Yields the messages on a topic until it is closed or the simulation ends."""

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
        """The next message; None if the simulation has ended.

        Raises:
            TimeoutError: No message arrived within `timeout` seconds.
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
        """Closes the subscription."""
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
            # A full queue is reported at once, whatever the timeout.
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
        with contextlib.suppress(BrokenPipeError):  # The received data may contain the reason.
            connection.send({"request": name, "parameters": dict(parameters)}, payload)
        # Longer than the simulation's own timeout, so that its error message arrives.
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
